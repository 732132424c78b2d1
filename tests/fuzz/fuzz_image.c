/* fuzz_image.c - hostile images, as far as the importer reads them itself: the pages and strips of
 * a TIFF, where its samples can stay, its map, the end of a JPEG. The first byte chooses.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "prep/import/images/geotiff.h"
#include "prep/import/images/jpeg_end.h"
#include "prep/import/images/tiff_pages.h"
#include "prep/import/images/tiff_place.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Pages 0 and 2 as slices. Each entry that is found must have its bytes in 32 bits. */
static void find_place(mem *m, const char *path, uint32_t component) {
    static const uint32_t pages[] = {0, 2};
    const char *const paths[] = {path, path};
    const tiff_wish wish = {
        .paths = paths, .pages = pages, .slices = 2, .component = component, .type = SAMPLE_F32};
    tiff_place keep = {.m = NULL};
    sample_place at;
    uint64_t bytes = 0;
    if (tiff_place_find(m, &wish, &keep, &at) == ST_OK && !at.refused)
        for (uint32_t i = 0; i < at.table_count; i++)
            bytes += at.table[i].bytes;
    if (bytes >> 63)
        abort();
    tiff_place_release(&keep);
}

/* A map is invertible, and finite. */
static void find_map(mem *m, const char *path) {
    geotiff g;
    if (geotiff_read(m, path, &g) == ST_OK && g.placed &&
        !(fabs(g.map[0][0] * g.map[1][1] - g.map[0][1] * g.map[1][0]) > 0))
        abort();
    geotiff_release(&g);
}

static void look_at(mem *m, const char *path, uint8_t how) {
    uint64_t pages;
    switch (how % 5) {
    case 0: (void)!tiff_pages_count(m, path, &pages); break;
    case 1: (void)!jpeg_end_check(m, path); break;
    case 4: find_map(m, path); break;
    default: find_place(m, path, how % 5 - 2); break;
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[64];
    mem m;
    if (size == 0)
        return 0;
    mem_init(&m, (size_t)16 << 20);
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.image", (int)getpid());
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data + 1, 1, size - 1, f) != size - 1)
        abort();
    fclose(f);
    look_at(&m, path, data[0]);
    if (mem_used(&m) != 0)
        abort();
    remove(path);
    return 0;
}
