/* tool_hex_stress.c - isosurfaces of curved cells beside brute force
 * (tests/support/hex_judge.h), at length.
 *
 *   tool_hex_stress [COUNT [CASE]]
 *
 * COUNT rays of each shape of tests/support/hex_lab.c, in meshes of mixed cells, then of
 * quadratic_lab.c, whose cells are sound, or of one; half of them in pictures.
 *
 *   tool_hex_stress COUNT F.leaf ISO
 *
 * The same of a file; of a curvilinear grid, for one.
 *
 * Prints a table; the numbers of the first meshes with a fault. Exit status 1 when there is one.
 * The seed is $SEED, else 1.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prep/leafcast_prep.h"
#include "tests/support/fixture.h"
#include "tests/support/hex_judge.h"
#include "tests/support/mixed_file.h"
#include "tests/support/quadratic_file.h"
#include "tests/support/scratch.h"

enum { SIDE = 16, RAYS = SIDE * SIDE, TREELET = 60, HEXAHEDRA = 5, TOLD = 5 };

static uint64_t count = 10000, seed = 1;
static const char *only, *iso;
static uint64_t faults;

static leafcast_camera look(leafcast *v, field_random *r) {
    leafcast_camera c = leafcast_standard_view(v, 1.1, SIDE, SIDE);
    double out[3], away = 0.0, square = 0.0;
    for (int a = 0; a < 3; a++) {
        out[a] = field_random_in(r, -1.0, 1.0);
        square += out[a] * out[a];
        away += (c.eye[a] - c.look_at[a]) * (c.eye[a] - c.look_at[a]);
    }
    away = sqrt(away) * field_random_in(r, 0.3, 1.2);
    for (int a = 0; a < 3; a++)
        c.eye[a] = c.look_at[a] + out[a] / sqrt(square) * away;
    return c;
}

/* RAYS in a picture, and as many one by one. */
static bool judge(const hex_judge *j, leafcast *v, double at, field_random *r, hex_tally *t) {
    const leafcast_info info = leafcast_describe(v);
    const leafcast_camera c = look(v, r);
    const leafcast_surface surface = leafcast_surface_default(at);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    bool right = hex_judge_picture(j, v, at, &c, t);
    for (int n = 0; n < RAYS; n++) {
        double o[3], d[3], square = 0.0;
        for (int a = 0; a < 3; a++) {
            const double size = info.bounds[1][a] - info.bounds[0][a];
            o[a] = info.bounds[0][a] + size * field_random_in(r, -1.0, 2.0);
            d[a] = info.bounds[0][a] + size * field_random_unit(r) - o[a];
            square += d[a] * d[a];
        }
        for (int a = 0; a < 3; a++)
            d[a] /= sqrt(square);
        right = hex_judge_ray(j, v, at, o, d, t) && right;
    }
    return right;
}

static bool is_sound(const hex_judge *j) {
    for (size_t i = 0; i < j->count; i++)
        if (curved_cell_sense(&j->of[i].cell) == 0)
            return false;
    return true;
}

static void run_lab(int which) {
    static cell_mix mix;
    hex_tally sum = {0};
    int told = 0;
    for (uint64_t n = 0; sum.rays < count && n < count; n++) {
        field_random r = {seed * UINT64_C(1000003) + n};
        mesh_result result;
        hex_judge j;
        cell_mix_make(&mix, which, field_random_bits(&r));
        hex_judge_mix(&j, &mix);
        if (!mix.lab.may_be_folded || is_sound(&j)) {
            (void)mixed_file_write(mix.cell, mix.count, scratch_path("mix.vtk"));
            mixed_file_convert(scratch_path("mix.vtk"), scratch_path("mix.leaf"), TREELET,
                               UINT64_C(1) << 32, &result);
            leafcast *v = fixture_open(scratch_path("mix.leaf"), NULL);
            if (!judge(&j, v, mix.lab.iso, &r, &sum) && told++ < TOLD)
                printf("mesh %llu\n", (unsigned long long)n);
            leafcast_close(v);
        }
        hex_judge_release(&j);
    }
    if (sum.rays)
        hex_tally_row(stdout, mix.lab.name, &sum);
    fflush(stdout);
    faults += hex_tally_faults(&sum);
}

static void convert_quadratic(const quadratic_lab *s, int hexahedra) {
    leafcast_convert_options o = {.size = sizeof o};
    o.whole_cells = o.replace = true;
    o.treelet_tets = TREELET;
    quadratic_file_write(s, hexahedra, scratch_path("lab.mesh"));
    if (leafcast_convert_path(scratch_path("lab.mesh"), scratch_path("lab.leaf"), &o) !=
        LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void run_quadratic(int which) {
    static quadratic_lab s;
    char name[32];
    hex_tally sum = {0};
    int told = 0;
    for (uint64_t n = 0; sum.rays < count && n < count; n++) {
        field_random r = {seed * UINT64_C(1000003) + n};
        hex_judge j;
        quadratic_lab_make(&s, which, field_random_bits(&r));
        convert_quadratic(&s, n % 2 ? HEXAHEDRA : 0);
        leafcast *v = fixture_open(scratch_path("lab.leaf"), NULL);
        const leafcast_surface surface = leafcast_surface_default(s.iso);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        hex_judge_open(&j, v);
        if (is_sound(&j) && !judge(&j, v, s.iso, &r, &sum) && told++ < TOLD)
            printf("mesh %llu\n", (unsigned long long)n);
        leafcast_close(v);
        hex_judge_release(&j);
    }
    snprintf(name, sizeof name, "tets, %s", s.name);
    if (sum.rays)
        hex_tally_row(stdout, name, &sum);
    fflush(stdout);
    faults += hex_tally_faults(&sum);
}

static void run_file(void) {
    hex_tally sum = {0};
    hex_judge j;
    field_random r = {seed};
    leafcast *v = fixture_open(only, NULL);
    const leafcast_surface surface = leafcast_surface_default(atof(iso));
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    hex_judge_open(&j, v);
    while (sum.rays < count)
        (void)judge(&j, v, atof(iso), &r, &sum);
    hex_tally_row(stdout, iso, &sum);
    faults += hex_tally_faults(&sum);
    hex_judge_release(&j);
    leafcast_close(v);
}

static void run(void **state) {
    static quadratic_lab q;
    hex_lab s;
    (void)state;
    hex_tally_heading(stdout);
    for (int i = 0; i < hex_lab_count() && !iso; i++) {
        hex_lab_make(&s, i, 1);
        if (!only || strcmp(only, s.name) == 0)
            run_lab(i);
    }
    for (int i = 0; i < quadratic_lab_count() && !iso; i++) {
        quadratic_lab_make(&q, i, 1);
        if (!only || strcmp(only, q.name) == 0)
            run_quadratic(i);
    }
    if (iso)
        run_file();
}

int main(int argc, char **argv) {
    const char *given = getenv("SEED");
    const struct CMUnitTest all[] = {cmocka_unit_test(run)};
    seed = given ? strtoull(given, NULL, 10) : seed;
    count = argc > 1 ? strtoull(argv[1], NULL, 10) : count;
    only = argc > 2 ? argv[2] : NULL;
    iso = argc > 3 ? argv[3] : NULL;
    return cmocka_run_group_tests(all, NULL, NULL) != 0 || faults > 0;
}
