/* test_find_steps.c - leafcast_find_steps(): the steps of a field that have a value, against a look
 * at each range of level 0; of grids of many levels, with missing data; of meshes; of files that
 * grow, and volumes that live. Nothing is read for it.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/door/leafcast_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/leaf_files.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/scratch.h"

enum { N = 68, STEPS = 12, FIRST = 5, FIELDS = 2, MESH_STEPS = 9, MOST = 16, VALUES = 40 };

/* ---- What is right ---- */

static bool wanted(const leafcast *v, uint32_t of, uint32_t step, double lo, double hi) {
    const leaf_layout *l = &v->file->layout;
    const float(*own)[2] =
        (const float(*)[2])v->file->own + (size_t)leaf_layout_set(l, of, step) * l->treelets;
    bool found = false;
    for (uint32_t t = 0; t < l->treelets; t++)
        found |= l->level_of[t] == 0 && (double)own[t][0] < hi && lo <= (double)own[t][1];
    return found;
}

/* Of all steps, of the first ones, and of the first step alone. Returns how many have it. */
static int check_values(const leafcast *v, uint32_t of, double lo, double hi) {
    const uint32_t steps = leafcast_describe(v).steps;
    uint8_t has[MOST];
    uint32_t first = MOST, found = 0;
    for (uint32_t asked = steps; asked > 0; asked = asked / 2) {
        uint32_t want = asked;
        memset(has, 7, sizeof has);
        assert_int_equal(leafcast_find_steps(v, of, lo, hi, asked, has, &first), LEAFCAST_OK);
        for (uint32_t step = asked; step-- > 0;) {
            const bool here = wanted(v, of, step, lo, hi);
            if (has[step] != here)
                fail_msg("field %u, %.9g to %.9g: step %u of %u: %u", of, lo, hi, step, asked,
                         has[step]);
            want = here ? step : want;
            found += here && asked == steps;
        }
        assert_int_equal(has[asked], 7);
        assert_int_equal(first, want);
        first = MOST;
        assert_int_equal(leafcast_find_steps(v, of, lo, hi, asked, NULL, &first), LEAFCAST_OK);
        assert_int_equal(first, want);
    }
    return (int)found;
}

/* Isovalues and intervals, over all values and beyond them; and the ends of each step's range,
 * where a surface is at the upper one alone. */
static void check_all(const leafcast *v) {
    const leafcast_info info = leafcast_describe(v);
    const double width = info.value_max - info.value_min;
    for (uint32_t of = 0; of < info.fields; of++) {
        bool some = false;
        for (int i = -2; i < VALUES + 2; i++) {
            const double lo = info.value_min + width * (i + 0.3) / VALUES;
            const int found = check_values(v, of, lo, lo);
            some |= found > 0 && found < (int)info.steps;
            (void)check_values(v, of, lo, lo + width / 9);
        }
        assert_true(some || info.steps == 1);
        for (uint32_t step = 0; step < info.steps; step++) {
            double range[2];
            assert_int_equal(leafcast_range(v, of, step, range), LEAFCAST_OK);
            for (int end = 0; end < 2 && range[0] <= range[1]; end++) {
                (void)check_values(v, of, range[end], range[end]);
                (void)check_values(v, of, nextafter(range[end], -INFINITY), range[end]);
                (void)check_values(v, of, range[end], nextafter(range[end], INFINITY));
            }
        }
        assert_int_equal(check_values(v, of, DBL_MAX, DBL_MAX), 0);
        assert_int_equal(check_values(v, of, -DBL_MAX, -DBL_MAX), 0);
    }
    assert_int_equal(loader_statistics(v->treelets).bytes_read, 0);
}

/* ---- Grids ---- */

/* A small ball that each step has at another place, and of other values. Step 7 has no data at all;
 * of others a corner is missing. Of the last one the middle is, on both sides of which all is one
 * value: no treelet has what is between, but coarser ones' ranges do. */
static const char *write_step(int step, int of_field) {
    char name[32];
    float *v = malloc(sizeof *v * N * N * N);
    for (int i = 0; i < N * N * N; i++) {
        const int x = i % N, y = i / N % N, z = i / N / N, at = 3 + 3 * (step * 5 % STEPS);
        const int d = (x - at) * (x - at) + (y - 20) * (y - 20) + (z - 30) * (z - 30);
        v[i] = (float)(d > 30 ? -1 : (step * 4 % 11) + of_field * 3 - d / 30.0);
        if (step == STEPS - 1)
            v[i] = (float)(x < N / 2 ? -1 : 20);
        if (step == 7 || (step == STEPS - 1 && abs(x - 40) < 13) || (x < 5 && y < 7))
            v[i] = NAN;
    }
    snprintf(name, sizeof name, "find%d_%d.bin", of_field, step);
    const char *path = strdup(scratch_write(name, v, sizeof *v * N * N * N));
    free(v);
    return path;
}

typedef struct series {
    const char *paths[STEPS * FIELDS]; /* field 0 at all steps, then field 1 */
    leaf_case c;
} series;

static void make(series *s) {
    s->c = leaf_files_case(N, N, N, SAMPLE_F32);
    s->c.options.force = true;
    for (int i = 0; i < STEPS * FIELDS; i++)
        s->paths[i] = write_step(i % STEPS, i / STEPS);
}

static void release(series *s) {
    for (int i = 0; i < STEPS * FIELDS; i++)
        free((void *)(uintptr_t)s->paths[i]);
}

static grid_series steps_of(const series *s, uint32_t fields, uint32_t first, uint32_t count) {
    return (grid_series){
        .of = {.paths = s->paths + first, .sets = {fields, count, NULL, NULL, NULL}},
        .hints = {.dims = {N, N, N}, .type = SAMPLE_F32}};
}

static void test_grid(void **state) {
    (void)state;
    series s;
    make(&s);
    const grid_series all = steps_of(&s, FIELDS, 0, STEPS);
    leafcast *v = fixture_open(leaf_files_series(&all, &s.c.options, "find.leaf"), NULL);
    const leafcast_info info = leafcast_describe(v);
    assert_true(info.fields == FIELDS && info.steps == STEPS && info.levels > 2);
    check_all(v);
    leafcast_close(v);
    release(&s);
}

/* Steps that come are found, and those that were there stay what they are. */
static void test_grown(void **state) {
    (void)state;
    series s;
    make(&s);
    const grid_series before = steps_of(&s, 1, 0, FIRST),
                      more = steps_of(&s, 1, FIRST, STEPS - FIRST);
    convert_options o = s.c.options;
    o.grows = true;
    const char *path = leaf_files_series(&before, &o, "find_grown.leaf");
    leafcast *v = fixture_open(path, NULL);
    uint32_t first = 0, steps = 0;
    check_all(v);
    assert_int_equal(leafcast_find_steps(v, 0, 9.5, 9.5, FIRST, NULL, &first), LEAFCAST_OK);
    assert_int_equal(first, FIRST);
    assert_int_equal(leaf_files_add(&more, &s.c.options, path), ST_OK);
    assert_int_equal(leafcast_find_steps(v, 0, 9.5, 9.5, STEPS, NULL, &first), LEAFCAST_USAGE);
    assert_int_equal(leafcast_refresh(v, &steps), LEAFCAST_OK);
    assert_int_equal(steps, STEPS);
    assert_int_equal(leafcast_find_steps(v, 0, 9.5, 9.5, STEPS, NULL, &first), LEAFCAST_OK);
    assert_int_equal(first, 8);
    check_all(v);
    leafcast_close(v);
    release(&s);
}

static void test_live(void **state) {
    (void)state;
    leafcast_grid g = {
        .size = sizeof g, .dims = {N, N, N}, .type = LEAFCAST_F32, .spacing = {1, 1, 1}};
    float *values = calloc((size_t)N * N * N, sizeof *values);
    leafcast *v;
    assert_int_equal(leafcast_open_live(&g, NULL, &v), LEAFCAST_OK);
    for (int step = 0; step < 3; step++) {
        uint8_t has = 7;
        uint32_t first = 7;
        values[N * N * N - 1] = (float)step;
        assert_int_equal(leafcast_update(v, NULL, NULL, values, NULL), LEAFCAST_OK);
        assert_int_equal(leafcast_commit(v, step), LEAFCAST_OK);
        assert_int_equal(leafcast_find_steps(v, 0, 1.5, 1.5, 1, &has, &first), LEAFCAST_OK);
        assert_int_equal(has, step > 1);
        assert_int_equal(first, step < 2);
        assert_int_equal(leafcast_find_steps(v, 0, 1.5, 1.5, 2, &has, &first), LEAFCAST_USAGE);
    }
    leafcast_close(v);
    free(values);
}

/* ---- Meshes ---- */

static void check_mesh(int non_finite, const char *name) {
    mesh_case c = mesh_leaves_cube(5, FIELDS, MESH_STEPS, 31, non_finite);
    for (uint32_t set = 0; set < FIELDS * MESH_STEPS; set++)
        for (size_t p = 0; p < c.points; p++)
            c.values[set * c.points + p] += (float)(set * 5 % 11);
    leafcast *v = fixture_open(mesh_leaves_make(&c, name), NULL);
    assert_int_equal(leafcast_describe(v).steps, MESH_STEPS);
    check_all(v);
    leafcast_close(v);
    mesh_leaves_release(&c);
}

static void test_mesh(void **state) {
    (void)state;
    check_mesh(0, "find_mesh.leaf");
    check_mesh(5, "find_mesh_holes.leaf");
}

/* ---- Wrong arguments ---- */

static void refused(const leafcast *v, uint32_t of, double lo, double hi, uint32_t steps,
                    const char *why) {
    uint8_t has[MOST] = {7};
    uint32_t first = 7;
    assert_int_equal(leafcast_find_steps(v, of, lo, hi, steps, has, &first), LEAFCAST_USAGE);
    if (!strstr(leafcast_error_text(), why))
        fail_msg("\"%s\" is not in: %s", why, leafcast_error_text());
    assert_true(has[0] == 7 && first == 7);
}

static void test_refused(void **state) {
    (void)state;
    mesh_case c = mesh_leaves_cube(3, FIELDS, MESH_STEPS, 31, 0);
    leafcast *v = fixture_open(mesh_leaves_make(&c, "find_mesh.leaf"), NULL);
    refused(v, FIELDS, 1, 1, 1, "fields");
    refused(v, 0, 1, 1, MESH_STEPS + 1, "steps");
    refused(v, 0, 1, 1, UINT32_MAX, "steps");
    refused(v, 0, 1, 1, 0, "steps");
    refused(v, 0, 1, 0.5, 1, "hi");
    refused(v, 0, NAN, 1, 1, "lo");
    refused(v, 0, -INFINITY, 1, 1, "lo");
    refused(v, 0, 1, INFINITY, 1, "hi");
    refused(v, 0, 1, NAN, 1, "hi");
    assert_int_equal(leafcast_find_steps(v, 0, 1, 1, 1, NULL, NULL), LEAFCAST_USAGE);
    leafcast_close(v);
    mesh_leaves_release(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid), cmocka_unit_test(test_grown),   cmocka_unit_test(test_live),
        cmocka_unit_test(test_mesh), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
