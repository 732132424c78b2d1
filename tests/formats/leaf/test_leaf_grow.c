/* Treelet files that grow: whatever segments they came in, both readers find in each step what a
 * file of it alone has; nothing that fails takes away what was there; and nothing that lies about
 * segments is believed. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_grow.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/leaf_image.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/naive_grown.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* Steps from `first` on, as a series of their own. */
static grid_series some(const leaf_steps *s, uint32_t first, uint32_t count) {
    grid_series of = s->of;
    of.of.paths = s->paths + first;
    of.of.sets.steps = count;
    return of;
}

/* Begin a file with so many steps. */
static const char *begin(const leaf_steps *s, uint32_t steps, const char *name) {
    const grid_series of = some(s, 0, steps);
    convert_options o = s->c.options;
    o.grows = true;
    return leaf_files_series(&of, &o, name);
}

static void add(const leaf_steps *s, uint32_t first, uint32_t count, const char *path) {
    const grid_series of = some(s, first, count);
    if (leaf_files_add(&of, &s->c.options, path) != ST_OK)
        fail_msg("%s", status_text());
}

/* Check the samples that the second reader finds at a step. */
static void check_naive(const leaf_steps *s, const char *path, int step) {
    naive_grown *g = malloc(sizeof *g);
    size_t size, i = 0;
    char *samples = scratch_read(s->paths[step], &size);
    if (!naive_grown_load(g, path, step))
        fail_msg("step %d: %s", step, g->why);
    const naive_leaf *leaf = naive_grown_segment(g, step);
    for (long z = 0; z < leaf->dims[2]; z++)
        for (long y = 0; y < leaf->dims[1]; y++)
            for (long x = 0; x < leaf->dims[0]; x++, i++) {
                const float a = naive_leaf_sample(leaf, 0, x, y, z),
                            b = sample_get(s->c.type, samples, i);
                assert_memory_equal(&a, &b, sizeof a);
            }
    naive_grown_release(g);
    free(g);
    free(samples);
}

/* Check that a file has so many steps, each with its samples. */
static void check_steps(const leaf_steps *s, const char *path, uint32_t steps) {
    mem m;
    leaf_unpacker *u = NULL;
    mem_init(&m, 0);
    leaf_file *f = leaf_steps_open(&m, path, &u);
    assert_int_equal(f->header.steps, steps);
    assert_int_equal(f->header.file_bytes, file_size(f->source));
    if (leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    for (uint32_t step = 0; step < steps; step++)
        leaf_steps_compare(f, u, step, leaf_steps_alone(s, (int)step, "alone.leaf"));
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
}

/* How many payloads of later segments are in earlier ones, or, in their first steps, differ from
 * these. */
static void count_links(const char *path, uint32_t *same, uint32_t *bases) {
    mem m;
    leaf_unpacker *u = NULL;
    mem_init(&m, 0);
    leaf_file *f = leaf_steps_open(&m, path, &u);
    *same = *bases = 0;
    for (uint32_t p = 0; p < f->layout.payloads; p++) {
        const leaf_series at = leaf_layout_series(&f->layout, p);
        uint32_t segment = f->header.segments - 1;
        while (f->segments[segment].first > at.at)
            segment--;
        const uint32_t first = f->segments[segment].first;
        *same += f->links.same[p] && f->links.same[p] <= first;
        *bases += at.at == first && f->links.bases[p];
    }
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
}

/* ---- growing ---- */

static void test_segments(void **state) {
    (void)state;
    static const sample_type types[] = {SAMPLE_U8, SAMPLE_F32, SAMPLE_U16, SAMPLE_I16};
    /* The step that each segment begins with: between those that are alike, that are not, in a long
     * chain of differences, and several at once. */
    static const uint32_t begins[] = {1, 2, 4, 11, 15, 16, 18, 20, LEAF_STEPS};
    for (int i = 0; i < 4; i += WATCHED ? 3 : 1) {
        leaf_steps s;
        uint32_t same, bases;
        leaf_steps_make(&s, 37, 20, 33, types[i]);
        leaf_steps_use(&s, i < 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW);
        const char *path = begin(&s, 1, "grown.leaf");
        check_steps(&s, path, 1);
        for (size_t k = 0; k + 1 < sizeof begins / sizeof *begins; k++) {
            add(&s, begins[k], begins[k + 1] - begins[k], path);
            if (k % 3 == 0)
                check_naive(&s, path, (int)begins[k]);
        }
        check_steps(&s, path, LEAF_STEPS);
        check_naive(&s, path, LEAF_STEPS - 1);
        count_links(path, &same, &bases);
        assert_true(same > 0 && (bases > 0) == (i < 2));
        leaf_steps_release(&s);
    }
}

/* A step that is added has the same bytes whatever the threads and the memory. */
static void test_again(void **state) {
    (void)state;
    leaf_steps s;
    leaf_steps_make(&s, 60, 50, 70, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    for (int threads = 1; threads <= 3; threads++) {
        s.c.options.threads = threads;
        s.c.options.memory = threads == 1 ? UINT64_C(1) << 30 : UINT64_C(6) << 20;
        const char *path = begin(&s, 2, threads == 1 ? "one.leaf" : "other.leaf");
        add(&s, 2, 2, path);
        if (threads > 1)
            scratch_same("segments", path, scratch_path("one.leaf"));
    }
    leaf_steps_release(&s);
}

/* What never changes is not stored again. */
static void test_static(void **state) {
    (void)state;
    enum { AGAIN = WATCHED ? 4 : 12 };
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_steps s;
        size_t one, all;
        leaf_steps_make(&s, 60, 50, 70, SAMPLE_U16);
        leaf_steps_use(&s, (leaf_codec)codec);
        const char *path = begin(&s, 1, "static.leaf");
        free(scratch_read(path, &one));
        for (int i = 0; i < AGAIN; i++)
            add(&s, 0, 1, path);
        free(scratch_read(path, &all));
        /* A header and a small directory each. */
        assert_in_range(all, one, one + AGAIN * (4096 + 8192));
        leaf_steps_release(&s);
    }
}

/* Nor what any earlier step has. */
static void test_back(void **state) {
    (void)state;
    enum { OTHER = 20 }; /* a step that is unlike the first */
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        leaf_steps s;
        size_t two, all;
        leaf_steps_make(&s, 60, 50, 70, SAMPLE_U16);
        leaf_steps_use(&s, (leaf_codec)codec);
        const char *path = begin(&s, 1, "back.leaf");
        add(&s, OTHER, 1, path);
        free(scratch_read(path, &two));
        for (int i = 0; i < 4; i++)
            add(&s, i % 2 * OTHER, 1, path);
        free(scratch_read(path, &all));
        assert_in_range(all, two, two + 4 * (4096 + 12288));
        leaf_steps_release(&s);
    }
}

/* ---- others that read and write ---- */

static void test_readers(void **state) {
    (void)state;
    leaf_steps s;
    mem m;
    leaf_unpacker *u = NULL;
    leaf_steps_make(&s, 37, 20, 33, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    mem_init(&m, 0);
    /* One of a file that is not said to grow, before it does, and one of a file that did. */
    const grid_series two = some(&s, 0, 2);
    const char *path = leaf_files_series(&two, &s.c.options, "read.leaf");
    for (uint32_t steps = 2; steps < 4; steps++) {
        leaf_file *f = leaf_steps_open(&m, path, &u);
        add(&s, steps, 1, path);
        assert_int_equal(leaf_file_changed(f), ST_OK);
        assert_int_equal(f->header.steps, steps);
        for (uint32_t step = 0; step < steps; step++)
            leaf_steps_compare(f, u, step, leaf_steps_alone(&s, (int)step, "alone.leaf"));
        leaf_unpacker_destroy(u);
        leaf_file_close(f);
    }
    /* Another file, and other bytes. */
    leaf_file *f = leaf_steps_open(&m, path, &u);
    assert_int_equal(rename(begin(&s, 1, "new.leaf"), path), 0);
    assert_int_equal(leaf_file_changed(f), ST_CORRUPT);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    f = leaf_steps_open(&m, path, &u);
    size_t size;
    char *bytes = scratch_read(begin(&s, 2, "new.leaf"), &size);
    FILE *out = fopen(path, "r+b");
    assert_int_equal(fwrite(bytes, 1, size, out), size);
    fclose(out);
    free(bytes);
    assert_int_equal(leaf_file_changed(f), ST_CORRUPT);
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    leaf_steps_release(&s);
}

static void test_two(void **state) {
    (void)state;
    leaf_steps s;
    mem m;
    leaf_grow *a = NULL, *b = NULL;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_RAW);
    const char *path = begin(&s, 1, "two.leaf");
    mem_init(&m, 0);
    assert_int_equal(leaf_grow_open(&m, path, &a), ST_OK);
    assert_int_equal(leaf_grow_open(&m, path, &b), ST_EXISTS);
    assert_non_null(strstr(status_text(), "another program is adding to it"));
    leaf_grow_close(a);
    assert_int_equal(leaf_grow_open(&m, path, &b), ST_OK);
    leaf_grow_close(b);
    assert_int_equal(mem_used(&m), 0);
    check_steps(&s, path, 1);
    leaf_steps_release(&s);
}

static void test_refused(void **state) {
    (void)state;
    leaf_steps s;
    mem m;
    leaf_grow *g = NULL;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    mem_init(&m, 0);
    /* Bytes behind the end are no file's, but where one grows. */
    const grid_series one = some(&s, 0, 1);
    const char *path = leaf_files_series(&one, &s.c.options, "plain.leaf");
    FILE *out = fopen(path, "ab");
    assert_int_equal(fputs("more", out) >= 0, 1);
    fclose(out);
    assert_int_equal(leaf_grow_open(&m, path, &g), ST_CORRUPT);
    assert_int_equal(leaf_grow_open(&m, scratch_path("nothing.leaf"), &g), ST_IO);
    assert_int_equal(mem_used(&m), 0);
    leaf_steps_release(&s);
}

/* ---- what fails ---- */

/* Add a step while the k-th operation of a kind fails. Returns whether one did. */
static bool fail_at(const leaf_steps *s, fault_kind kind, long k, const char *path) {
    const grid_series of = some(s, 2, 1);
    fault_arm(kind, k);
    const status st = leaf_files_add(&of, &s->c.options, path);
    const bool fired = fault_fired(kind);
    fault_arm(kind, 0);
    if (!fired)
        assert_int_equal(st, ST_OK);
    /* Whatever happened: all that was there, or all with the new step. */
    check_steps(s, path, st == ST_OK ? 3 : 2);
    return fired;
}

static void test_faults(void **state) {
    (void)state;
    leaf_steps s;
    size_t size;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    s.c.options.threads = 1;
    char *two = scratch_read(begin(&s, 2, "two.leaf"), &size);
    for (int kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++) {
        long k = 1;
        bool fired = true;
        for (; fired; k += 1 + k / (SLOW ? 4 : 16))
            fired = fail_at(&s, (fault_kind)kind, k, scratch_write("faults.leaf", two, size));
        assert_true(k > 4);
    }
    free(two);
    leaf_steps_release(&s);
}

/* A program that was killed: part of a segment, or all of it, is there and does not count. The next
 * one begins where it began. */
static void test_killed(void **state) {
    (void)state;
    leaf_steps s;
    size_t before, after;
    leaf_steps_make(&s, 37, 20, 33, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    const char *path = begin(&s, 2, "killed.leaf");
    char head[LEAF_HEADER_BYTES];
    char *bytes = scratch_read(path, &before);
    memcpy(head, bytes, sizeof head);
    free(bytes);
    add(&s, 2, 1, path);
    bytes = scratch_read(path, &after);
    const size_t piece = (after - before) / 7;
    for (size_t size = before; size <= after + 2 * piece; size += piece) {
        char *part = calloc(1, size);
        memcpy(part, bytes, size < after ? size : after);
        memcpy(part, head, sizeof head);
        path = scratch_write("part.leaf", part, size);
        free(part);
        mem m;
        leaf_unpacker *u = NULL;
        mem_init(&m, 0);
        leaf_file *f = leaf_steps_open(&m, path, &u);
        assert_int_equal(f->header.steps, 2);
        assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
        leaf_unpacker_destroy(u);
        leaf_file_close(f);
        add(&s, 2, 1, path);
        scratch_same("the same as without", path, scratch_path("killed.leaf"));
    }
    free(bytes);
    leaf_steps_release(&s);
}

/* ---- lies ---- */

/* A file of three segments, and the places of their headers in it. */
typedef struct grown_image {
    char *bytes;
    size_t size;
    leaf_header *head[3];
} grown_image;

static grown_image make_image(const leaf_steps *s) {
    grown_image i;
    const char *path = begin(s, 2, "image.leaf");
    add(s, 2, 1, path);
    add(s, 3, 2, path);
    i.bytes = scratch_read(path, &i.size);
    i.head[0] = (leaf_header *)(void *)i.bytes;
    i.head[2] = (leaf_header *)(void *)(i.bytes + i.head[0]->last);
    i.head[1] = (leaf_header *)(void *)(i.bytes + i.head[2]->before);
    return i;
}

static void seal(leaf_header *h) {
    const char *base = (const char *)h;
    const hash_id id =
        leaf_header_id(h, (const leaf_section *)(const void *)(base + leaf_table_at(h)));
    h->id[0] = id.lo;
    h->id[1] = id.hi;
    h->checksum = leaf_header_checksum(h);
}

static void refused(const grown_image *i, const char *what) {
    mem m;
    leaf_file *f = NULL;
    naive_grown *g = malloc(sizeof *g);
    mem_init(&m, 0);
    if (leaf_file_open_memory(&m, "F.leaf", i->bytes, i->size, &f) == ST_OK)
        fail_msg("%s: is opened", what);
    assert_int_equal(mem_used(&m), 0);
    if (naive_grown_load(g, scratch_write("hostile.leaf", i->bytes, i->size), 0))
        fail_msg("%s: the second reader sees nothing", what);
    naive_grown_release(g);
    free(g);
}

/* Change a field of a segment's header, and see it refused. */
#define LIE(image, k, field, value)                           \
    do {                                                      \
        const leaf_header kept = *(image)->head[k];           \
        (image)->head[k]->field = (value);                    \
        seal((image)->head[k]);                               \
        refused(image, "segment " #k ": " #field " " #value); \
        *(image)->head[k] = kept;                             \
    } while (0)

/* Segments with fewer fields than the first, whose names are those of a part of it. */
static void test_fewer_fields(void **state) {
    (void)state;
    leaf_steps s;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_RAW);
    static const char *const names[] = {"one", "two", "three"};
    size_t sizes[2];
    char *bytes[2];
    for (int k = 0; k < 2; k++) { /* three fields; one, with a step more */
        grid_series of = some(&s, 0, k == 0 ? 1 : 2);
        of.of.sets.fields = k == 0 ? 3 : 1;
        of.of.sets.names = names;
        bytes[k] = scratch_read(leaf_files_series(&of, &s.c.options, "part.leaf"), &sizes[k]);
    }
    grown_image i = {.bytes = malloc(sizes[0] + sizes[1]), .size = sizes[0] + sizes[1]};
    memcpy(i.bytes, bytes[0], sizes[0]);
    memcpy(i.bytes + sizes[0], bytes[1], sizes[1]);
    i.head[0] = (leaf_header *)(void *)i.bytes;
    i.head[1] = (leaf_header *)(void *)(i.bytes + sizes[0]);
    i.head[0]->segments = 2;
    i.head[0]->last = sizes[0];
    i.head[1]->steps_before = 1;
    seal(i.head[0]);
    seal(i.head[1]);
    refused(&i, "fewer fields");
    free(i.bytes);
    free(bytes[0]);
    free(bytes[1]);
    leaf_steps_release(&s);
}

static void test_lying_headers(void **state) {
    (void)state;
    leaf_steps s;
    leaf_steps_make(&s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(&s, LEAF_CODEC_ZSTD);
    const grown_image i = make_image(&s);
    const uint64_t first = i.head[0]->file_bytes, last = i.head[0]->last;
    LIE(&i, 0, last, 0);
    LIE(&i, 0, last, 64);
    LIE(&i, 0, last, last - 64);
    LIE(&i, 0, last, first);
    LIE(&i, 0, last, i.size);
    LIE(&i, 0, last, UINT64_MAX - 64);
    LIE(&i, 0, segments, 0);
    LIE(&i, 0, segments, 1);
    LIE(&i, 0, segments, 2);
    LIE(&i, 0, segments, 4);
    LIE(&i, 0, segments, UINT32_MAX);
    LIE(&i, 0, steps_before, 1);
    LIE(&i, 0, before, 64);
    LIE(&i, 1, before, 64);
    LIE(&i, 1, steps_before, 0);
    LIE(&i, 1, steps_before, 1);
    LIE(&i, 1, steps_before, 3);
    LIE(&i, 1, segments, 1);
    LIE(&i, 1, outside, 1);
    LIE(&i, 1, last, last);
    LIE(&i, 2, before, 0);
    LIE(&i, 2, before, last);
    LIE(&i, 2, before, UINT64_MAX);
    LIE(&i, 2, steps_before, UINT32_MAX);
    LIE(&i, 2, steps, 1);
    LIE(&i, 2, steps, 65536);
    LIE(&i, 2, file_bytes, i.head[2]->file_bytes + 4096);
    LIE(&i, 2, run_align_log2, 12);
    LIE(&i, 2, to_world[3], 1.0);
    LIE(&i, 2, source_type, SAMPLE_U16);
    LIE(&i, 2, directory, 0);
    /* Numbers of a header that nobody has checked yet: fewer steps than there are in the first. */
    for (int k = 1; k < 3; k++)
        for (uint32_t steps = 0; steps < 3; steps++) {
            const leaf_header kept = *i.head[k];
            i.head[k]->steps_before = steps == 2 ? UINT32_MAX : steps;
            i.head[k]->steps = 0;
            refused(&i, "steps that no checksum holds");
            i.head[k]->steps = steps;
            refused(&i, "steps that no checksum holds");
            *i.head[k] = kept;
        }
    /* A segment alone. */
    const grown_image alone = {.bytes = (char *)i.head[1], .size = i.head[1]->file_bytes};
    refused(&alone, "a segment alone");
    /* A page of nothing between two. */
    grown_image gap = {.bytes = calloc(1, i.size + LEAF_HEADER_BYTES),
                       .size = i.size + LEAF_HEADER_BYTES};
    memcpy(gap.bytes, i.bytes, last);
    memcpy(gap.bytes + last + LEAF_HEADER_BYTES, i.bytes + last, i.size - last);
    gap.head[0] = (leaf_header *)(void *)gap.bytes;
    gap.head[0]->last += LEAF_HEADER_BYTES;
    seal(gap.head[0]);
    refused(&gap, "a page between segments");
    free(gap.bytes);
    free(i.bytes);
    leaf_steps_release(&s);
}

/* The last segment of a file, with plain sections. Their checksums are made right by
 * leaf_image_seal(). */
static void lie_about(const grown_image *whole, uint32_t kind, uint32_t p, uint32_t value,
                      const char *what) {
    const size_t before = whole->head[0]->last;
    char *own = malloc(whole->size - before);
    memcpy(own, whole->bytes + before, whole->size - before);
    const leaf_image i = leaf_image_of(own, whole->size - before);
    uint32_t *links = leaf_image_section(&i, kind);
    assert_non_null(links);
    links[p] = value;
    leaf_image_seal(&i);
    grown_image lying = {.size = before + i.size, .bytes = malloc(before + i.size)};
    memcpy(lying.bytes, whole->bytes, before);
    memcpy(lying.bytes + before, i.bytes, i.size);
    refused(&lying, what);
    free(lying.bytes);
    free(i.bytes);
}

/* Steps 0, 0; 2; 2, 4: the last segment has links of both kinds. */
static void make_links(leaf_steps *s, leaf_codec codec) {
    leaf_steps_make(s, 20, 19, 18, SAMPLE_U8);
    leaf_steps_use(s, codec);
    for (int step = 1; step <= 3; step += 2) {
        free((void *)(uintptr_t)s->paths[step]);
        s->paths[step] = strdup(s->paths[step - 1]);
    }
}

/* Where all payloads have as many bytes. */
static void test_lying_raw(void **state) {
    (void)state;
    leaf_steps s;
    make_links(&s, LEAF_CODEC_RAW);
    const grown_image i = make_image(&s);
    lie_about(&i, LEAF_SECTION_SAME, 1, LEAF_LINK_BEFORE, "another payload");
    free(i.bytes);
    leaf_steps_release(&s);
}

static void test_lying_links(void **state) {
    (void)state;
    leaf_steps s;
    make_links(&s, LEAF_CODEC_ZSTD);
    const grown_image i = make_image(&s);
    const uint32_t before = LEAF_LINK_BEFORE;
    enum { TREELET = 1 };
    const uint32_t second = TREELET + (uint32_t)i.head[0]->treelets; /* at step 4 */
    lie_about(&i, LEAF_SECTION_SAME, TREELET, before | 3, "a set that does not come before");
    lie_about(&i, LEAF_SECTION_SAME, TREELET, before | 1, "another payload");
    lie_about(&i, LEAF_SECTION_SAME, TREELET, UINT32_MAX, "no set");
    lie_about(&i, LEAF_SECTION_SAME, TREELET, 1, "itself");
    lie_about(&i, LEAF_SECTION_SAME, second, before | 2, "the same and a difference");
    lie_about(&i, LEAF_SECTION_BASES, second, before | 1, "a base that is the same as an earlier");
    lie_about(&i, LEAF_SECTION_BASES, second, before | 3, "a base that does not come before");
    lie_about(&i, LEAF_SECTION_BASES, second, 1, "a base that is the same as another");
    lie_about(&i, LEAF_SECTION_BASES, TREELET, before, "the same, with a base");
    free(i.bytes);
    leaf_steps_release(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_segments),     cmocka_unit_test(test_again),
        cmocka_unit_test(test_static),       cmocka_unit_test(test_back),
        cmocka_unit_test(test_readers),      cmocka_unit_test(test_two),
        cmocka_unit_test(test_refused),      cmocka_unit_test(test_faults),
        cmocka_unit_test(test_killed),       cmocka_unit_test(test_lying_headers),
        cmocka_unit_test(test_lying_links),  cmocka_unit_test(test_lying_raw),
        cmocka_unit_test(test_fewer_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
