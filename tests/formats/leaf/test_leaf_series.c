/* Treelet files of several sets: what an earlier set has is stored once, what differs little as a
 * difference; both readers find in each set what a file of it alone has. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_image.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* How payloads of a file come about. */
typedef struct tally {
    uint32_t same, differences, whole;
    int longest; /* chain */
} tally;

static tally count(const leaf_file *f) {
    tally t = {0};
    for (uint32_t p = 0; p < f->layout.payloads; p++) {
        uint32_t chain[LEAF_CHAIN_MAX];
        if (!leaf_file_has_bytes(f, p))
            continue;
        const int codes = leaf_file_chain(f, p, chain);
        t.longest = codes > t.longest ? codes : t.longest;
        if (!leaf_file_is_home(f, p))
            t.same++;
        else if (codes > 1)
            t.differences++;
        else
            t.whole++;
    }
    return t;
}

static void check_file(const leaf_steps *s, const char *path) {
    mem m;
    leaf_unpacker *u = NULL;
    naive_leaf naive;
    mem_init(&m, 0);
    leaf_file *f = leaf_steps_open(&m, path, &u);
    if (leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    for (int step = 0; step < LEAF_STEPS; step++)
        leaf_steps_compare(f, u, (uint32_t)step, leaf_steps_alone(s, step, "alone.leaf"));
    const tally t = count(f);
    const bool coded = f->layout.coded;
    assert_true(t.same > 4 * f->layout.treelets && t.whole > f->layout.treelets);
    assert_true((t.differences > f->layout.treelets) == coded);
    assert_int_equal(t.longest, coded ? LEAF_CHAIN_MAX : 1);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    if (!naive_leaf_load(&naive, path))
        fail_msg("%s", naive.why);
    naive_leaf_release(&naive);
}

/* The same bytes for any threads and memory. */
static void check_again(leaf_steps *s, const char *path) {
    for (int threads = WATCHED ? 3 : 1; threads <= 3; threads += 2) {
        s->c.options.threads = threads;
        s->c.options.memory = threads == 1 ? UINT64_C(1) << 30 : UINT64_C(5) << 20;
        scratch_same("series", leaf_files_series(&s->of, &s->c.options, "again.leaf"), path);
    }
    s->c.options.threads = 2;
    s->c.options.memory = 1 << 30;
}

static void test_series(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
    static const uint32_t dims[][3] = {{37, 20, 33}, {18, 17, 35}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        for (int codec = SLOW && i % 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD;
             codec += SLOW && i < 4 ? 2 : 1) {
            leaf_steps s;
            const uint32_t *n = dims[i % 2];
            leaf_steps_make(&s, n[0], n[1], n[2], types[i]);
            leaf_steps_use(&s, (leaf_codec)codec);
            const char *path = leaf_files_series(&s.of, &s.c.options, "series.leaf");
            check_file(&s, path);
            check_again(&s, path);
            leaf_steps_release(&s);
        }
}

/* What never changes costs next to nothing. */
static void test_static(void **state) {
    (void)state;
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_steps s;
        size_t one, all;
        leaf_steps_make(&s, 60, 50, 70, SAMPLE_U16);
        leaf_steps_use(&s, (leaf_codec)codec);
        for (int step = 1; step < LEAF_STEPS; step++) {
            free((void *)(uintptr_t)s.paths[step]);
            s.paths[step] = s.paths[0];
        }
        free(scratch_read(leaf_steps_alone(&s, 0, "alone.leaf"), &one));
        free(scratch_read(leaf_files_series(&s.of, &s.c.options, "series.leaf"), &all));
        assert_in_range(all, 4096, one * 102 / 100);
        free((void *)(uintptr_t)s.paths[0]);
    }
}

/* Steps that have nothing in common, nor have their entries in the directory. */
static void test_unlike(void **state) {
    (void)state;
    enum { FEW = 3 };
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_steps s;
        mem m;
        leaf_unpacker *u = NULL;
        leaf_steps_make(&s, 40, 37, 33, SAMPLE_F32);
        leaf_steps_use(&s, (leaf_codec)codec);
        s.of.of.sets.steps = FEW;
        for (uint64_t step = 0; step < FEW; step++) {
            void *samples = leaf_files_random(&s.c, 100 + step, 0);
            assert_string_equal(
                scratch_write(strrchr(s.paths[step], '/') + 1, samples, leaf_steps_bytes(&s.c)),
                s.paths[step]);
            free(samples);
        }
        const char *path = leaf_files_series(&s.of, &s.c.options, "unlike.leaf");
        mem_init(&m, 0);
        leaf_file *f = leaf_steps_open(&m, path, &u);
        for (int step = 0; step < FEW; step++)
            leaf_steps_compare(f, u, (uint32_t)step, leaf_steps_alone(&s, step, "alone.leaf"));
        assert_int_equal(count(f).same, 0);
        assert_null(f->links.same);
        leaf_unpacker_destroy(u);
        leaf_file_close(f);
        leaf_steps_release(&s);
    }
}

/* ---- hostile ---- */

static void refused(const leaf_image *i, const char *what, const char *said) {
    mem m;
    leaf_file *f = NULL;
    naive_leaf naive;
    mem_init(&m, 0);
    leaf_image_seal(i);
    const status st = leaf_file_open_memory(&m, "F.leaf", i->bytes, i->size, &f);
    if (st != ST_CORRUPT || !strstr(status_text(), said))
        fail_msg("%s: status %d: %s", what, st, st ? status_text() : "");
    assert_int_equal(mem_used(&m), 0);
    if (naive_leaf_load(&naive, scratch_write("hostile.leaf", i->bytes, i->size)))
        fail_msg("%s: the second reader sees nothing", what);
    naive_leaf_release(&naive);
}

/* Opens, but does not stand up to a closer look. */
static void found_out(const leaf_image *i, const char *what) {
    mem m;
    leaf_file *f = NULL;
    naive_leaf naive;
    mem_init(&m, 0);
    leaf_image_seal(i);
    if (leaf_file_open_memory(&m, "F.leaf", i->bytes, i->size, &f) != ST_OK)
        fail_msg("%s: %s", what, status_text());
    assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_CORRUPT);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    if (naive_leaf_load(&naive, scratch_write("hostile.leaf", i->bytes, i->size)))
        fail_msg("%s: the second reader sees nothing", what);
    naive_leaf_release(&naive);
}

static leaf_image make_image(uint32_t *treelets) {
    leaf_steps s;
    size_t size;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    char *bytes = scratch_read(leaf_files_series(&s.of, &s.c.options, "series.leaf"), &size);
    leaf_steps_release(&s);
    const leaf_image i = leaf_image_of(bytes, size);
    *treelets = (uint32_t)i.header->treelets;
    return i;
}

/* A treelet's payload of set `step`. */
enum { TREELET = 1 };

static void test_lying_links(void **state) {
    (void)state;
    uint32_t n;
    leaf_image i = make_image(&n);
    uint32_t *same = leaf_image_section(&i, LEAF_SECTION_SAME);
    uint32_t *bases = leaf_image_section(&i, LEAF_SECTION_BASES);
    uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
    uint64_t *sizes = leaf_image_section(&i, LEAF_SECTION_SIZES);
    uint64_t *checksums = leaf_image_section(&i, LEAF_SECTION_CHECKSUMS);
    const uint32_t p = 18 * n + TREELET; /* as at the start */
    assert_int_equal(same[p], 1);
    static const uint32_t wrong[] = {19, 20, LEAF_STEPS + 1, UINT32_MAX, 16, 18, 2};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        same[p] = wrong[k];
        refused(&i, "a payload that is the same as none", "byte ");
    }
    same[p] = 1;
    uint64_t *const entries[] = {offsets + p, sizes + p, checksums + p};
    for (size_t k = 0; k < sizeof entries / sizeof *entries; k++) {
        ++*entries[k];
        refused(&i, "another place, size or checksum", "byte ");
        --*entries[k];
    }
    bases[p] = 1;
    refused(&i, "the same, and a base", "cannot be the same");
    bases[p] = 0;
    same[p] = 0;
    refused(&i, "bytes twice", "byte ");
    same[p] = 1;

    const uint32_t last = 7 * n + TREELET; /* at the end of a chain, whose next is whole */
    assert_true(bases[last] == 7 && bases[n + TREELET] == 1 && !bases[last + n]);
    static const uint32_t not_there[] = {8, 9, LEAF_STEPS + 1, UINT32_MAX};
    for (size_t k = 0; k < sizeof not_there / sizeof *not_there; k++) {
        bases[last] = not_there[k];
        refused(&i, "a base that is none", "cannot have the base");
    }
    bases[last] = 7;
    bases[last + n] = 8;
    refused(&i, "a chain of nine", "cannot have the base");
    bases[last + n] = 0;
    bases[20 * n + TREELET] = 1;
    found_out(&i, "a whole code with a base");
    bases[20 * n + TREELET] = 0;
    bases[last] = 0;
    found_out(&i, "a difference without a base");
    bases[last] = 7;
    const uint32_t implied = 17 * n + TREELET;
    assert_int_equal(sizes[implied], 0);
    bases[implied] = 1;
    refused(&i, "a base of nothing", "cannot have the base");
    bases[implied] = 0;
    free(i.bytes);
}

/* The directory farther from the payloads than it has to be. */
static void test_late_directory(void **state) {
    (void)state;
    enum { FARTHER = 64 };
    uint32_t n;
    leaf_image i = make_image(&n);
    const size_t table = (size_t)i.header->directory, size = i.size + FARTHER;
    char *bytes = calloc(1, size);
    memcpy(bytes, i.bytes, table);
    memcpy(bytes + table + FARTHER, i.bytes + table, i.size - table);
    leaf_header *h = (leaf_header *)bytes;
    h->directory += FARTHER;
    h->file_bytes += FARTHER;
    leaf_image far = leaf_image_as_is(bytes, size);
    for (uint32_t k = 0; k < h->sections; k++)
        far.table[k].offset += FARTHER;
    refused(&far, "a gap before the directory", "expected the directory behind the payloads");
    free(bytes);
    free(i.bytes);
}

/* Where the directory is. */
static void test_lying_place(void **state) {
    (void)state;
    uint32_t n;
    leaf_image i = make_image(&n);
    const uint64_t sound = i.header->directory;
    const uint64_t wrong[] = {0,          64,           4096,    sound - 64,  sound + 64,
                              sound + 1,  i.size - 32,  i.size,  i.size + 64, UINT64_MAX - 63,
                              UINT64_MAX, sound - 4096, 4096 * 7};
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        i.header->directory = wrong[k];
        leaf_header *h = i.header;
        h->checksum = 0;
        h->checksum = hash_bytes(h, sizeof *h);
        mem m;
        leaf_file *f = NULL;
        naive_leaf naive;
        mem_init(&m, 0);
        const status st = leaf_file_open_memory(&m, "F.leaf", i.bytes, i.size, &f);
        if (st != ST_CORRUPT && st != ST_UNSUPPORTED && st != ST_IO)
            fail_msg("directory at %llu: status %d", (unsigned long long)wrong[k], st);
        assert_int_equal(mem_used(&m), 0);
        assert_false(naive_leaf_load(&naive, scratch_write("hostile.leaf", i.bytes, i.size)));
        naive_leaf_release(&naive);
    }
    free(i.bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_series),      cmocka_unit_test(test_static),
        cmocka_unit_test(test_unlike),      cmocka_unit_test(test_lying_links),
        cmocka_unit_test(test_lying_place), cmocka_unit_test(test_late_directory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
