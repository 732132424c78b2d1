/* fuzz_volume.c - hostile inputs: the first byte chooses the file's name, where a format goes by
 * that, the others are the file.
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "formats/grid/volume.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Read all that fits into a small buffer, as a caller would. */
static void read_all(volume *v) {
    const grid *g = volume_grid(v);
    uint64_t bytes = grid_slice_bytes(g);
    void *slice = bytes < 1 << 20 ? malloc(bytes) : NULL;
    status st = slice ? ST_OK : ST_NOMEM;
    for (uint32_t k = 0; st == ST_OK && k < g->dims[2]; k++)
        st = volume_read(v, 1, slice);
    if (st == ST_OK)
        st = volume_finish(v, NULL);
    free(slice);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const names[] = {"nrrd", "mha", "json", "raw", "dem", "asc", "hgt", "nrrd"};
    char path[64];
    if (size == 0)
        return 0;
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.%s", (int)getpid(), names[data[0] % 8]);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data + 1, 1, size - 1, f) != size - 1)
        abort();
    fclose(f);
    mem m;
    mem_init(&m, (size_t)64 << 20);
    const volume_hints hints = {.dims = {3, 2, 2}, .type = SAMPLE_I16};
    volume *v = NULL;
    if (volume_open(&m, path, data[0] % 8 == 3 ? &hints : NULL, &v) == ST_OK)
        read_all(v);
    volume_close(v);
    if (mem_used(&m) != 0)
        abort();
    remove(path);
    return 0;
}
