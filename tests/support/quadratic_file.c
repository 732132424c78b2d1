#include "tests/support/quadratic_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "formats/mesh/mesh_stream.h"

enum { N = QUADRATIC_LAB_NODES, ALL = N * N * N };

/* A cube below the lab's first node, of an edge of a tenth of its size. */
static void make_cube(const quadratic_lab *s, int number, float p[8][3], float value[8],
                      uint32_t ids[8]) {
    static const int around[8] = {0, 1, 3, 2, 4, 5, 7, 6};
    const double edge = 0.1 * s->size;
    for (int c = 0; c < 8; c++) {
        for (int a = 0; a < 3; a++)
            p[c][a] = (float)((double)s->p[0][0][0][a] - 2.0 * edge + edge * (around[c] >> a & 1) +
                              (a == 0 ? 1.5 * edge * number : 0.0));
        value[c] = (float)(s->iso - 0.3 + 0.1 * c);
        ids[c] = (uint32_t)(ALL + 8 * number + c);
    }
}

void quadratic_file_write(const quadratic_lab *s, int hexahedra, const char *path) {
    static float p[QUADRATIC_FILE_HEXAHEDRA_MAX][8][3], value[QUADRATIC_FILE_HEXAHEDRA_MAX][8];
    static uint32_t ids[QUADRATIC_FILE_HEXAHEDRA_MAX][8];
    static uint32_t rows[QUADRATIC_LAB_CELLS][QUADRATIC_NODES];
    const size_t cubes = (size_t)hexahedra;
    mesh_stream_header h = {
        .name = "lab",
        .field = "f",
        .points = ALL + 8 * cubes,
        .cells = {[CELL_HEXAHEDRON] = cubes, [CELL_QUADRATIC_TET] = QUADRATIC_LAB_CELLS}};
    mesh_stream_writer *w = NULL;
    mem m;
    for (int i = 0; i < hexahedra; i++)
        make_cube(s, i, p[i], value[i], ids[i]);
    for (int c = 0; c < QUADRATIC_LAB_CELLS; c++) {
        int nodes[QUADRATIC_NODES][3];
        (void)quadratic_lab_cell(s, c, nodes);
        for (int n = 0; n < QUADRATIC_NODES; n++)
            rows[c][n] = (uint32_t)(nodes[n][0] + N * (nodes[n][1] + N * nodes[n][2]));
    }
    mem_init(&m, 0);
    assert_int_equal(mesh_stream_create(&m, path, true, &h, &w), ST_OK);
    assert_int_equal(mesh_stream_points(w, ALL, (const float(*)[3])s->p), ST_OK);
    assert_int_equal(mesh_stream_points(w, 8 * cubes, (const float(*)[3])p), ST_OK);
    assert_int_equal(mesh_stream_values(w, ALL, (const float *)s->value), ST_OK);
    assert_int_equal(mesh_stream_values(w, 8 * cubes, (const float *)value), ST_OK);
    assert_int_equal(mesh_stream_cells(w, CELL_HEXAHEDRON, cubes, (const uint32_t *)ids), ST_OK);
    assert_int_equal(
        mesh_stream_cells(w, CELL_QUADRATIC_TET, QUADRATIC_LAB_CELLS, (const uint32_t *)rows),
        ST_OK);
    assert_int_equal(mesh_stream_commit(w), ST_OK);
    assert_int_equal(mem_used(&m), 0);
}
