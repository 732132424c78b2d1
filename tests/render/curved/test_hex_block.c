/* test_hex_block.c - of a block's cells those that a ray may cross: exactly those that are not
 * beside it, by any vectors, and all that have a part of it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/curved/hex_path.h"
#include "render/curved/hex_block.h"
#include "tests/support/hex_lab.h"
#include "tests/support/watched.h"

enum { NODES = HEX_LAB_NODES * HEX_LAB_NODES * HEX_LAB_NODES };

/* A lab's nodes, coordinate by coordinate, and as much behind them as may be read. */
typedef struct planes {
    float p[3][NODES + HEX_BLOCK_ROW];
} planes;

static void make_planes(const hex_lab *s, planes *out) {
    const float(*p)[3] = &s->p[0][0][0];
    for (int a = 0; a < 3; a++) {
        for (int n = 0; n < NODES; n++)
            out->p[a][n] = p[n][a];
        for (int n = NODES; n < NODES + HEX_BLOCK_ROW; n++)
            out->p[a][n] = NAN; /* which must not matter */
    }
}

/* A block of the lab, which has a cell at least on each axis. */
static hex_block block_of(const planes *from, const int first[3], const uint32_t cells[3]) {
    const int row = HEX_LAB_NODES, slab = row * row,
              at = first[0] + row * first[1] + slab * first[2];
    return (hex_block){.p = {from->p[0] + at, from->p[1] + at, from->p[2] + at},
                       .row = (uint32_t)row,
                       .slab = (uint32_t)slab,
                       .cells = {cells[0], cells[1], cells[2]}};
}

static bool is_beside(const hexahedron *h, const sheared_ray *r) {
    int above = 0, right = 0, left = 0;
    for (int c = 0; c < HEX_CORNERS; c++) {
        double q[3];
        sheared_ray_place(r, h->p[c], q);
        above += q[1] >= 0.0;
        right += q[0] > 0.0;
        left += q[0] < 0.0;
    }
    return above == 0 || above == HEX_CORNERS || right == HEX_CORNERS || left == HEX_CORNERS;
}

/* What one cell after the other says. */
static uint64_t expected(const hex_lab *s, const int first[3], const uint32_t cells[3],
                         const sheared_ray *r, long *crossed) {
    uint64_t out = 0;
    for (unsigned c = 0; c < 64; c++) {
        const int at[3] = {(int)(c % 4), (int)(c / 4 % 4), (int)(c / 16)};
        const int place[3] = {first[0] + at[0], first[1] + at[1], first[2] + at[2]};
        if ((uint32_t)at[0] >= cells[0] || (uint32_t)at[1] >= cells[1] ||
            (uint32_t)at[2] >= cells[2])
            continue;
        const hexahedron h = hex_lab_cell(s, place);
        hex_path path;
        const bool beside = is_beside(&h, r), has_part = hex_path_of(&h, 1, r, &path) > 0;
        assert_false(beside && has_part);
        *crossed += has_part;
        out |= (uint64_t)!beside << c;
    }
    return out;
}

/* Blocks anywhere in every shape of grid, whole and cut off; rays also through nodes and edges. */
static void test_cells(void **state) {
    enum { RAYS = SLOW ? 100 : 2000 };
    (void)state;
    static hex_lab s;
    static planes nodes;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random random = {FIELD_SEED + (uint64_t)n};
        long asked = 0, met = 0, crossed = 0;
        hex_lab_make(&s, n, FIELD_SEED);
        make_planes(&s, &nodes);
        for (int i = 0; i < RAYS; i++) {
            int first[3];
            uint32_t cells[3];
            for (int a = 0; a < 3; a++) {
                first[a] = (int)field_random_below(&random, HEX_LAB_CELLS);
                cells[a] = 1 + (uint32_t)field_random_below(&random, HEX_LAB_CELLS - first[a]);
                cells[a] = cells[a] > HEX_BLOCK ? HEX_BLOCK : cells[a];
            }
            bool special;
            const ray r = hex_lab_ray(&s, &random, &special);
            const sheared_ray sheared = sheared_ray_of(r.o, r.d);
            const hex_block b = block_of(&nodes, first, cells);
            const uint64_t right = expected(&s, first, cells, &sheared, &crossed);
            for (int isa = 0; isa <= (int)cpu_best(); isa++)
                assert_true(hex_block_cells[isa](&b, &sheared) == right);
            asked += (long)(cells[0] * cells[1] * cells[2]);
            met += __builtin_popcountll(right);
        }
        assert_true(crossed > 0 && crossed <= met && met < asked);
        print_message("# %-24s of %ld cells %ld not beside, %ld crossed\n", s.name, asked, met,
                      crossed);
    }
}

/* Nodes exactly on the two planes through the ray: on which side they count is a face's business,
 * and a cell that ends there is not left out if its face is crossed. */
static void test_planes(void **state) {
    (void)state;
    enum { SIDE = HEX_BLOCK_NODES };
    static float p[3][SIDE * SIDE * SIDE + HEX_BLOCK_ROW];
    for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
        p[0][n] = (float)(n % SIDE);
        p[1][n] = (float)(n / SIDE % SIDE);
        p[2][n] = (float)(n / (SIDE * SIDE));
    }
    const hex_block b = {{p[0], p[1], p[2]}, SIDE, SIDE * SIDE, {4, 4, 4}};
    const ray r = {.o = {2.0, 2.0, -1.0}, .d = {0.0, 0.0, 1.0}, .t0 = 0.0, .t1 = INFINITY};
    const sheared_ray sheared = sheared_ray_of(r.o, r.d);
    /* As if moved by (-e, -e^2): the cells below. Along the first axis a node at 0 is on no side.
     */
    const uint64_t slab = UINT64_C(0x60); /* cells (1, 1) and (2, 1) */
    const uint64_t all = slab | slab << 16 | slab << 32 | slab << 48;
    for (int isa = 0; isa <= (int)cpu_best(); isa++)
        assert_true(hex_block_cells[isa](&b, &sheared) == all);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cells),
        cmocka_unit_test(test_planes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
