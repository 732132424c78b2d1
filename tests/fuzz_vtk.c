/* fuzz_vtk.c - hostile VTK grids: the first byte chooses legacy or XML and what is asked for, the
 * others are the file. What is handed over must keep the promises of mesh.h.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "formats/mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t points, values;

static void require(bool kept) {
    if (!kept)
        abort();
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    (void)ctx;
    require(first == points && count > 0);
    for (size_t i = 0; i < count; i++)
        require(isfinite(xyz[i][0]) && isfinite(xyz[i][1]) && isfinite(xyz[i][2]));
    points += count;
    return ST_OK;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *v) {
    (void)ctx, (void)v;
    require(first == values && count > 0);
    values += count;
    return values < 1 << 20 ? ST_OK : status_describe(ST_FAILED, "enough");
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < a; b++)
                require(ids[i][a] != ids[i][b]);
    return ST_OK;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const mesh_sink sink = {NULL, take_points, take_values, take_tets};
    char path[64];
    if (size == 0)
        return 0;
    const mesh_hints hints = {.component = data[0] >> 1 & 1, .cells_to_points = data[0] >> 2 & 1};
    snprintf(path, sizeof path, "/dev/shm/leafcast-fuzz-%d.%s", (int)getpid(),
             data[0] & 1 ? "vtu" : "vtk");
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data + 1, 1, size - 1, f) != size - 1)
        abort();
    fclose(f);
    mem m;
    mesh *x = NULL;
    mesh_report report;
    mem_init(&m, (size_t)16 << 20);
    points = values = 0;
    status st = mesh_open(&m, path, &hints, &x);
    if (st == ST_OK)
        st = mesh_read(x, &sink, &report);
    if (st == ST_OK)
        require(report.points == points && values == points);
    else
        require(*status_text());
    mesh_close(x);
    require(mem_used(&m) == 0);
    remove(path);
    return 0;
}
