/* test_export_heights.c - terrain as triangles: the two of each cell with data, and no others, seen
 * from above; vertices and values to the bit; what treelets share; boxes, levels, and maps that
 * mirror.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "prep/export/heights_surface.h"
#include "tests/support/heights_lab.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

enum { SIDE = 70, CELLS_LOG2 = 4, NODES = 2 * SIDE * SIDE };

/* A node of the level that is seen as a vertex. */
typedef struct seen_node {
    hash_id key;
    bool keyed;
    int vertices;
    float value;
    double at[3];
} seen_node;

typedef struct surface {
    heights_terrain terrain;
    leaf_file *f;
    grid_part part;
    piece_source source;
    mem m;
    uint32_t sets[2];
    seen_node *node;
    int *triangles; /* of each cell: a bit each of its two halves */
} surface;

static long node_of(const surface *s, const piece_vertex *v) {
    const heights_truth *h = &s->terrain.truth;
    const double x = (v->at[0] - h->origin[0]) / h->spacing[0],
                 y = (v->at[1] - h->origin[1]) / h->spacing[1];
    const double size = 1u << s->part.level;
    const long i = lround(x / size), j = lround(y / size);
    assert_true(fabs(x - (double)i * size) < 1e-6 && fabs(y - (double)j * size) < 1e-6);
    assert_true(i >= 0 && i < h->nx && j >= 0 && j < h->ny);
    return i + h->nx * j;
}

/* A vertex lies at its node; others at that node have its key, and its place to the bit. */
static void take_vertex(surface *s, const piece *p, uint32_t n) {
    const heights_truth *h = &s->terrain.truth;
    const piece_vertex *v = &p->vertex[n];
    const long at = node_of(s, v);
    seen_node *seen = &s->node[at];
    assert_true(v->normal[0] == 0.0 && v->normal[1] == 0.0 && v->normal[2] == 0.0);
    if (s->part.level == 0) {
        assert_true(p->values[0][n] == h->heights[at] && p->values[1][n] == h->heights[at]);
        assert_true(fabs(v->at[2] - (double)h->heights[at] * h->scale) <=
                    1e-15 * fabs((double)h->heights[at] * h->scale));
    }
    const hash_id *key = NULL;
    for (uint32_t k = 0; k < p->shares && !key; k++)
        if (p->share[k].vertex == n)
            key = &p->share[k].key;
    if (seen->vertices++ > 0) {
        assert_true(key && seen->keyed);
        assert_memory_equal(key, &seen->key, sizeof *key);
        assert_memory_equal(v->at, seen->at, sizeof v->at);
    }
    seen->keyed = key != NULL;
    if (key)
        seen->key = *key;
    memcpy(seen->at, v->at, sizeof v->at);
    seen->value = p->values[0][n];
}

/* Nodes have keys of their own. */
static void check_keys(const surface *s) {
    static int keyed[NODES];
    int count = 0;
    for (int i = 0; i < NODES; i++)
        if (s->node[i].keyed)
            keyed[count++] = i;
    assert_true(count > 0 || s->part.end[0] < (1u << CELLS_LOG2));
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            assert_memory_not_equal(&s->node[keyed[i]].key, &s->node[keyed[k]].key,
                                    sizeof(hash_id));
}

/* One half of a cell, that from its first node to the one across: counterclockwise from above. */
static void take_triangle(surface *s, const piece *p, uint32_t n) {
    const int nx = s->terrain.truth.nx;
    long at[3][2], least[2] = {nx, NODES};
    int nodes = 0;
    double area = 0.0;
    for (int k = 0; k < 3; k++) {
        const long node = node_of(s, &p->vertex[p->corner[3 * n + (uint32_t)k]]);
        at[k][0] = node % nx;
        at[k][1] = node / nx;
        for (int a = 0; a < 2; a++)
            least[a] = at[k][a] < least[a] ? at[k][a] : least[a];
    }
    for (int k = 0; k < 3; k++) {
        const double *a = p->vertex[p->corner[3 * n + (uint32_t)k]].at,
                     *b = p->vertex[p->corner[3 * n + (uint32_t)(k + 1) % 3]].at;
        area += a[0] * b[1] - a[1] * b[0];
        nodes |= 1 << (at[k][0] - least[0] + 2 * (at[k][1] - least[1]));
    }
    assert_true(area * s->terrain.truth.scale > 0.0 || fabs(s->terrain.truth.origin[0]) > 1e3);
    assert_true(nodes == (1 | 2 | 8) || nodes == (1 | 4 | 8));
    int *cell = &s->triangles[least[0] + nx * least[1]];
    const int half = nodes & 2 ? 1 : 2;
    if (*cell & half)
        fail_msg("cell %ld %ld: its half %d twice", least[0], least[1], half);
    *cell |= half;
}

static void open_surface(surface *s, int shape, uint32_t level, const uint32_t box[6]) {
    memset(s, 0, sizeof *s);
    heights_lab_make(&s->terrain, shape, SIDE, FIELD_SEED);
    assert_true(s->terrain.truth.nx * s->terrain.truth.ny <= NODES);
    mem_init(&s->m, 0);
    assert_int_equal(
        leaf_file_open(&s->m, heights_lab_leaf(&s->terrain, CELLS_LOG2, 1, true), &s->f), ST_OK);
    assert_int_equal(grid_part_of(s->f, level, box, &s->part), ST_OK);
    assert_int_equal(heights_surface_create(&s->m, s->f, &s->part, s->sets, 2, 1, &s->source),
                     ST_OK);
    s->node = calloc(NODES, sizeof *s->node);
    s->triangles = calloc(NODES, sizeof *s->triangles);
}

static void make_all(surface *s) {
    piece p = {.m = &s->m};
    for (uint32_t i = 0; i < s->source.pieces; i++) {
        assert_int_equal(s->source.make(s->source.ctx, i, 0, &p), ST_OK);
        for (uint32_t n = 0; n < p.vertices; n++)
            take_vertex(s, &p, n);
        for (uint32_t n = 0; n < p.cells; n++)
            take_triangle(s, &p, n);
    }
    piece_release(&p);
    check_keys(s);
}

static void close_surface(surface *s) {
    piece_source_release(&s->source);
    leaf_file_close(s->f);
    assert_int_equal(mem_used(&s->m), 0);
    heights_lab_release(&s->terrain);
    free(s->node);
    free(s->triangles);
}

static bool has_data(const heights_truth *h, long i, long j) {
    const float *p = h->heights + i + h->nx * j;
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[h->nx]) && isfinite(p[h->nx + 1]);
}

/* The cells of a box of nodes, of level 0. */
static void check_cells(const surface *s, const uint32_t lo[2], const uint32_t hi[2]) {
    const heights_truth *h = &s->terrain.truth;
    int whole = 0;
    for (long j = 0; j < h->ny; j++)
        for (long i = 0; i < h->nx; i++) {
            const bool in = i >= lo[0] && i < hi[0] && j >= lo[1] && j < hi[1];
            const int want = in && has_data(h, i, j) ? 3 : 0;
            whole += want != 0;
            if (s->triangles[i + h->nx * j] != want)
                fail_msg("cell %ld %ld: %d, not %d", i, j, s->triangles[i + h->nx * j], want);
        }
    assert_true(whole > 50);
}

static void test_all(void **state) {
    (void)state;
    for (int shape = 0; shape < HEIGHTS_SHAPES; shape++) {
        surface s;
        open_surface(&s, shape, 0, NULL);
        make_all(&s);
        const heights_truth *h = &s.terrain.truth;
        check_cells(&s, (uint32_t[2]){0, 0},
                    (uint32_t[2]){(uint32_t)h->nx - 1, (uint32_t)h->ny - 1});
        close_surface(&s);
    }
}

/* Within a treelet, across some, and along their borders. */
static void test_boxes(void **state) {
    static const uint32_t boxes[][4] = {
        {3, 2, 12, 14}, {10, 15, 40, 44}, {16, 16, 32, 32}, {31, 5, 33, 45}};
    (void)state;
    for (int i = 0; i < 4; i++) {
        const uint32_t *b = boxes[i], box[6] = {b[0], 0, b[1], b[2], 1, b[3]};
        surface s;
        open_surface(&s, 0, 0, box);
        make_all(&s);
        check_cells(&s, b, b + 2);
        close_surface(&s);
    }
}

/* All cells of a coarse level that lie on the lattice. */
static void test_level(void **state) {
    (void)state;
    surface s;
    uint32_t box[6] = {0, 0, 0, 0, 1, 0};
    open_surface(&s, 0, 0, NULL);
    box[3] = (uint32_t)(s.terrain.truth.nx - 1) / 2;
    box[5] = (uint32_t)(s.terrain.truth.ny - 1) / 2;
    close_surface(&s);
    open_surface(&s, 0, 1, box);
    make_all(&s);
    int both = 0;
    for (int i = 0; i < NODES; i++)
        both += s.triangles[i] == 3;
    assert_int_equal(both, box[3] * box[5]);
    naive_leaf leaf;
    if (!naive_leaf_load(&leaf, scratch_path("terrain.leaf")))
        fail_msg("%s", leaf.why);
    for (uint32_t j = 0; j <= box[5]; j++)
        for (uint32_t i = 0; i <= box[3]; i++)
            assert_true(s.node[i + (uint32_t)s.terrain.truth.nx * j].value ==
                        leaf.level[1].samples[i + (uint32_t)leaf.level[1].nodes[0] * 2 * j]);
    naive_leaf_release(&leaf);
    close_surface(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_all), cmocka_unit_test(test_boxes),
                                       cmocka_unit_test(test_level)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
