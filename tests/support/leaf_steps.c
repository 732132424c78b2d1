#include "tests/support/leaf_steps.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/support/fields.h"
#include "tests/support/scratch.h"

enum { RANDOM = 90 };

size_t leaf_steps_bytes(const leaf_case *c) {
    return (size_t)c->dims[0] * c->dims[1] * c->dims[2] * sample_size(c->type);
}

/* From `first` on some samples, one in `one_in`, are a little different. */
static void change(const leaf_case *c, char *samples, size_t first, int one_in, field_random *r) {
    const size_t width = sample_size(c->type);
    for (size_t at = first * width; at < leaf_steps_bytes(c); at += width)
        if (field_random_below(r, (uint64_t)one_in) == 0)
            samples[at] ^= 1;
}

/* Samples of a step from those of the one before. */
static void next_step(const leaf_case *c, int step, char *samples, const char *first,
                      field_random *r) {
    const size_t bytes = leaf_steps_bytes(c), count = bytes / sample_size(c->type);
    if (step <= 12) /* more than a chain */
        change(c, samples, 0, 200, r);
    else if (step == 13) /* a part of it */
        change(c, samples, count / 8 * 7, 3, r);
    else if (step == 15) /* as at the start */
        memcpy(samples, first, bytes);
    else if (step == 17) /* one value */
        memset(samples, 0, bytes);
    else if (step == 18)
        memcpy(samples, first, bytes);
    else if (step == 20) { /* another thing */
        void *other = leaf_files_random(c, 77, RANDOM);
        memcpy(samples, other, bytes);
        free(other);
    } else if (step > 20)
        change(c, samples, 0, 50, r);
}

void leaf_steps_make(leaf_steps *s, uint32_t nx, uint32_t ny, uint32_t nz, sample_type type) {
    field_random r = {FIELD_SEED};
    char name[32];
    s->c = leaf_files_case(nx, ny, nz, type);
    char *first = leaf_files_random(&s->c, 5, RANDOM), *samples = malloc(leaf_steps_bytes(&s->c));
    memcpy(samples, first, leaf_steps_bytes(&s->c));
    for (int step = 0; step < LEAF_STEPS; step++) {
        if (step > 0)
            next_step(&s->c, step, samples, first, &r);
        snprintf(name, sizeof name, "step%d.bin", step);
        s->paths[step] = strdup(scratch_write(name, samples, leaf_steps_bytes(&s->c)));
    }
    s->of = (grid_series){.of = {.paths = s->paths, .sets = {1, LEAF_STEPS, NULL, NULL, NULL}},
                          .hints = {.dims = {nx, ny, nz}, .type = type}};
    s->c.options.file.histograms = s->c.options.file.deviations = true;
    free(first);
    free(samples);
}

void leaf_steps_release(leaf_steps *s) {
    for (int step = 0; step < LEAF_STEPS; step++)
        free((void *)(uintptr_t)s->paths[step]);
}

void leaf_steps_use(leaf_steps *s, leaf_codec codec) {
    s->c.options.file.codec = codec;
    s->c.options.file.run_align_log2 = codec == LEAF_CODEC_RAW ? 12 : 6;
    s->c.options.file.zstd_level = 1;
}

const char *leaf_steps_alone(const leaf_steps *s, int step, const char *name) {
    leaf_case one = s->c;
    size_t size;
    char *samples = scratch_read(s->paths[step], &size);
    one.samples = samples;
    const char *path = leaf_files_make(&one, name);
    free(samples);
    return path;
}

leaf_file *leaf_steps_open(mem *m, const char *path, leaf_unpacker **u) {
    leaf_file *f = NULL;
    if (leaf_file_open(m, path, &f) != ST_OK || leaf_unpacker_create(m, f, u) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

void leaf_steps_compare(leaf_file *f, leaf_unpacker *u, uint32_t set, const char *alone) {
    mem m;
    leaf_unpacker *v = NULL;
    mem_init(&m, 0);
    leaf_file *g = leaf_steps_open(&m, alone, &v);
    const size_t room = leaf_layout_payload_max(&f->layout);
    char *a = aligned_alloc(64, room), *b = aligned_alloc(64, room);
    for (uint32_t t = 0; t < g->layout.treelets; t++) {
        const uint32_t p = leaf_layout_samples(&f->layout, set, t);
        assert_memory_equal(f->own[p], g->own[t], sizeof f->own[p]);
        assert_memory_equal(f->ranges[p], g->ranges[t], sizeof f->ranges[p]);
        assert_int_equal(f->flags[p], g->flags[t]);
        assert_int_equal(leaf_file_load(f, p, u, a), ST_OK);
        assert_int_equal(leaf_file_load(g, t, v, b), ST_OK);
        assert_memory_equal(a, b, leaf_layout_payload_bytes(&f->layout, p));
    }
    assert_memory_equal(&f->histograms[set], g->histograms, sizeof *g->histograms);
    free(a);
    free(b);
    leaf_unpacker_destroy(v);
    leaf_file_close(g);
    assert_int_equal(mem_used(&m), 0);
}
