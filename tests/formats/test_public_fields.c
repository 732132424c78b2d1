/* test_public_fields.c - every field of every public struct has a row of the tables, every public
 * function a row of support/public_calls.c; each call refuses each field that is wrong, in every
 * way that its row knows, by name, and each pointer that is NULL; the volume draws the same bits
 * after that.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <limits.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "prep/prep_arguments.h"
#include "render/door/arguments.h"
#include "tests/support/public_calls.h"
#include "tests/support/public_header.h"

/* ---- The tables against the headers ---- */

static bool has_row(const public_fields *table, const char *field) {
    for (int i = 0; i < table->count; i++)
        if (strcmp(table->rows[i].name, field) == 0)
            return true;
    return false;
}

static const public_header *headers(void) {
    static public_header h;
    if (h.members > 0)
        return &h;
    public_header_read(&h, "formats/leafcast_status.h");
    public_header_read(&h, "formats/leafcast_grid.h");
    public_header_read(&h, "render/leafcast.h");
    public_header_read(&h, "render/leafcast_dynamic.h");
    public_header_read(&h, "render/leafcast_look.h");
    public_header_read(&h, "render/leafcast_experimental.h");
    public_header_read(&h, "prep/leafcast_prep.h");
    return &h;
}

static void test_every_field(void **state) {
    (void)state;
    const public_header *h = headers();
    assert_true(h->members > 200);
    for (int i = 0; i < h->members; i++) {
        const public_fields *table = public_calls_table(h->of[i]);
        if (!table)
            fail_msg("%s has no table", h->of[i]);
        else if (!table->written && !has_row(table, h->member[i]))
            fail_msg("%s.%s has no row in the table", h->of[i], h->member[i]);
    }
}

static void test_every_row(void **state) {
    (void)state;
    const public_header *h = headers();
    int rows = 0, known = 0, counts[2];
    const public_fields *const *const tables[2] = {arguments_tables(&counts[0]),
                                                   prep_arguments_tables(&counts[1])};
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < counts[k]; i++)
            rows += tables[k][i]->count;
    for (int i = 0; i < h->members; i++) {
        const public_fields *table = public_calls_table(h->of[i]);
        known += table && has_row(table, h->member[i]);
    }
    assert_int_equal(known, rows);
}

static void test_every_call(void **state) {
    (void)state;
    const public_header *h = headers();
    int count;
    const public_call *calls = public_calls(&count);
    for (int i = 0; i < h->functions; i++) {
        int k = 0;
        while (k < count && strcmp(calls[k].name, h->function[i]) != 0)
            k++;
        if (k == count)
            fail_msg("%s() has no row in public_calls()", h->function[i]);
    }
    assert_int_equal(h->functions, count);
}

/* ---- Wrong values ---- */

enum { WRONG_MAX = 8 };

typedef union number {
    uint8_t byte;
    int whole;
    uint32_t u32;
    uint64_t u64;
    float f32;
    double f64;
    void *pointer;
} number;

static int add_whole(const public_field *row, number wrong[WRONG_MAX]) {
    const double last = row->type == PUBLIC_INT      ? INT_MAX
                        : row->type == PUBLIC_UINT32 ? UINT32_MAX
                                                     : (double)UINT64_MAX;
    const double first = row->type == PUBLIC_INT ? INT_MIN : 0.0;
    const double all[] = {row->least - 1.0, row->most + 1.0, first, last};
    int count = 0;
    for (int i = 0; i < 4; i++) {
        const double x = all[i];
        const bool allowed =
            (x >= row->least && x <= row->most) || (row->how & PUBLIC_OR_ZERO && x == 0.0);
        if (allowed || x < first || x > last)
            continue;
        if (row->type == PUBLIC_INT)
            wrong[count++].whole = (int)x;
        else if (row->type == PUBLIC_UINT32)
            wrong[count++].u32 = (uint32_t)x;
        else
            wrong[count++].u64 = x >= last ? UINT64_MAX : (uint64_t)x;
    }
    return count;
}

static int add_real(const public_field *row, number wrong[WRONG_MAX]) {
    const bool narrow = row->type == PUBLIC_FLOAT;
    const double below = narrow ? (double)nextafterf((float)row->least, -INFINITY)
                                : nextafter(row->least, -INFINITY);
    const double above =
        narrow ? (double)nextafterf((float)row->most, INFINITY) : nextafter(row->most, INFINITY);
    double all[] = {row->how & PUBLIC_ABOVE ? row->least : below,
                    row->how & PUBLIC_BELOW ? row->most : above, NAN, -INFINITY, INFINITY};
    int count = 0;
    for (int i = 0; i < 5; i++) {
        if (all[i] == INFINITY && row->most == INFINITY)
            continue;
        if (narrow)
            wrong[count++].f32 = (float)all[i];
        else
            wrong[count++].f64 = all[i];
    }
    return count;
}

/* What a value of this row may not be, each time in all of its bytes. */
static int wrong_values(const public_fields *table, const public_field *row,
                        number wrong[WRONG_MAX]) {
    switch (row->type) {
    case PUBLIC_BOOL:
        wrong[0].byte = 2;
        wrong[1].byte = 0xff;
        return 2;
    case PUBLIC_SIZE:
        for (int i = 0; i < 4; i++)
            wrong[i].u64 = (const uint64_t[]){0, 8, table->size + 1, UINT64_MAX}[i];
        return 4;
    case PUBLIC_INT:
    case PUBLIC_UINT32:
    case PUBLIC_UINT64: return add_whole(row, wrong);
    case PUBLIC_FLOAT:
    case PUBLIC_DOUBLE: return add_real(row, wrong);
    case PUBLIC_POINTER: wrong[0].pointer = NULL; return row->how & PUBLIC_OR_NULL ? 0 : 1;
    default: return 0;
    }
}

/* ---- The walk ---- */

typedef struct walk {
    calls_lab *lab;
    calls_slot slot; /* the struct that calls are given, and of it */
    const char *of;
    const char *top; /* the field, by which calls know whether they look */
    double z[CALLS_SIDE * CALLS_SIDE];
    int refused;
} walk;

/* All calls that look at it refuse it, by name. */
static void all_refuse(walk *w, const char *name) {
    int count;
    char blank[80];
    const public_call *calls = public_calls(&count);
    const uint64_t bit = UINT64_C(1) << w->slot;
    snprintf(blank, sizeof blank, " %s ", w->top);
    for (int i = 0; i < count; i++) {
        const public_call *c = &calls[i];
        const bool looks = (c->takes & bit && (!c->only || strstr(c->only, blank))) ||
                           (c->sizes & bit && strcmp(w->top, "size") == 0);
        if (!looks)
            continue;
        const leafcast_status st = c->call(w->lab);
        if (st != LEAFCAST_USAGE || !strstr(leafcast_error_text(), name))
            fail_msg("%s() with a wrong %s.%s: status %d, \"%s\"", c->name, w->of, name, (int)st,
                     leafcast_error_text());
        w->refused++;
    }
}

static void check_bits(walk *w) {
    double z[CALLS_SIDE * CALLS_SIDE];
    public_calls_draw(w->lab, z);
    assert_memory_equal(z, w->z, sizeof z);
}

static void spoil(walk *w, const public_fields *table, const public_field *row, char *at,
                  size_t values) {
    number wrong[WRONG_MAX];
    const size_t width = public_fields_width(row->type);
    const int count = wrong_values(table, row, wrong);
    w->of = table->name;
    for (size_t v = 0; v < values; v++)
        for (int i = 0; i < count; i++) {
            number kept;
            memcpy(&kept, at + v * width, width);
            memcpy(at + v * width, &wrong[i], width);
            all_refuse(w, row->name);
            memcpy(at + v * width, &kept, width);
        }
}

static void spoil_direction(walk *w, const public_fields *table, const public_field *row,
                            double *at) {
    const double kept[3] = {at[0], at[1], at[2]};
    const double wrong[][3] = {{0, 0, 0},          {row->least / 2, 0, 0}, {1, NAN, 0},
                               {INFINITY, 1, 1},   {1, 1, -INFINITY},      {0, 2 * row->most, 0},
                               {5e-324, 0, 5e-324}};
    w->of = table->name;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        memcpy(at, wrong[i], sizeof kept);
        all_refuse(w, row->name);
    }
    memcpy(at, kept, sizeof kept);
}

static size_t elements_of(const public_fields *table, const public_field *row, const char *of) {
    for (int i = 0; i < table->count && row->counted_by; i++)
        if (strcmp(table->rows[i].name, row->counted_by) == 0) {
            uint32_t count;
            memcpy(&count, of + table->rows[i].offset, sizeof count);
            return count;
        }
    assert_null(row->counted_by);
    return 1;
}

static void walk_struct(walk *w, const public_fields *table, char *of, bool top);

static void walk_row(walk *w, const public_fields *table, const public_field *row, char *of) {
    char *at = of + row->offset, *to = at;
    const size_t count = elements_of(table, row, of);
    if (row->type == PUBLIC_POINTER)
        memcpy(&to, at, sizeof to);
    if (row->how & PUBLIC_DIRECTION)
        spoil_direction(w, table, row, (double *)(void *)at);
    else
        spoil(w, table, row, at, row->type == PUBLIC_POINTER ? 1 : row->values * count);
    if (row->type != PUBLIC_POINTER && row->type != PUBLIC_STRUCT)
        return;
    /* Rows of elements are walked where there are any, which is everywhere here. */
    for (size_t i = 0; i < count && row->element && to; i++)
        walk_struct(w, row->element, to + i * row->element->size, false);
    if (row->number && to) {
        public_field named = *row->number;
        named.name = row->name;
        spoil(w, table, &named, to, named.values * count);
    }
}

static void walk_struct(walk *w, const public_fields *table, char *of, bool top) {
    for (int i = 0; i < table->count; i++) {
        if (top)
            w->top = table->rows[i].name;
        walk_row(w, table, &table->rows[i], of);
    }
    if (!table->written)
        return;
    const public_field size = {.name = "size", .type = PUBLIC_SIZE};
    w->top = "size";
    spoil(w, table, &size, of, 1);
}

static void test_wrong_fields(void **state) {
    static const struct {
        calls_slot slot;
        const char *table;
        int elements;
    } given[] = {{CALLS_OPTIONS, "leafcast_options", 1},
                 {CALLS_SURFACES, "leafcast_surface", CALLS_SOME},
                 {CALLS_SCENE, "leafcast_scene", 1},
                 {CALLS_CAMERA, "leafcast_camera", 1},
                 {CALLS_IMAGE, "leafcast_image", 1},
                 {CALLS_STATS, "leafcast_stats", 1},
                 {CALLS_INFO, "leafcast_info", 1},
                 {CALLS_CELL, "leafcast_cell", 1},
                 {CALLS_RAYS, "leafcast_ray", CALLS_SOME},
                 {CALLS_SLICE, "leafcast_slice_pixels", 1},
                 {CALLS_CONVERT_OPTIONS, "leafcast_convert_options", 1},
                 {CALLS_GRID, "leafcast_grid", 1},
                 {CALLS_TETS, "leafcast_tets", 1},
                 {CALLS_TRIANGLES, "leafcast_triangles", 1}};
    walk w = {.lab = *state};
    public_calls_draw(w.lab, w.z);
    for (size_t i = 0; i < sizeof given / sizeof *given; i++) {
        const public_fields *table = public_calls_table(given[i].table);
        w.slot = given[i].slot;
        w.refused = 0;
        for (int k = 0; k < given[i].elements; k++)
            walk_struct(&w, table, (char *)w.lab->p[w.slot] + (size_t)k * table->size, true);
        print_message("%s: %d refusals\n", table->name, w.refused);
        assert_true(w.refused > 0);
        check_bits(&w);
    }
}

/* ---- All is well as it is; then without one pointer ---- */

static void test_right_calls(void **state) {
    int count;
    const public_call *calls = public_calls(&count);
    for (int i = 0; i < count; i++)
        if (calls[i].call && calls[i].call(*state) != LEAFCAST_OK)
            fail_msg("%s(): \"%s\"", calls[i].name, leafcast_error_text());
}

static void test_null_pointers(void **state) {
    calls_lab *l = *state;
    walk w = {.lab = l};
    int count;
    const public_call *calls = public_calls(&count);
    public_calls_draw(l, w.z);
    for (int i = 0; i < count; i++)
        for (int slot = 0; slot < CALLS_SLOTS; slot++) {
            void *kept = l->p[slot];
            if (!(calls[i].needs >> slot & 1))
                continue;
            l->p[slot] = NULL;
            if (calls[i].call(l) != LEAFCAST_USAGE)
                fail_msg("%s() without pointer %d is not refused", calls[i].name, slot);
            l->p[slot] = kept;
        }
    check_bits(&w);
    leafcast_close(NULL);
    leafcast_device_destroy(NULL);
    leafcast_frame_cancel(NULL);
    leafcast_frame_end(NULL);
    leafcast_stop_reading(NULL);
    leafcast_pixel_ray(l->p[CALLS_CAMERA], 0, 0, NULL, NULL);
    assert_string_equal(leafcast_field_name(NULL, 0), "");
    assert_true(leafcast_step_time(NULL, 3) == 3.0);
    assert_true(leafcast_describe(NULL).kind == NULL && leafcast_describe(NULL).levels == 0);
    assert_int_equal(leafcast_standard_view(NULL, 2.2, 4, 4).width, 0);
}

/* ---- Numbers that are arguments themselves ---- */

typedef struct wrong_number {
    const char *call, *said;
    size_t offset; /* in the lab, of: */
    enum { INT, UINT, UINT64, DOUBLE } type;
    double value;
} wrong_number;

#define LAB(field) offsetof(calls_lab, field)

static void test_wrong_numbers(void **state) {
    static const wrong_number wrong[] = {
        {"leafcast_select", "isosurfaces", LAB(count), INT, 0},
        {"leafcast_select", "isosurfaces", LAB(count), INT, -1},
        {"leafcast_select", "isosurfaces", LAB(count), INT, LEAFCAST_SURFACES_MAX + 1},
        {"leafcast_select", "isosurfaces", LAB(count), INT, INT_MIN},
        {"leafcast_select_set", "field", LAB(field), UINT, 1},
        {"leafcast_select_set", "step", LAB(step), UINT, UINT32_MAX},
        {"leafcast_expect_set", "field", LAB(field), UINT, 1},
        {"leafcast_expect_set", "step", LAB(step), UINT, UINT32_MAX},
        {"leafcast_expect_between", "field", LAB(field), UINT, 1},
        {"leafcast_expect_between", "step", LAB(step), UINT, UINT32_MAX},
        {"leafcast_range", "field", LAB(field), UINT, UINT32_MAX},
        {"leafcast_data_range", "step", LAB(step), UINT, 1},
        {"leafcast_get_histogram", "field", LAB(field), UINT, 1},
        {"leafcast_map_steps", "field", LAB(field), UINT, 1},
        {"leafcast_map_steps", "step", LAB(step), UINT, 1},
        {"leafcast_map_steps", "step", LAB(step), UINT, UINT32_MAX},
        {"leafcast_find_steps", "field", LAB(field), UINT, 1},
        {"leafcast_find_steps", "step", LAB(step), UINT, 1},
        {"leafcast_find_steps", "step", LAB(step), UINT, UINT32_MAX},
        {"leafcast_find_steps", "hi", LAB(distance), DOUBLE, NAN},
        {"leafcast_find_steps", "hi", LAB(distance), DOUBLE, INFINITY},
        {"leafcast_find_steps", "hi", LAB(distance), DOUBLE, -1},
        {"leafcast_map_treelets", "level", LAB(level), UINT, UINT32_MAX},
        {"leafcast_get_standard_view", "distance", LAB(distance), DOUBLE, NAN},
        {"leafcast_get_standard_view", "distance", LAB(distance), DOUBLE, 0},
        {"leafcast_get_standard_view", "distance", LAB(distance), DOUBLE, INFINITY},
        {"leafcast_get_standard_view", "width", LAB(width), UINT, 0},
        {"leafcast_get_standard_view", "height", LAB(height), UINT, UINT32_MAX},
        {"leafcast_fit_view", "count", LAB(count), INT, -1},
        {"leafcast_fit_view", "count", LAB(count), INT, 1000},
        {"leafcast_fit_view", "count", LAB(count), INT, INT_MAX},
        {"leafcast_fit_view", "fov", LAB(fov), DOUBLE, NAN},
        {"leafcast_fit_view", "fov", LAB(fov), DOUBLE, 180},
        {"leafcast_fit_view", "fov", LAB(fov), DOUBLE, -1},
        {"leafcast_fit_view", "width", LAB(width), UINT, 0},
        {"leafcast_fit_view", "step", LAB(step), UINT, 1},
        {"leafcast_suggested_isovalues", "max", LAB(max), INT, -1},
        {"leafcast_suggested_isovalues", "field", LAB(field), UINT, 1},
        {"leafcast_probe_ray", "max", LAB(max), INT, -1},
        {"leafcast_probe_segments", "max", LAB(max), INT, INT_MIN},
        {"leafcast_trace_rays", "count", LAB(count), INT, -1},
        {"leafcast_occluded_rays", "count", LAB(count), INT, -1},
        {"leafcast_check_room", "beside", LAB(beside), UINT64, (double)UINT64_MAX},
        {"leafcast_frame_advance", "seconds", LAB(seconds), DOUBLE, NAN},
        {"leafcast_pixel_ray", "", LAB(x), DOUBLE, NAN},
        {"leafcast_commit", "time", LAB(x), DOUBLE, NAN},
        {"leafcast_commit", "time", LAB(x), DOUBLE, INFINITY},
        {"leafcast_layer_slice", "axis", LAB(axis), INT, -1},
        {"leafcast_layer_slice", "axis", LAB(axis), INT, 3},
        {"leafcast_layer_slice", "", LAB(node), UINT, UINT32_MAX},
        {"leafcast_convert_steps", "steps", LAB(steps), UINT, 0},
        {"leafcast_convert_steps", "steps", LAB(steps), UINT, UINT32_MAX},
    };
    calls_lab *l = *state;
    walk w = {.lab = l};
    int count;
    const public_call *calls = public_calls(&count);
    public_calls_draw(l, w.z);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const wrong_number *x = &wrong[i];
        calls_lab spoilt = *l;
        char *at = (char *)&spoilt + x->offset;
        const int whole = x->type == INT ? (int)x->value : 0;
        const uint32_t count_of = x->type == UINT ? (uint32_t)x->value : 0;
        const uint64_t most = UINT64_MAX;
        int k = 0;
        while (strcmp(calls[k].name, x->call) != 0)
            k++;
        if (x->type == INT)
            memcpy(at, &whole, sizeof whole);
        else if (x->type == UINT)
            memcpy(at, &count_of, sizeof count_of);
        else if (x->type == UINT64)
            memcpy(at, &most, sizeof most);
        else
            memcpy(at, &x->value, sizeof(double));
        const leafcast_status st = calls[k].call(&spoilt);
        if (st != LEAFCAST_USAGE || !strstr(leafcast_error_text(), x->said))
            fail_msg("%s() with %s %g: status %d, \"%s\"", x->call, x->said, x->value, (int)st,
                     leafcast_error_text());
    }
    check_bits(&w);
}

/* An isovalue, a plane: arrays of numbers. */
static void test_wrong_arrays(void **state) {
    calls_lab *l = *state;
    const double wrong[] = {NAN, INFINITY, -INFINITY};
    leafcast_camera camera = {.size = sizeof camera};
    leafcast_slice_pixels slice = {.size = sizeof slice};
    leafcast_sample sample;
    for (int i = 0; i < 3; i++) {
        assert_int_equal(
            leafcast_fit_view(l->p[CALLS_VOLUME], 0, 0, &wrong[i], 1, 0, 4, 4, &camera),
            LEAFCAST_USAGE);
        for (int k = 0; k < 4; k++) {
            double plane[4] = {1, 1, 1, 0}, point[3] = {0, 0, 0};
            plane[k] = wrong[i];
            assert_int_equal(leafcast_plane_slice(l->p[CALLS_VOLUME], plane, &slice),
                             LEAFCAST_USAGE);
            point[k % 3] = wrong[i];
            assert_int_equal(leafcast_probe_point(l->p[CALLS_VOLUME], point, &sample), LEAFCAST_OK);
            assert_true(!sample.inside && isnan(sample.value));
        }
    }
}

static int set_up(void **state) {
    static calls_lab lab;
    public_calls_set_up(&lab);
    *state = &lab;
    return 0;
}

static int tear_down(void **state) {
    public_calls_tear_down(*state);
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_field),   cmocka_unit_test(test_every_row),
        cmocka_unit_test(test_every_call),    cmocka_unit_test(test_right_calls),
        cmocka_unit_test(test_wrong_fields),  cmocka_unit_test(test_null_pointers),
        cmocka_unit_test(test_wrong_numbers), cmocka_unit_test(test_wrong_arrays),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
