/* test_surface.c - central differences at the corners of cells: of every type of samples, inside
 * the volume and at its ends.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "render/grid/surface.h"
#include "tests/support/fields.h"

/* A treelet of CELLS^3 cells with a halo, the first of a level; on each axis the volume ends with
 * it or goes on. */
enum { CELLS = 4, NODES = CELLS + 1, SIDE = NODES + 2, SAMPLES = SIDE * SIDE * SIDE, ROUNDS = 200 };

typedef struct gradient_case {
    double samples[SAMPLES]; /* as numbers */
    unsigned char bytes[SAMPLES * sizeof(float)];
    double central[3][NODES];
    level_planes planes;
    resident_grid treelet;
    walk_scene scene;
} gradient_case;

static void put_sample(gradient_case *c, int i, uint64_t bits, field_random *r) {
    const float number = (float)field_random_in(r, -10.0, 10.0);
    switch (c->scene.type) {
    case SAMPLE_U8: c->samples[i] = ((uint8_t *)c->bytes)[i] = (uint8_t)bits; return;
    case SAMPLE_I8: c->samples[i] = ((int8_t *)c->bytes)[i] = (int8_t)bits; return;
    case SAMPLE_U16: c->samples[i] = ((uint16_t *)(void *)c->bytes)[i] = (uint16_t)bits; return;
    case SAMPLE_I16: c->samples[i] = ((int16_t *)(void *)c->bytes)[i] = (int16_t)bits; return;
    default: c->samples[i] = (double)(((float *)(void *)c->bytes)[i] = number);
    }
}

static void make_case(gradient_case *c, sample_type type, field_random *r) {
    memset(c, 0, sizeof *c);
    c->scene.type = type;
    c->scene.halo = 1;
    c->scene.levels = &c->planes;
    for (int i = 0; i < SAMPLES; i++)
        put_sample(c, i, field_random_bits(r), r);
    for (int a = 0; a < 3; a++) {
        const uint32_t goes_on = (uint32_t)field_random_below(r, 2);
        c->planes.cells[a] = CELLS + goes_on;
        for (uint32_t n = 0; n < NODES; n++)
            c->central[a][n] = field_random_in(r, 0.1, 2.0);
        c->planes.central[a] = c->central[a];
        c->treelet.shape.cells[a] = CELLS;
        c->treelet.shape.samples[a] = SIDE;
    }
    c->treelet.samples = c->bytes;
}

/* The sample at a node, or at the volume's last one before it. */
static double sample_at(const gradient_case *c, const int node[3], int axis, int beside) {
    int at[3];
    for (int a = 0; a < 3; a++) {
        const int last = (int)c->planes.cells[a], moved = node[a] + (a == axis ? beside : 0);
        at[a] = (moved < 0 ? 0 : moved > last ? last : moved) + 1;
    }
    return c->samples[at[0] + SIDE * (at[1] + SIDE * at[2])];
}

static void check_cell(const gradient_case *c, const uint32_t cell[3]) {
    double gradients[8][4];
    surface_gradients(&c->scene, &c->treelet, cell, gradients);
    for (int corner = 0; corner < 8; corner++) {
        const int node[3] = {(int)cell[0] + (corner & 1), (int)cell[1] + (corner >> 1 & 1),
                             (int)cell[2] + (corner >> 2)};
        for (int a = 0; a < 3; a++) {
            const double meant =
                (sample_at(c, node, a, 1) - sample_at(c, node, a, -1)) * c->central[a][node[a]];
            assert_memory_equal(&gradients[corner][a], &meant, sizeof meant);
        }
        assert_true(gradients[corner][3] == 0.0);
    }
}

static void gradients_are_central_differences(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
    static gradient_case c;
    field_random r = {17};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        for (int round = 0; round < ROUNDS; round++) {
            make_case(&c, types[t], &r);
            for (uint32_t i = 0; i < CELLS * CELLS * CELLS; i++)
                check_cell(&c, (uint32_t[3]){i % CELLS, i / CELLS % CELLS, i / CELLS / CELLS});
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(gradients_are_central_differences)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
