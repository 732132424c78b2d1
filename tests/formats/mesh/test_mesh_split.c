/* test_mesh_split.c - cells as tets: every numbering gives tets that fill the cell, turned alike,
 * and cut its faces as the neighbours do.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/mesh/mesh_split.h"

typedef struct shape {
    cell_shape kind;
    int vertices, faces, tets;
    double volume6; /* six times */
    double at[8][3];
    int face[6][4]; /* in order around; -1: a triangle */
} shape;

/* Plane faces, but no other symmetry. */
static const shape shapes[] = {
    {CELL_HEXAHEDRON,
     8,
     6,
     6,
     6,
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
     {{0, 1, 2, 3}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}},
    {CELL_VOXEL,
     8,
     6,
     6,
     6,
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}},
     {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {1, 3, 7, 5}, {3, 2, 6, 7}, {2, 0, 4, 6}}},
    {CELL_WEDGE,
     6,
     5,
     3,
     3,
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}},
     {{0, 1, 2, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}}},
    {CELL_PYRAMID,
     5,
     5,
     2,
     2,
     {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.3, 0.4, 1}},
     {{0, 1, 2, 3}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}},
    {CELL_TET,
     4,
     4,
     1,
     1,
     {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
     {{0, 1, 2, -1}, {0, 1, 3, -1}, {0, 2, 3, -1}, {1, 2, 3, -1}}},
};

enum { SHAPES = sizeof shapes / sizeof *shapes };

/* Where the vertex of an id lies. */
static int index_of(const shape *s, const uint32_t *ids, uint32_t id) {
    for (int i = 0; i < s->vertices; i++)
        if (ids[i] == id)
            return i;
    fail_msg("id %u is none of the cell's", id);
    return 0;
}

static double volume6(const shape *s, const int t[4]) {
    double e[3][3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            e[i][k] = s->at[t[i + 1]][k] - s->at[t[0]][k];
    return e[2][0] * (e[0][1] * e[1][2] - e[0][2] * e[1][1]) +
           e[2][1] * (e[0][2] * e[1][0] - e[0][0] * e[1][2]) +
           e[2][2] * (e[0][0] * e[1][1] - e[0][1] * e[1][0]);
}

/* How many tets have all three vertices. */
static int tets_at(int (*t)[4], int count, int a, int b, int c) {
    int found = 0;
    for (int i = 0; i < count; i++) {
        int has = 0;
        for (int k = 0; k < 4; k++)
            has += t[i][k] == a || t[i][k] == b || t[i][k] == c;
        found += has == 3;
    }
    return found;
}

/* A face shows exactly the triangles that its own ids ask for: a quad's smallest with the two
 * edges it does not lie on. */
static void check_face(const shape *s, const uint32_t *ids, const int face[4], int (*t)[4],
                       int count) {
    if (face[3] < 0) {
        assert_int_equal(tets_at(t, count, face[0], face[1], face[2]), 1);
        return;
    }
    int low = 0;
    for (int k = 1; k < 4; k++)
        if (ids[face[k]] < ids[face[low]])
            low = k;
    int a = face[low], b = face[(low + 1) % 4], c = face[(low + 2) % 4], d = face[(low + 3) % 4];
    assert_int_equal(tets_at(t, count, a, b, c), 1);
    assert_int_equal(tets_at(t, count, a, c, d), 1);
    assert_int_equal(tets_at(t, count, a, b, d) + tets_at(t, count, b, c, d), 0);
    (void)s;
}

static void check_cell(const shape *s, const uint32_t *ids) {
    uint32_t tets[MESH_SPLIT_TETS][4];
    int t[MESH_SPLIT_TETS][4], count = mesh_split(s->kind, ids, tets);
    double sum = 0;
    assert_int_equal(count, s->tets);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 4; k++)
            t[i][k] = index_of(s, ids, tets[i][k]);
        assert_true(volume6(s, t[i]) > 0);
        sum += volume6(s, t[i]);
    }
    assert_true(fabs(sum - s->volume6) < 1e-12);
    for (int i = 0; i < s->faces; i++)
        check_face(s, ids, s->face[i], t, count);
    /* A triangle of two tets has them on its two sides, one of the boundary has one: volumes that
     * are all positive and fill the cell leave no room for anything else. */
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 4; k++)
            assert_true(tets_at(t, count, t[i][k], t[i][(k + 1) % 4], t[i][(k + 2) % 4]) <= 2);
}

/* All orders of the ids, by Heap's method. */
static void permute(const shape *s, uint32_t *ids, int count) {
    if (count == 1) {
        check_cell(s, ids);
        return;
    }
    for (int i = 0; i < count; i++) {
        permute(s, ids, count - 1);
        int other = count % 2 ? 0 : i;
        uint32_t kept = ids[other];
        ids[other] = ids[count - 1];
        ids[count - 1] = kept;
    }
}

static void test_every_numbering(void **state) {
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        uint32_t ids[8] = {7, 100, 3, 4000000000u, 0, 12, 13, 900};
        assert_int_equal(cell_shape_vertices(shapes[i].kind), shapes[i].vertices);
        permute(&shapes[i], ids, shapes[i].vertices);
    }
}

static bool repeats(const uint32_t t[4]) {
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < i; k++)
            if (t[i] == t[k])
                return true;
    return false;
}

/* A hex collapsed along an edge of its top and bottom is a wedge: what is left when tets with a
 * vertex twice go fills it, whatever the numbering. */
static void check_collapsed(const uint32_t six[6]) {
    const uint32_t ids[8] = {six[0], six[1], six[2], six[2], six[3], six[4], six[5], six[5]};
    const shape *wedge = &shapes[2];
    uint32_t tets[MESH_SPLIT_TETS][4];
    int count = mesh_split(CELL_HEXAHEDRON, ids, tets), kept = 0, t[MESH_SPLIT_TETS][4];
    double sum = 0;
    for (int i = 0; i < count; i++) {
        if (repeats(tets[i]))
            continue;
        for (int k = 0; k < 4; k++)
            t[kept][k] = index_of(wedge, six, tets[i][k]);
        assert_true(volume6(wedge, t[kept]) > 0);
        sum += volume6(wedge, t[kept++]);
    }
    assert_int_equal(kept, 3);
    assert_true(fabs(sum - wedge->volume6) < 1e-12);
    for (int i = 0; i < wedge->faces; i++)
        check_face(wedge, six, wedge->face[i], t, kept);
}

static void permute_collapsed(uint32_t *ids, int count) {
    if (count == 1) {
        check_collapsed(ids);
        return;
    }
    for (int i = 0; i < count; i++) {
        permute_collapsed(ids, count - 1);
        int other = count % 2 ? 0 : i;
        uint32_t kept = ids[other];
        ids[other] = ids[count - 1];
        ids[count - 1] = kept;
    }
}

static void test_collapsed(void **state) {
    (void)state;
    uint32_t ids[6] = {5, 1, 9, 2, 30, 4};
    permute_collapsed(ids, 6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_numbering),
        cmocka_unit_test(test_collapsed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
