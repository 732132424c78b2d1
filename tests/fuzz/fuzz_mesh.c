/* fuzz_mesh.c - hostile meshes and surfaces: the first byte chooses the format and what is asked
 * for, the others are the file; of TetGen both, with a $ between .node and .ele. What is handed
 * over must keep the promises of mesh_input.h.
 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/surface/surface_readers.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t points, values, normals;

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

static status take_normals(void *ctx, uint64_t first, size_t count, const uint32_t *codes) {
    (void)ctx, (void)codes;
    require(first == normals && count > 0);
    normals += count;
    return ST_OK;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ctx;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < a; b++)
                require(ids[i][a] != ids[i][b]);
    return ST_OK;
}

static status take_cells(void *ctx, size_t count, const uint32_t (*ids)[CELL_ROW]) {
    (void)ctx;
    for (size_t i = 0; i < count; i++) {
        int different = 0;
        const int least = cell_row_is_quadratic(ids[i]) ? CELL_ROW : 4;
        for (int a = 0; a < CELL_ROW; a++) {
            bool is_new = true;
            for (int b = 0; b < a; b++)
                is_new = is_new && ids[i][a] != ids[i][b];
            different += is_new;
        }
        require(different >= least);
    }
    return ST_OK;
}

enum { PATH_ROOM = 64 };

static void write_file(char path[PATH_ROOM], const char *suffix, const uint8_t *data, size_t size) {
    snprintf(path, PATH_ROOM, "/dev/shm/leafcast-fuzz-%d.%s", (int)getpid(), suffix);
    FILE *f = fopen(path, "wb");
    if (!f || fwrite(data, 1, size, f) != size)
        abort();
    fclose(f);
}

static status take_triangles(void *ctx, size_t count, const uint32_t (*ids)[3]) {
    (void)ctx;
    for (size_t i = 0; i < count; i++)
        require(ids[i][0] != ids[i][1] && ids[i][1] != ids[i][2] && ids[i][2] != ids[i][0]);
    return ST_OK;
}

static void read_mesh(const char *path, const mesh_hints *hints, bool whole, bool surface) {
    const mesh_sink sink = {.points = take_points,
                            .values = take_values,
                            .tets = take_tets,
                            .cells = whole ? take_cells : NULL,
                            .triangles = surface ? take_triangles : NULL,
                            .normals = surface ? take_normals : NULL,
                            .corners = !whole};
    mem m;
    mesh_input *x = NULL;
    mesh_report report;
    mem_init(&m, (size_t)16 << 20);
    points = values = normals = 0;
    status st =
        surface ? surface_input_open(&m, path, hints, &x) : mesh_input_open(&m, path, hints, &x);
    if (st == ST_OK)
        st = mesh_input_read(x, &sink, &report);
    if (st == ST_OK)
        require(report.points == points && values == points && (!normals || normals == points));
    else
        require(*status_text());
    mesh_input_close(x);
    require(mem_used(&m) == 0);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    static const char *const suffixes[] = {"vtk", "vtu", "mesh", "msh", "node", "ply",
                                           "stl", "obj", "off",  "vtk", "vtp",  "glb"};
    enum { MESHES = 5, FORMATS = sizeof suffixes / sizeof *suffixes };
    char path[PATH_ROOM], other[PATH_ROOM] = "";
    if (size == 0)
        return 0;
    const int format = (data[0] & 0xf) < FORMATS ? data[0] & 0xf : (data[0] & 0xf) % MESHES;
    const char *suffix = suffixes[format];
    const mesh_hints hints = {.component = data[0] >> 4 & 1,
                              .cells_to_points = data[0] >> 5 & 1,
                              .by_corners = data[0] >> 7};
    const uint8_t *end = data + size;
    const uint8_t *cut = strcmp(suffix, "node") == 0 ? memchr(data + 1, '$', size - 1) : NULL;
    if (cut)
        write_file(other, "ele", cut + 1, (size_t)(end - cut - 1));
    write_file(path, suffix, data + 1, (size_t)((cut ? cut : end) - data - 1));
    read_mesh(path, &hints, data[0] >> 6 & 1, format >= MESHES);
    remove(path);
    if (cut)
        remove(other);
    return 0;
}
