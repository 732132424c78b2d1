/* test_leaf_fuzz.c - treelet files of each kind changed at random, their checksums right:
 * refused, or drawn; never a crash, a hang, memory left. fuzz_leaf.c is the same at length, and
 * $LEAFCAST_FUZZ other than COUNT files of each kind.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fields.h"
#include "tests/support/hex_grown.h"
#include "tests/support/leaf_files.h"
#include "tests/support/leaf_fuzz.h"
#include "tests/support/leaf_image.h"
#include "tests/support/mesh_grown.h"
#include "tests/support/mesh_leaves.h"
#include "tests/support/scratch.h"
#include "tests/support/surface_movie.h"

enum { COUNT = 400, CHANGES_MAX = 6 };

static leaf_image make_mesh(leaf_codec codec, int extended) {
    mesh_case c = mesh_leaves_cube(3, 1 + extended, 1 + extended, 7, 15);
    if (extended)
        mesh_leaves_extend(&c, 8);
    c.file.codec = codec;
    c.file.run_align_log2 = 9;
    size_t size;
    char *bytes = scratch_read(mesh_leaves_make(&c, "made.leaf"), &size);
    mesh_leaves_release(&c);
    return leaf_image_of(bytes, size);
}

static leaf_image make_grid(leaf_codec codec, int bare) {
    leaf_case c = leaf_files_case(20, 19, 4, SAMPLE_F32);
    void *samples = leaf_files_random(&c, FIELD_SEED, 25);
    c.samples = samples;
    c.options.file.codec = codec;
    c.options.file.bare = bare;
    c.options.file.histograms = c.options.file.deviations = codec == LEAF_CODEC_ZSTD;
    size_t size;
    char *bytes = scratch_read(leaf_files_make(&c, "made.leaf"), &size);
    free(samples);
    return leaf_image_of(bytes, size);
}

/* How a series comes to be: its sections are made plain, or stay compressed; or steps are added. */
typedef enum series_form { SERIES_PLAIN, SERIES_PACKED, SERIES_GROWN } series_form;

/* Convert a series at once; or two steps first, then twice as many as there are. */
static const char *convert(const grid_series *of, const convert_options *o, bool grows) {
    grid_series some = *of;
    if (!grows)
        return leaf_files_series(of, o, "made.leaf");
    some.of.sets.steps = 2;
    const char *path = leaf_files_series(&some, o, "made.leaf");
    for (int i = 0; i < 2; i++) {
        some.of.paths += some.of.sets.steps;
        some.of.sets.steps = i == 0 ? 2 : 4;
        assert_int_equal(leaf_files_add(&some, o, path), ST_OK);
    }
    return path;
}

/* Steps of which some are the same as others, and some a little different. */
static leaf_image make_series(leaf_codec codec, int form) {
    enum { STEPS = 10, EVERY = 97 };
    leaf_case c = leaf_files_case(20, 19, 4, SAMPLE_F32);
    const size_t count = (size_t)20 * 19 * 4;
    float *samples = leaf_files_random(&c, FIELD_SEED, 0);
    const char *paths[STEPS];
    for (int step = 0; step < STEPS; step++) {
        char name[32];
        for (size_t i = (size_t)step; step % 4 && i < count; i += EVERY)
            samples[i] += 0.001F;
        snprintf(name, sizeof name, "step%d.bin", step);
        paths[step] = strdup(scratch_write(name, samples, count * sizeof *samples));
    }
    const grid_series of = {.of = {.paths = paths, .sets = {1, STEPS, NULL, NULL, NULL}},
                            .hints = {.dims = {20, 19, 4}, .type = SAMPLE_F32}};
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    size_t size;
    char *bytes = scratch_read(convert(&of, &c.options, form == SERIES_GROWN), &size);
    for (int step = 0; step < STEPS; step++)
        free((void *)(uintptr_t)paths[step]);
    free(samples);
    return form == SERIES_PLAIN ? leaf_image_of(bytes, size) : leaf_image_as_is(bytes, size);
}

static leaf_image make_grown_mesh(leaf_codec codec, int how) {
    size_t size;
    (void)how;
    char *bytes = scratch_read(mesh_grown_make(3, 4, codec, "made.leaf"), &size);
    return leaf_image_as_is(bytes, size);
}

enum { LAB = 1 };

static leaf_image make_curvilinear(leaf_codec codec, int segments) {
    size_t size;
    char *bytes = scratch_read(hex_grown_grid(LAB, (uint32_t)segments, codec, "made.leaf"), &size);
    return leaf_image_as_is(bytes, size);
}

static leaf_image make_mix(leaf_codec codec, int segments) {
    size_t size;
    char *bytes = scratch_read(hex_grown_mix(LAB, (uint32_t)segments, codec, "made.leaf"), &size);
    return leaf_image_as_is(bytes, size);
}

static leaf_image make_surface(leaf_codec codec, int moves) {
    size_t size;
    mem m;
    mesh_result r;
    surface_movie v = surface_movie_make(24, 1, moves ? 3 : 1, moves, "fuzz");
    v.options.treelet_tets = 2000;
    v.options.file.codec = codec;
    v.options.file.zstd_level = 1;
    v.options.file.run_align_log2 = 9;
    assert_int_equal(surface_movie_convert(&m, &v, scratch_path("made.leaf"), NULL, false, &r),
                     ST_OK);
    surface_movie_release(&v);
    char *bytes = scratch_read(scratch_path("made.leaf"), &size);
    return leaf_image_as_is(bytes, size);
}

typedef struct sound_kind {
    const char *name;
    leaf_image (*make)(leaf_codec codec, int how);
    int how;
} sound_kind;

static const sound_kind kinds[] = {
    {"a mesh", make_mesh, 0},
    {"a moving mesh", make_mesh, 1},
    {"a grid", make_grid, 0},
    {"level 0 alone", make_grid, 1},
    {"a series", make_series, SERIES_PLAIN},
    {"a packed series", make_series, SERIES_PACKED},
    {"a grown series", make_series, SERIES_GROWN},
    {"a grown mesh", make_grown_mesh, 0},
    {"a curvilinear grid", make_curvilinear, 1},
    {"a grown curvilinear grid", make_curvilinear, 4},
    {"a mixed mesh", make_mix, 1},
    {"a grown mixed mesh", make_mix, 4},
    {"a surface", make_surface, 0},
    {"a moving surface", make_surface, 1},
};

/* Four bytes or one, by what breaks things. */
static void change(char *at, size_t room, field_random *r) {
    static const uint32_t values[] = {0,          1,          2,          3,
                                      0x7f800000, 0x7fc00000, 65535,      1 << 20,
                                      0x7f7fffff, 0x80000000, UINT32_MAX, 0xff7fffff};
    const uint64_t how = field_random_below(r, 4);
    uint32_t value = values[field_random_below(r, sizeof values / sizeof *values)];
    if (how == 0 || room < 4) {
        *at = (char)(*at ^ 1 << field_random_below(r, 8));
        return;
    }
    if (how == 1) {
        memcpy(&value, at, 4);
        value += (uint32_t)field_random_below(r, 5) - 2;
    } else if (how == 2) {
        value = (uint32_t)field_random_bits(r);
    }
    memcpy(at, &value, 4);
}

/* Header and directory as often as payloads, though there is less of them. */
static size_t place(const leaf_image *i, field_random *r) {
    const uint64_t where = field_random_below(r, 4);
    const size_t table = (size_t)leaf_table_at(i->header), end = (size_t)i->sections_end;
    const size_t payloads = i->header->directory ? LEAF_HEADER_BYTES : end;
    const size_t from = where == 0 ? 0 : where == 1 ? table : payloads;
    /* The header of a segment. */
    if (where == 2 && i->header->segments > 1)
        return (size_t)leaf_fuzz_segment(i->bytes, i->size, (int)field_random_below(r, 3)) +
               (size_t)field_random_below(r, 1600);
    const size_t to = where == 0 ? 1600 : where == 1 ? end : i->header->directory ? table : i->size;
    return from + (size_t)field_random_below(r, to - from);
}

/* Returns how many were drawn, *refused how many not. */
static uint64_t run(const leaf_image *sound, const char *kind, uint64_t seed, uint64_t count,
                    uint64_t *refused) {
    uint64_t drawn = 0;
    char *bytes = leaf_fuzz_alloc(sound->size);
    *refused = 0;
    for (uint64_t n = 0; n < count; n++) {
        field_random r = {seed * 1000003 + n};
        leaf_fuzz_result result;
        memcpy(bytes, sound->bytes, sound->size);
        for (uint64_t k = n == 0 ? 0 : 1 + field_random_below(&r, CHANGES_MAX); k > 0; k--) {
            const size_t at = place(sound, &r) & ~(size_t)3;
            change(bytes + at, sound->size - at, &r);
        }
        leaf_fuzz_seal(bytes, sound->size);
        const char *wrong = leaf_fuzz_try(bytes, sound->size, n % 2, &result);
        if (wrong || (n == 0 && result.trace != ST_OK))
            fail_msg("%s, file %llu: %s (open %d, verify %d, picture %d: \"%s\")", kind,
                     (unsigned long long)n, wrong ? wrong : "is sound, but fails", result.open,
                     result.verify, result.trace, status_text());
        drawn += result.trace == ST_OK;
        *refused += result.trace != ST_OK;
    }
    free(bytes);
    print_message("%s: %llu drawn, %llu refused\n", kind, (unsigned long long)drawn,
                  (unsigned long long)*refused);
    return drawn;
}

static void test_changed(void **state) {
    (void)state;
    const char *wanted = getenv("LEAFCAST_FUZZ");
    const uint64_t count = wanted ? strtoull(wanted, NULL, 10) : COUNT;
    for (int k = 0; k < 2 * (int)(sizeof kinds / sizeof *kinds); k++) {
        const sound_kind *kind = &kinds[k / 2];
        const leaf_image i = kind->make(k % 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, kind->how);
        char name[64];
        uint64_t refused;
        snprintf(name, sizeof name, "%s, %s", kind->name, k % 2 ? "zstd" : "raw");
        const uint64_t drawn = run(&i, name, (uint64_t)k + 1, count, &refused);
        /* It was put to the test from both sides. */
        assert_true(drawn > count / 50 && refused > count / 4);
        free(i.bytes);
    }
}

/* Cut short: nothing that is looked at lies behind the end. */
static void test_short(void **state) {
    (void)state;
    const leaf_image i = make_mesh(LEAF_CODEC_RAW, 1);
    for (size_t size = 0; size < i.size; size += size < 6000 ? 37 : 997) {
        leaf_fuzz_result result;
        char *bytes = leaf_fuzz_alloc(size); /* so that sanitizers see what is beyond */
        memcpy(bytes, i.bytes, size);
        leaf_fuzz_seal(bytes, size);
        const char *wrong = leaf_fuzz_try(bytes, size, size % 2, &result);
        if (wrong || result.open == ST_OK)
            fail_msg("%zu bytes: %s", size, wrong ? wrong : "is opened");
        free(bytes);
    }
    free(i.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_changed),
        cmocka_unit_test(test_short),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
