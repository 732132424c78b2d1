/* test_mesh_grow.c - files of meshes that grow: whatever segments the steps came in, both readers
 * find what a file of all of them has; what is no further step is refused by name; nothing that
 * fails takes away what was there; and nothing that lies about a segment is believed. */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/leaf/histogram_draw.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/leaf_image.h"
#include "tests/support/leaf_steps.h"
#include "tests/support/mesh_movies.h"
#include "tests/support/naive_grown.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

/* ---- growing ---- */

/* Convert `count` steps from `first` on, to a new file or, if grow, to further steps of it. */
static status put(mesh_movie *v, uint32_t first, uint32_t count, const char *path, bool grow) {
    mesh_series some = v->series;
    mesh_movie part = *v;
    mesh_result r;
    some.of.paths += first;
    some.of.sets.steps = count;
    if (some.of.sets.times)
        some.of.sets.times += first;
    part.c.options.series = &some;
    part.c.options.grows = true;
    part.c.options.force = !grow;
    m.limit = (size_t)v->c.options.memory;
    status st = grow ? leaf_grow_open(&m, path, &part.c.options.grow) : ST_OK;
    if (st == ST_OK)
        st = mesh_movies_convert(&m, &part, path, &r, false);
    leaf_grow_close(part.c.options.grow);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static const char *begin(mesh_movie *v, uint32_t steps, const char *name) {
    if (put(v, 0, steps, scratch_path(name), false) != ST_OK)
        fail_msg("%s", status_text());
    return scratch_path(name);
}

static void add(mesh_movie *v, uint32_t first, uint32_t count, const char *path) {
    if (put(v, first, count, path, true) != ST_OK)
        fail_msg("%s", status_text());
}

/* A movie whose points stay. Step 3 has the values of step 1, and step 5 those of step 4. */
static void make(mesh_movie *v, uint32_t fields, uint32_t steps, uint32_t treelet_tets,
                 leaf_codec codec) {
    mesh_case c = mesh_cases_kuhn(7, 7, 5);
    mesh_cases_shuffle(&c, fields);
    c.options.treelet_tets = treelet_tets;
    c.options.file.codec = codec;
    c.options.file.zstd_level = 1;
    *v = mesh_movies_make(c, fields, steps, steps, 0);
    for (uint32_t s = 3; s < steps && s < 6; s += 2)
        for (uint32_t f = 0; f < fields; f++)
            memcpy(v->values[s][f], v->values[s == 3 ? 1 : 4][f], c.point_count * sizeof *c.values);
    mesh_movies_write(v);
}

/* ---- what is in the file ---- */

/* Each payload of a file is what it is in another, and what the directory says of it. */
static void compare_files(leaf_file *a, leaf_unpacker *ua, leaf_file *b, leaf_unpacker *ub) {
    const leaf_layout *l = &a->layout;
    const size_t room = leaf_layout_payload_max(l), sets = l->sets, n = l->treelets;
    char *x = malloc(room), *y = malloc(room);
    assert_int_equal(l->payloads, b->layout.payloads);
    assert_memory_equal(a->own, b->own, n * sets * sizeof *a->own);
    assert_memory_equal(a->ranges, b->ranges, n * sets * sizeof *a->ranges);
    assert_memory_equal(a->flags, b->flags, n * sets);
    assert_memory_equal(a->mesh->bounds, b->mesh->bounds, n * sizeof *a->mesh->bounds);
    assert_memory_equal(a->mesh->counts, b->mesh->counts, n * sizeof *a->mesh->counts);
    assert_memory_equal(a->header.bounds, b->header.bounds, sizeof a->header.bounds);
    assert_true(a->header.value_min == b->header.value_min);
    assert_true(a->header.value_max == b->header.value_max);
    assert_int_equal(a->header.non_finite, b->header.non_finite);
    if (l->steps > 1) /* alone, a step has no time */
        assert_memory_equal(a->times, b->times, l->steps * sizeof *a->times);
    for (uint32_t p = 0; p < l->payloads; p++) {
        assert_int_equal(leaf_file_load(a, p, ua, x), ST_OK);
        assert_int_equal(leaf_file_load(b, p, ub, y), ST_OK);
        assert_memory_equal(x, y, leaf_layout_payload_bytes(l, p));
    }
    free(x);
    free(y);
}

/* Check a file against one of the same steps, converted at once. */
static void check_file(mesh_movie *v, const char *path, uint32_t steps) {
    leaf_unpacker *u[2] = {NULL};
    mesh_movie all = *v;
    mesh_series some = v->series;
    mesh_result r;
    some.of.sets.steps = steps;
    all.c.options.series = &some;
    assert_int_equal(mesh_movies_convert(&m, &all, scratch_path("all.leaf"), &r, false), ST_OK);
    leaf_file *f = leaf_steps_open(&m, path, &u[0]);
    leaf_file *g = leaf_steps_open(&m, scratch_path("all.leaf"), &u[1]);
    assert_int_equal(f->header.steps, steps);
    assert_true(f->header.file_bytes <= file_size(f->source));
    compare_files(f, u[0], g, u[1]);
    if (leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    leaf_unpacker_destroy(u[0]);
    leaf_unpacker_destroy(u[1]);
    leaf_file_close(f);
    leaf_file_close(g);
    assert_int_equal(mem_used(&m), 0);
}

/* The input's point that is a treelet's vertex; places are all different. */
static size_t point_of(const mesh_case *c, const float at[3]) {
    size_t i = 0;
    while (i < c->point_count && memcmp(c->points[i], at, sizeof *c->points) != 0)
        i++;
    assert_true(i < c->point_count);
    return i;
}

/* Check what the second reader finds. */
static void check_naive(const mesh_movie *v, const char *path, uint32_t steps) {
    naive_grown *g = malloc(sizeof *g);
    if (!naive_grown_load(g, path, 0))
        fail_msg("%s", g->why);
    assert_int_equal(g->steps, steps);
    for (uint32_t s = 0; s < steps; s++) {
        long own;
        const naive_mesh *mesh = naive_grown_mesh(g, s, &own);
        for (long t = 0; t < mesh->treelets; t++)
            for (long i = 0; i < mesh->part[t].vertices; i++) {
                const naive_part *p = &mesh->part[t];
                const size_t id = point_of(&v->c, p->positions[i]);
                for (uint32_t f = 0; f < v->fields; f++)
                    assert_memory_equal(&p->values[(f * mesh->steps + own) * p->vertices + i],
                                        &v->values[s][f][id], sizeof(float));
            }
    }
    naive_grown_release(g);
    free(g);
}

static void test_segments(void **state) {
    (void)state;
    enum { STEPS = 7 };
    static const uint32_t begins[] = {1, 2, 3, 5, STEPS};
    for (int i = 0; i < 4; i += WATCHED_THREADS ? 3 : 1) {
        mesh_movie v;
        make(&v, i == 2 ? 3 : 1 + (uint32_t)i % 2, STEPS, i % 2 ? 200 : 4096,
             i < 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW);
        v.c.options.gradients = i > 0;
        v.c.options.sah = i == 3;
        if (i == 0)
            v.series.of.sets.times = NULL;
        const char *path = begin(&v, 1, "grown.leaf");
        check_file(&v, path, 1);
        for (size_t k = 0; k + 1 < sizeof begins / sizeof *begins; k++) {
            /* Of how the file was packed nothing must follow. */
            v.c.options.file.zstd_level = 1 + (int)k;
            add(&v, begins[k], begins[k + 1] - begins[k], path);
        }
        v.c.options.file.zstd_level = 1;
        check_file(&v, path, STEPS);
        if (!WATCHED_THREADS)
            check_naive(&v, path, STEPS);
        mesh_movies_release(&v);
    }
}

static void swap(uint32_t *a, uint32_t *b) {
    const uint32_t kept = *a;
    *a = *b;
    *b = kept;
}

/* A file that was not said to grow, of several steps and fields, does so, too. */
static void test_plain(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v;
    make(&v, 2, 4, 200, LEAF_CODEC_ZSTD);
    mesh_movie two = v;
    mesh_series some = v.series;
    mesh_result r;
    some.of.sets.steps = 2;
    two.c.options.series = &some;
    const char *path = scratch_path("plain.leaf");
    assert_int_equal(mesh_movies_convert(&m, &two, path, &r, false), ST_OK);
    add(&v, 2, 1, path);
    /* Which way some of its tets are turned does not matter. */
    for (int turned = 1; turned >= 0; turned--) {
        for (size_t t = 0; t < v.c.tet_count / 3; t++)
            swap(&v.c.tets[t][0], &v.c.tets[t][1]);
        mesh_movies_write(&v);
        if (turned)
            add(&v, 3, 1, path);
    }
    check_file(&v, path, 4);
    check_naive(&v, path, 4);
    mesh_movies_release(&v);
}

/* A segment's histograms are of the tets that were drawn for its own steps, not for all. */
static void test_histograms(void **state) {
    (void)state;
    skip_under_thread();
    enum { STEPS = 3 };
    mesh_case c = mesh_cases_kuhn(17, 17, 17);
    mesh_cases_shuffle(&c, 1);
    c.options.file.histograms = true;
    mesh_movie v = mesh_movies_make(c, 1, STEPS, STEPS, 0);
    mesh_movies_write(&v);
    const char *path = begin(&v, 1, "drawn.leaf");
    for (uint32_t s = 1; s < STEPS; s++)
        add(&v, s, 1, path);
    leaf_unpacker *u = NULL;
    leaf_file *f = leaf_steps_open(&m, path, &u);
    const uint64_t tets = f->header.tets;
    assert_non_null(f->histograms);
    assert_true(tets <= HISTOGRAM_TETS && tets > HISTOGRAM_TETS / STEPS);
    if (leaf_verify(&m, f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    leaf_unpacker_destroy(u);
    leaf_file_close(f);
    mesh_movies_release(&v);
}

/* What any earlier step has is not stored again. */
static void test_same(void **state) {
    (void)state;
    skip_under_thread();
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        mesh_movie v;
        make(&v, 1, 3, 4096, (leaf_codec)codec);
        size_t two, all;
        v.c.options.gradients = true;
        v.series.of.sets.times = NULL;
        const char *path = begin(&v, 1, "same.leaf");
        add(&v, 1, 1, path);
        free(scratch_read(path, &two));
        for (int i = 0; i < 4; i++)
            add(&v, (uint32_t)i % 2, 1, path);
        free(scratch_read(path, &all));
        /* A header and a small directory each. */
        assert_int_equal(all, two + 4 * (4096 + 4096));
        mesh_movies_release(&v);
    }
}

/* A step that is added has the same bytes whatever the threads and the memory. */
static void test_again(void **state) {
    (void)state;
    mesh_case c = mesh_cases_kuhn(30, 30, 30);
    mesh_cases_shuffle(&c, 3);
    c.options.treelet_tets = 300;
    c.options.gradients = true;
    mesh_movie v = mesh_movies_make(c, 1, 3, 3, 0);
    mesh_movies_write(&v);
    for (int threads = 1; threads <= 3; threads++) {
        mesh_result r;
        v.c.options.threads = threads;
        v.c.options.memory = UINT64_C(1) << 30;
        assert_int_equal(mesh_movies_convert(&m, &v, "", &r, true), ST_OK);
        if (threads > 1)
            v.c.options.memory = r.plan.memory_least + (4 << 20);
        const char *path = begin(&v, 1, threads == 1 ? "one.leaf" : "other.leaf");
        add(&v, 1, 2, path);
        if (threads > 1)
            scratch_same("segments", path, scratch_path("one.leaf"));
    }
    mesh_movies_release(&v);
}

/* ---- what is refused ---- */

static void refuse(mesh_movie *v, uint32_t count, const char *said) {
    size_t sizes[2];
    const char *path = scratch_path("refused.leaf");
    char *before = scratch_read(path, &sizes[0]);
    const size_t files = scratch_count();
    const status st = put(v, 1, count, path, true);
    if (st != ST_USAGE || !strstr(status_text(), said))
        fail_msg("expected \"%s\", found %d: %s", said, st, st ? status_text() : "");
    char *after = scratch_read(path, &sizes[1]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(before, after, sizes[0]);
    assert_int_equal(scratch_count(), files);
    free(before);
    free(after);
}

static void test_refused(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v;
    make(&v, 1, 3, 4096, LEAF_CODEC_ZSTD);
    char said[128];
    const char *path = begin(&v, 1, "refused.leaf");
    /* A point that moved, by so little that all else is the same. */
    float *x = &v.points[1][17][1];
    const float kept = *x;
    *x += 0x1p-10F;
    v.paths[1] = mesh_movies_stream(&v, 1, "moved.mesh", v.c.tet_count);
    snprintf(said, sizeof said,
             "moved.mesh: no further step of %s: point 17 lies at %g, %g, %g, expected", path,
             (double)v.points[1][17][0], (double)*x, (double)v.points[1][17][2]);
    refuse(&v, 1, said);
    *x = kept;
    /* All of them. */
    for (size_t i = 0; i < v.c.point_count; i++)
        v.points[1][i][2] *= -3;
    v.paths[1] = mesh_movies_stream(&v, 1, "turned.mesh", v.c.tet_count);
    refuse(&v, 1, "its points lie elsewhere, or its tets join others");
    memcpy(v.points[1], v.c.points, v.c.point_count * sizeof *v.c.points);
    mesh_movies_write(&v);
    v.paths[1] = mesh_movies_stream(&v, 1, "fewer.mesh", v.c.tet_count - 1);
    snprintf(said, sizeof said, "it has %zu tets, expected %zu", v.c.tet_count - 1, v.c.tet_count);
    refuse(&v, 1, said);
    /* Another tet in the place of one, with its points: as many of all. */
    uint32_t tet[4];
    memcpy(tet, v.c.tets[5], sizeof tet);
    memcpy(v.c.tets[5], v.c.tets[6], sizeof tet);
    v.paths[1] = mesh_movies_stream(&v, 1, "twice.mesh", v.c.tet_count);
    refuse(&v, 1, "its tets join other");
    memcpy(v.c.tets[5], tet, sizeof tet);
    mesh_movies_write(&v);
    v.c.options.sah = true;
    refuse(&v, 1, "--build is not what the file was made with");
    v.c.options.sah = false;
    /* Two steps that differ from one another. */
    v.points[2][17][1] += 1;
    v.paths[2] = mesh_movies_stream(&v, 2, "later.mesh", v.c.tet_count);
    refuse(&v, 2, "points that move from step to step");
    assert_int_equal(put(&v, 1, 2, scratch_path("moving.leaf"), false), ST_USAGE);
    mesh_movies_release(&v);
}

/* Files that do not grow. */
static void test_cannot(void **state) {
    (void)state;
    skip_under_thread();
    leaf_grow *g = NULL;
    mesh_result r;
    mesh_movie v = mesh_movies_make(mesh_cases_kuhn(5, 5, 5), 1, 2, 1, 0);
    mesh_movies_write(&v);
    const char *path = scratch_path("moves.leaf");
    assert_int_equal(mesh_movies_convert(&m, &v, path, &r, false), ST_OK);
    assert_int_equal(leaf_grow_open(&m, path, &g), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "its vertices move"));
    v.series.of.sets.steps = 1;
    v.c.options.coarse = true;
    assert_int_equal(mesh_movies_convert(&m, &v, path, &r, false), ST_OK);
    assert_int_equal(leaf_grow_open(&m, path, &g), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "it has coarse grids"));
    assert_int_equal(mem_used(&m), 0);
    mesh_movies_release(&v);
}

/* ---- what fails ---- */

/* Add a step while the k-th operation of a kind fails. Returns whether one did. */
static bool fail_at(mesh_movie *v, fault_kind kind, long k, const char *path) {
    fault_arm(kind, k);
    const status st = put(v, 2, 1, path, true);
    const bool fired = fault_fired(kind);
    fault_arm(kind, 0);
    if (!fired)
        assert_int_equal(st, ST_OK);
    /* Whatever happened: all that was there, or all with the new step. */
    check_file(v, path, st == ST_OK ? 3 : 2);
    return fired;
}

static void test_faults(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v;
    make(&v, 1, 3, 300, LEAF_CODEC_ZSTD);
    size_t size;
    v.c.options.threads = 1;
    const char *path = begin(&v, 1, "two.leaf");
    add(&v, 1, 1, path);
    char *two = scratch_read(path, &size);
    for (int kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++) {
        long k = 1;
        bool fired = true;
        for (; fired; k += 1 + k / 8)
            fired = fail_at(&v, (fault_kind)kind, k, scratch_write("faults.leaf", two, size));
        assert_true(k > 4);
    }
    free(two);
    mesh_movies_release(&v);
}

/* A program that was killed: part of a segment, or all of it, is there and does not count. */
static void test_killed(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v;
    make(&v, 1, 3, 300, LEAF_CODEC_ZSTD);
    size_t before, after;
    char head[LEAF_HEADER_BYTES];
    const char *path = begin(&v, 2, "killed.leaf");
    char *bytes = scratch_read(path, &before);
    memcpy(head, bytes, sizeof head);
    free(bytes);
    add(&v, 2, 1, path);
    bytes = scratch_read(path, &after);
    const size_t piece = (after - before) / 5;
    for (size_t size = before; size <= after + 2 * piece; size += piece) {
        char *part = calloc(1, size);
        memcpy(part, bytes, size < after ? size : after);
        memcpy(part, head, sizeof head);
        path = scratch_write("part.leaf", part, size);
        free(part);
        check_file(&v, path, 2);
        add(&v, 2, 1, path);
        scratch_same("the same as without", path, scratch_path("killed.leaf"));
    }
    free(bytes);
    mesh_movies_release(&v);
}

/* ---- lies ---- */

static void refused(const char *bytes, size_t size, const char *what) {
    leaf_file *f = NULL;
    naive_grown *g = malloc(sizeof *g);
    if (leaf_file_open_memory(&m, "F.leaf", bytes, size, &f) == ST_OK)
        fail_msg("%s: is opened", what);
    assert_int_equal(mem_used(&m), 0);
    if (naive_grown_load(g, scratch_write("hostile.leaf", bytes, size), 0))
        fail_msg("%s: the second reader sees nothing", what);
    naive_grown_release(g);
    free(g);
}

/* A lie about a section of a segment: element `at`, a u32, becomes `value`. */
typedef struct lie {
    int segment; /* of the two: the first, or the second */
    uint32_t kind, at, value;
    const char *what;
} lie;

/* Tell a lie, in a file of two segments, the second of which begins at byte `before`. */
static void tell(const char *bytes, size_t size, size_t before, const lie *x) {
    const size_t at = x->segment ? before : 0;
    const size_t own = x->segment ? size - before : before;
    char *part = malloc(own);
    memcpy(part, bytes + at, own);
    const leaf_image i = leaf_image_of(part, own);
    if (x->kind) {
        uint32_t *elements = leaf_image_section(&i, x->kind);
        assert_non_null(elements);
        assert_int_not_equal(elements[x->at], x->value);
        elements[x->at] = x->value;
    } else {
        uint32_t *field = (uint32_t *)(void *)((char *)i.header + x->at);
        assert_int_not_equal(*field, x->value);
        *field = x->value;
    }
    leaf_image_seal(&i);
    const size_t all = x->segment ? before + i.size : i.size + size - before;
    char *lying = malloc(all);
    memcpy(lying, x->segment ? bytes : i.bytes, x->segment ? before : i.size);
    memcpy(lying + (x->segment ? before : i.size), x->segment ? i.bytes : bytes + before,
           x->segment ? i.size : size - before);
    refused(lying, all, x->what);
    free(lying);
    free(i.bytes);
}

#define HEADER(segment, field, value) \
    { segment, 0, offsetof(leaf_header, field), value, "segment " #segment ": " #field " " #value }

static void test_lies(void **state) {
    (void)state;
    skip_under_thread();
    mesh_movie v;
    make(&v, 1, 3, 300, LEAF_CODEC_RAW);
    size_t before, size;
    v.c.options.gradients = true;
    const char *path = begin(&v, 2, "lies.leaf");
    free(scratch_read(path, &before));
    add(&v, 2, 1, path);
    char *bytes = scratch_read(path, &size);
    const uint32_t n = (uint32_t)((const leaf_header *)(const void *)bytes)->treelets;
    const uint32_t from = LEAF_LINK_BEFORE;
    const lie lies[] = {
        HEADER(1, tets, 1),
        HEADER(1, vertices, 400),
        HEADER(1, treelet_tets, 301),
        HEADER(1, leaf_tets, 13),
        HEADER(1, flat, 1),
        HEADER(1, inverted, 1),
        HEADER(1, gradients, 0),
        HEADER(1, moving, 1),
        HEADER(0, moving, 1),
        HEADER(1, bounds, 0xbf000000),
        {1, LEAF_SECTION_COUNTS, 2, 1, "other counts"},
        {1, LEAF_SECTION_BOUNDS, 0, 0xbf000000, "other bounds"},
        {1, LEAF_SECTION_BOUNDS, 6, 0x3e800000, "other bounds in the same whole"},
        {1, LEAF_SECTION_SAME, 0, 0, "a topology of its own"},
        {1, LEAF_SECTION_SAME, 0, 1, "a topology that is itself"},
        {1, LEAF_SECTION_SAME, 0, from | 1, "a topology of a later step"},
        {1, LEAF_SECTION_SAME, 0, from | 2, "a topology of no step"},
        {1, LEAF_SECTION_SAME, 0, UINT32_MAX, "a topology of nothing"},
        {1, LEAF_SECTION_SAME, n, from, "values of another step"},
        {1, LEAF_SECTION_SAME, n, from | 2, "values of no earlier step"},
        {1, LEAF_SECTION_SAME, 2 * n, from, "gradients of another step"},
        {1, LEAF_SECTION_SIZES, 0, 64, "the size of a topology"},
        {1, LEAF_SECTION_CHECKSUMS, 0, 7, "the checksum of a topology"},
        {1, LEAF_SECTION_OFFSETS, 0, 4096, "the offset of a topology"},
    };
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++)
        tell(bytes, size, before, &lies[i]);
    free(bytes);
    mesh_movies_release(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_segments),   cmocka_unit_test(test_plain),
        cmocka_unit_test(test_histograms), cmocka_unit_test(test_same),
        cmocka_unit_test(test_again),      cmocka_unit_test(test_refused),
        cmocka_unit_test(test_cannot),     cmocka_unit_test(test_faults),
        cmocka_unit_test(test_killed),     cmocka_unit_test(test_lies),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
