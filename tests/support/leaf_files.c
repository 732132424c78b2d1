#include "tests/support/leaf_files.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/outside_samples.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"

leaf_case leaf_files_case(uint32_t nx, uint32_t ny, uint32_t nz, sample_type type) {
    leaf_case c = {.dims = {nx, ny, nz}, .type = type};
    c.options.file = leaf_parameters_default();
    c.options.file.cells_log2 = 4;
    c.options.memory = 1 << 30;
    c.options.threads = 2;
    return c;
}

static void put_sample(sample_type type, void *samples, size_t i, double unit) {
    switch (type) {
    case SAMPLE_U8: ((uint8_t *)samples)[i] = (uint8_t)(unit * 255); break;
    case SAMPLE_I8: ((int8_t *)samples)[i] = (int8_t)(unit * 255 - 128); break;
    case SAMPLE_U16: ((uint16_t *)samples)[i] = (uint16_t)(unit * 65535); break;
    case SAMPLE_I16: ((int16_t *)samples)[i] = (int16_t)(unit * 65535 - 32768); break;
    case SAMPLE_U32: ((uint32_t *)samples)[i] = (uint32_t)(unit * 4e9); break;
    case SAMPLE_I32: ((int32_t *)samples)[i] = (int32_t)(unit * 4e9 - 2e9); break;
    case SAMPLE_F32: ((float *)samples)[i] = (float)(unit * 3 - 1); break;
    case SAMPLE_F64: ((double *)samples)[i] = unit * 3 - 1; break;
    default: break;
    }
}

void *leaf_files_random(const leaf_case *c, uint64_t seed, int non_finite) {
    static const float strange[] = {NAN, INFINITY, -INFINITY};
    size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2];
    void *samples = malloc(count * sample_size(c->type));
    assert_non_null(samples);
    field_random r = {seed};
    size_t i = 0;
    for (uint32_t z = 0; z < c->dims[2]; z++)
        for (uint32_t y = 0; y < c->dims[1]; y++)
            for (uint32_t x = 0; x < c->dims[0]; x++, i++) {
                double wave = 0.5 + 0.25 * sin(0.11 * x) + 0.2 * sin(0.07 * y + 0.05 * z);
                put_sample(c->type, samples, i, wave + 0.04 * field_random_unit(&r));
                if (c->type == SAMPLE_F32 && non_finite && field_random_below(&r, non_finite) == 0)
                    ((float *)samples)[i] = strange[field_random_below(&r, 3)];
            }
    return samples;
}

static const char *write_input(const leaf_case *c, volume_hints *hints) {
    char input[64];
    snprintf(input, sizeof input, "input-%ux%ux%u.bin", c->dims[0], c->dims[1], c->dims[2]);
    size_t count = (size_t)c->dims[0] * c->dims[1] * c->dims[2];
    *hints = c->reading;
    memcpy(hints->dims, c->dims, sizeof hints->dims);
    hints->type = c->type;
    memcpy(hints->axis_file, c->axis_file, sizeof hints->axis_file);
    hints->has_axes = c->axes != WORLD_UNTOLD;
    hints->axes = c->axes;
    hints->unit = c->unit;
    return scratch_write(input, c->samples, count * sample_size(c->type));
}

static status stay_in_place(mem *m, const volume *v, const sample_place *given, const char *output,
                            leaf_outside *outside, leaf_parameters *p) {
    sample_place at;
    assert_true(given || volume_place(v, &at));
    at = given ? *given : at;
    leaf_parameters_compress(p, 1);
    p->outside = outside;
    p->chunks = at.table;
    p->chunk_count = at.table_count;
    p->slices = at.slices;
    return outside_samples_describe(m, &at, output, outside);
}

status leaf_files_try(mem *m, const leaf_case *c, const char *name, convert_plan *plan,
                      convert_result *result) {
    convert_plan own_plan;
    convert_result own_result;
    plan = plan ? plan : &own_plan;
    result = result ? result : &own_result;
    volume_hints hints;
    const char *path = write_input(c, &hints);
    convert_options o = c->options;
    leaf_outside outside;
    volume *v = NULL;
    m->limit = (size_t)o.memory;
    status st = volume_open(m, path, &hints, &v);
    if (st == ST_OK && c->in_place)
        st = stay_in_place(m, v, c->place, scratch_path(name), &outside, &o.file);
    if (st == ST_OK)
        st = convert_plan_make(m, volume_grid(v), &o, plan);
    if (st == ST_OK)
        st = convert_run(m, v, scratch_path(name), &o, plan, NULL, result);
    volume_close(v);
    if (!c->in_place)
        (void)remove(path);
    return st;
}

uint64_t leaf_files_least(const leaf_case *c) {
    mem m;
    mem_init(&m, 0);
    volume_hints hints;
    const char *path = write_input(c, &hints);
    volume *v = NULL;
    convert_options o = c->options;
    convert_plan plan;
    o.memory = 1;
    assert_int_equal(volume_open(&m, path, &hints, &v), ST_OK);
    assert_int_equal(convert_plan_make(&m, volume_grid(v), &o, &plan), ST_NOMEM);
    volume_close(v);
    (void)remove(path);
    return plan.memory_least;
}

const char *leaf_files_make(const leaf_case *c, const char *name) {
    mem m;
    mem_init(&m, 0);
    leaf_case forced = *c;
    forced.options.force = true;
    status st = leaf_files_try(&m, &forced, name, NULL, NULL);
    if (st != ST_OK)
        fail_msg("%ux%ux%u %s: %s", c->dims[0], c->dims[1], c->dims[2], sample_name(c->type),
                 status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_path(name);
}

static status convert_series(mem *m, const grid_series *of, const convert_options *o,
                             const char *path) {
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    convert_options series = *o;
    series.series = of;
    series.force = true;
    status st = grid_series_open(m, of, 0, &v);
    if (st == ST_OK)
        st = convert_plan_make(m, volume_grid(v), &series, &plan);
    if (st == ST_OK)
        st = convert_run(m, v, path, &series, &plan, NULL, &result);
    volume_close(v);
    return st;
}

const char *leaf_files_series(const grid_series *of, const convert_options *o, const char *name) {
    mem m;
    mem_init(&m, (size_t)o->memory);
    if (convert_series(&m, of, o, scratch_path(name)) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_path(name);
}

status leaf_files_add(const grid_series *of, const convert_options *o, const char *path) {
    mem m;
    convert_options add = *o;
    mem_init(&m, (size_t)o->memory);
    status st = leaf_grow_open(&m, path, &add.grow);
    if (st == ST_OK)
        st = convert_series(&m, of, &add, path);
    leaf_grow_close(add.grow);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

const char *leaf_files_long(const char *name) {
    enum { WIDE = 17 };
    leaf_case c = leaf_files_case(LEAF_FILES_LONG, WIDE, WIDE, SAMPLE_F32);
    float *samples = malloc((size_t)LEAF_FILES_LONG * WIDE * WIDE * sizeof *samples);
    assert_non_null(samples);
    for (size_t i = 0; i < (size_t)LEAF_FILES_LONG * WIDE * WIDE; i++) {
        const size_t x = i % LEAF_FILES_LONG, y = i / LEAF_FILES_LONG % WIDE;
        samples[i] = y > 14 ? 1000.0F - (float)(x / 16) : x == LEAF_FILES_LONG - 2 ? 5.0F : 1.0F;
    }
    c.samples = samples;
    const char *path = leaf_files_make(&c, name);
    free(samples);
    return path;
}
