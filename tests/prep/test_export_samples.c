/* test_export_samples.c - exported samples: bytes as they went in, of any type, box, level and
 * treelet, within any budget; heads of files as a naive reader, or the own ones, understand them.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "formats/base/fault.h"
#include "formats/grid/volume.h"
#include "prep/export/grid_slices.h"
#include "prep/export/sample_format.h"
#include "prep/export/slice_files.h"
#include "tests/support/leaf_files.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/scratch.h"

/* ---- samples ---- */

typedef struct sink {
    char *bytes;
    size_t size, width, room, fail_at;
} sink;

static status take(void *ctx, const void *samples, size_t count) {
    sink *s = ctx;
    if (s->fail_at && s->size >= s->fail_at)
        return status_describe(ST_NOSPACE, "no more");
    assert_true(s->size + count * s->width <= s->room);
    memcpy(s->bytes + s->size, samples, count * s->width);
    s->size += count * s->width;
    return ST_OK;
}

static status try_slices(const char *path, uint32_t level, const uint32_t *box, int threads,
                         size_t memory, sink *s) {
    mem m;
    leaf_file *f = NULL;
    grid_part part;
    mem_init(&m, 0);
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = grid_part_of(f, level, box, &part);
    if (st == ST_OK) {
        m.limit = memory ? mem_used(&m) + memory : 0;
        s->width = sample_size(f->layout.type);
        st = grid_slices_run(&m, f, &part, threads, NULL, take, s);
        m.limit = 0;
    }
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

/* The input's bytes of a box. */
static size_t cut(const leaf_case *c, const uint32_t box[6], char *out) {
    const size_t width = sample_size(c->type), row = (box[3] - box[0] + 1) * width;
    size_t at = 0;
    for (size_t z = box[2]; z <= box[5]; z++)
        for (size_t y = box[1]; y <= box[4]; y++, at += row)
            memcpy(out + at,
                   (const char *)c->samples + ((z * c->dims[1] + y) * c->dims[0] + box[0]) * width,
                   row);
    return at;
}

static void check_box(const char *path, const leaf_case *c, const uint32_t box[6], int threads,
                      size_t memory) {
    const size_t room = (size_t)c->dims[0] * c->dims[1] * c->dims[2] * sample_size(c->type);
    char *want = malloc(room);
    sink s = {.bytes = malloc(room), .room = room};
    assert_true(want && s.bytes);
    const size_t size = cut(c, box, want);
    if (try_slices(path, 0, box, threads, memory, &s) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(s.size, size);
    assert_memory_equal(s.bytes, want, size);
    free(want);
    free(s.bytes);
}

static void test_types(void **state) {
    (void)state;
    static const uint32_t boxes[][6] = {{0, 0, 0, 36, 19, 44},    {5, 3, 15, 5, 3, 15},
                                        {15, 15, 15, 17, 17, 33}, {16, 0, 16, 36, 16, 16},
                                        {0, 19, 31, 36, 19, 32},  {36, 19, 44, 36, 19, 44}};
    for (int type = SAMPLE_U8; type <= SAMPLE_F32; type++)
        for (int way = 0; way < 4; way++) {
            leaf_case c = leaf_files_case(37, 20, 45, (sample_type)type);
            c.options.file.codec = way & 1 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.halo = way >> 1;
            c.options.file.cells_log2 = way == 3 ? 5 : 4;
            c.samples = leaf_files_random(&c, (uint64_t)(4 * type + way), 50);
            const char *path = leaf_files_make(&c, "types.leaf");
            for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++)
                for (int threads = 1; threads < 4; threads += 2)
                    check_box(path, &c, boxes[b], threads, threads == 1 ? 0 : 1 << 21);
            free((void *)(uintptr_t)c.samples);
        }
}

/* Budgets from too small on: refused with the smallest that will do, which then does. */
static void test_budgets(void **state) {
    (void)state;
    const uint32_t box[6] = {0, 0, 0, 199, 149, 39};
    leaf_case c = leaf_files_case(200, 150, 40, SAMPLE_U16);
    c.samples = leaf_files_random(&c, 1, 0);
    const char *path = leaf_files_make(&c, "budget.leaf");
    const size_t room = (size_t)200 * 150 * 40 * 2;
    sink s = {.bytes = malloc(room), .room = room};
    size_t least = 1000;
    for (status st = ST_NOMEM; st == ST_NOMEM; least += 1000) {
        s.size = 0;
        st = try_slices(path, 0, box, 4, least, &s);
        if (st == ST_NOMEM)
            assert_non_null(strstr(status_text(), "memory"));
        else
            assert_int_equal(st, ST_OK);
    }
    assert_true(least < 300000);
    for (size_t memory = least; memory < 3000000; memory += memory / 2)
        check_box(path, &c, box, 4, memory);
    free(s.bytes);
    free((void *)(uintptr_t)c.samples);
}

static void test_levels(void **state) {
    (void)state;
    leaf_case c = leaf_files_case(70, 41, 33, SAMPLE_I16);
    naive_leaf n;
    c.samples = leaf_files_random(&c, 3, 0);
    const char *path = leaf_files_make(&c, "levels.leaf");
    assert_true(naive_leaf_load(&n, path));
    assert_true(n.levels > 2);
    for (int l = 0; l < n.levels; l++) {
        const long *nodes = n.level[l].nodes, count = nodes[0] * nodes[1] * nodes[2];
        sink s = {.bytes = malloc((size_t)count * 2), .room = (size_t)count * 2};
        assert_int_equal(try_slices(path, (uint32_t)l, NULL, 2, 0, &s), ST_OK);
        assert_int_equal(s.size, s.room);
        for (long i = 0; i < count; i++)
            assert_true((float)((const int16_t *)(const void *)s.bytes)[i] ==
                        n.level[l].samples[i]);
        free(s.bytes);
    }
    naive_leaf_release(&n);
    free((void *)(uintptr_t)c.samples);
}

static void test_refused(void **state) {
    (void)state;
    leaf_case c = leaf_files_case(20, 21, 22, SAMPLE_U8);
    c.samples = leaf_files_random(&c, 3, 0);
    const char *path = leaf_files_make(&c, "refused.leaf");
    sink s = {.bytes = malloc(20 * 21 * 22), .room = 20 * 21 * 22};
    assert_int_equal(try_slices(path, 2, NULL, 1, 0, &s), ST_USAGE);
    assert_int_equal(try_slices(path, 0, (uint32_t[6]){0, 0, 0, 20, 0, 0}, 1, 0, &s), ST_USAGE);
    assert_int_equal(try_slices(path, 0, (uint32_t[6]){0, 4, 0, 2, 3, 0}, 1, 0, &s), ST_USAGE);
    assert_int_equal(try_slices(path, 1, (uint32_t[6]){0, 0, 0, 11, 1, 1}, 1, 0, &s), ST_USAGE);
    s.fail_at = 1;
    assert_int_equal(try_slices(path, 0, NULL, 1, 75000, &s), ST_NOSPACE);
    s.fail_at = s.size = 0;
    for (int kind = FAULT_ALLOC; kind <= FAULT_READ; kind++)
        for (long k = 1, more = 1; more; k++) {
            s.size = 0;
            fault_arm((fault_kind)kind, k);
            const status st = try_slices(path, 0, NULL, 1, 0, &s);
            more = fault_fired((fault_kind)kind);
            fault_arm((fault_kind)kind, 0);
            assert_int_equal(st == ST_OK, !more);
        }
    free(s.bytes);
    free((void *)(uintptr_t)c.samples);
}

/* ---- heads ---- */

static const sample_format *format_of(const char *name) {
    for (int i = 0; i < sample_format_count; i++)
        if (strcmp(sample_formats[i].name, name) == 0)
            return &sample_formats[i];
    fail_msg("no format %s", name);
    return NULL;
}

static const double turned[3][4] = {{0.5, -0.25, 0.1, 1e6}, {0.125, 2, 0, -3}, {-1, 0, 0.375, 0.1}},
                    upright[3][4] = {{0.5, 0, 0, -7}, {0, -0.25, 0, 3}, {0, 0, 8, 1.0 / 1024}};

static void put_map(grid *g, const double map[3][4]) {
    memcpy(g->to_world, map, sizeof g->to_world);
}

static uint16_t *few_samples(const grid *g) {
    uint16_t *samples = malloc(grid_samples(g) * sizeof *samples);
    assert_non_null(samples);
    for (size_t i = 0; i < grid_samples(g); i++)
        samples[i] = (uint16_t)(i * 2654435761u >> 16);
    return samples;
}

/* The file of a grid of u16; its bytes, to be freed. */
static char *write_grid(const char *format, const grid *g, bool gzip, const char *name,
                        size_t *size) {
    const sample_format *f = format_of(format);
    uint16_t *samples = few_samples(g);
    mem m;
    out_stream *out;
    mem_init(&m, 0);
    if (f->check && f->check(g) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(out_stream_create(&m, scratch_path(name), true, gzip, &out), ST_OK);
    if (f->head)
        assert_int_equal(f->head(&m, out, g), ST_OK);
    assert_int_equal(out_stream_samples(out, SAMPLE_U16, samples, grid_samples(g)), ST_OK);
    if (f->tail)
        assert_int_equal(f->tail(out), ST_OK);
    assert_int_equal(out_stream_commit(out), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    free(samples);
    return scratch_read(scratch_path(name), size);
}

static grid small_grid(void) {
    const uint32_t dims[3] = {5, 4, 3};
    grid g;
    grid_init(&g, dims, SAMPLE_U16);
    snprintf(g.name, sizeof g.name, "a <\"small\"> & grid");
    put_map(&g, turned);
    return g;
}

static void check_samples(const grid *g, const char *bytes) {
    uint16_t *samples = few_samples(g);
    assert_memory_equal(bytes, samples, 2 * grid_samples(g));
    free(samples);
}

static void test_nrrd(void **state) {
    (void)state;
    grid g = small_grid();
    mem m;
    volume *v;
    free(write_grid("nrrd", &g, false, "a.nrrd", NULL));
    mem_init(&m, 0);
    assert_int_equal(volume_open(&m, scratch_path("a.nrrd"), NULL, &v), ST_OK);
    const grid *back = volume_grid(v);
    assert_memory_equal(back->to_world, g.to_world, sizeof g.to_world);
    assert_memory_equal(back->dims, g.dims, sizeof g.dims);
    assert_string_equal(back->name, g.name);
    volume_close(v);
}

static double number(const char *bytes, size_t at, char form) {
    float single;
    double value;
    int64_t whole;
    int16_t part;
    switch (form) {
    case 'f': memcpy(&single, bytes + at, 4); return (double)single;
    case 'd': memcpy(&value, bytes + at, 8); return value;
    case 'l': memcpy(&whole, bytes + at, 8); return (double)whole;
    default: memcpy(&part, bytes + at, 2); return part;
    }
}

/* Offsets from the definition of the format: sizes, type, offset of the samples, sform. */
static void check_nifti(const char *bytes, const grid *g, bool two) {
    const size_t dim = two ? 16 : 40, step = two ? 8 : 2, map = two ? 400 : 280;
    const char whole = two ? 'l' : 's', real = two ? 'd' : 'f';
    assert_int_equal(number(bytes, 0, 's'), two ? 540 : 348);
    assert_memory_equal(bytes + (two ? 4 : 344), two ? "n+2\0\r\n\032\n" : "n+1", two ? 8 : 4);
    assert_int_equal(number(bytes, dim, whole), 3);
    assert_int_equal(number(bytes, two ? 12 : 70, 's'), 512);
    assert_int_equal(number(bytes, two ? 14 : 72, 's'), 16);
    assert_int_equal(number(bytes, two ? 168 : 108, two ? 'l' : 'f'), two ? 544 : 352);
    assert_int_equal(number(bytes, two ? 176 : 112, real), 1);
    assert_int_equal(number(bytes, two ? 348 : 254, 's'), 2);
    assert_string_equal(bytes + (two ? 240 : 148), g->name);
    for (int a = 0; a < 3; a++) {
        const double *const w = g->to_world[a];
        const double length =
            sqrt(g->to_world[0][a] * g->to_world[0][a] + g->to_world[1][a] * g->to_world[1][a] +
                 g->to_world[2][a] * g->to_world[2][a]);
        assert_int_equal(number(bytes, dim + (1 + (size_t)a) * step, whole), g->dims[a]);
        assert_true(fabs(number(bytes, (two ? 112 : 80) + (size_t)a * (two ? 8 : 4), real) -
                         length) < 1e-6 * length);
        for (int c = 0; c < 4; c++) {
            const double got = number(bytes, map + (4 * (size_t)a + c) * (two ? 8 : 4), real);
            assert_true(got == (two ? w[c] : (double)(float)w[c]));
        }
    }
    check_samples(g, bytes + (two ? 544 : 352));
}

static void test_nifti(void **state) {
    (void)state;
    grid g = small_grid();
    size_t size;
    char *bytes = write_grid("nifti", &g, false, "a.nii", &size);
    assert_int_equal(size, 544 + 120);
    check_nifti(bytes, &g, true);
    free(bytes);
    bytes = write_grid("nifti1", &g, false, "a.nii", &size);
    assert_int_equal(size, 352 + 120);
    check_nifti(bytes, &g, false);
    free(bytes);
    put_map(&g, upright);
    bytes = write_grid("nifti", &g, false, "a.nii", &size);
    check_nifti(bytes, &g, false);
    free(bytes);
    bytes = write_grid("nifti2", &g, false, "a.nii", &size);
    check_nifti(bytes, &g, true);
    free(bytes);
    g.dims[0] = 32768;
    assert_int_equal(format_of("nifti1")->check(&g), ST_UNSUPPORTED);
    assert_int_equal(format_of("nifti")->check(&g), ST_OK);
    g.dims[0] = 5;
    g.to_world[1][3] = 1e39;
    assert_int_equal(format_of("nifti1")->check(&g), ST_UNSUPPORTED);
}

static void test_packed(void **state) {
    (void)state;
    grid g = small_grid();
    size_t size;
    char *bytes = write_grid("nifti", &g, false, "a.nii", &size), *unpacked = malloc(size + 1);
    char *packed = write_grid("nifti", &g, true, "a.nii.gz", NULL);
    assert_memory_equal(packed, "\x1f\x8b\x08\0\0\0\0\0", 8); /* without a time */
    gzFile whole = gzopen(scratch_path("a.nii.gz"), "rb");
    assert_int_equal(gzread(whole, unpacked, (unsigned)size + 1), size);
    gzclose(whole);
    assert_memory_equal(bytes, unpacked, size);
    free(bytes);
    free(packed);
    free(unpacked);
}

/* Numbers of an attribute of XML. */
static void numbers(const char *text, const char *key, int count, double *out) {
    const char *at = strstr(text, key);
    assert_non_null(at);
    at += strlen(key);
    for (int i = 0; i < count; i++) {
        char *end;
        out[i] = strtod(at, &end);
        assert_ptr_not_equal(at, end);
        at = end;
    }
    assert_int_equal(*at, '"');
}

static const char *appended(const char *bytes) {
    const char *at = strstr(bytes, "<AppendedData encoding=\"raw\">\n_");
    assert_non_null(at);
    return at + strlen("<AppendedData encoding=\"raw\">\n_");
}

static void check_image(const double map[3][4], double worst) {
    grid g = small_grid();
    double origin[3], spacing[3], direction[9], extent[6];
    size_t size;
    put_map(&g, map);
    char *bytes = write_grid("vti", &g, false, "a.vti", &size);
    numbers(bytes, " WholeExtent=\"", 6, extent);
    numbers(bytes, " Origin=\"", 3, origin);
    numbers(bytes, " Spacing=\"", 3, spacing);
    numbers(bytes, " Direction=\"", 9, direction);
    for (int a = 0; a < 3; a++) {
        assert_true(origin[a] == map[a][3] && extent[2 * a] == 0);
        assert_true(extent[2 * a + 1] == g.dims[a] - 1 && spacing[a] > 0);
        for (int row = 0; row < 3; row++)
            assert_true(fabs(direction[3 * row + a] * spacing[a] - map[row][a]) <=
                        worst * spacing[a]);
    }
    assert_non_null(strstr(bytes, "Name=\"a &lt;&quot;small&quot;&gt; &amp; grid\""));
    assert_int_equal(number(appended(bytes), 0, 'l'), 120);
    check_samples(&g, appended(bytes) + 8);
    free(bytes);
}

static void test_vti(void **state) {
    (void)state;
    check_image(upright, 0);
    check_image(turned, 4e-16);
}

static void test_vtr(void **state) {
    (void)state;
    const double x[5] = {0.1, 0.5, 2, 3, 7}, z[3] = {5, 4, 1};
    grid g = small_grid();
    mem m;
    size_t size;
    mem_init(&m, 0);
    assert_int_equal(format_of("vtr")->check(&g), ST_UNSUPPORTED);
    put_map(&g, upright);
    assert_int_equal(grid_set_axis(&g, &m, "x", 0, x), ST_OK);
    assert_int_equal(grid_set_axis(&g, &m, "z", 2, z), ST_OK);
    assert_int_equal(format_of("vti")->check(&g), ST_UNSUPPORTED);
    assert_int_equal(format_of("nifti")->check(&g), ST_UNSUPPORTED);
    char *bytes = write_grid("vtr", &g, false, "a.vtr", &size);
    const char *at = appended(bytes);
    assert_int_equal(number(at, 0, 'l'), 40);
    for (size_t i = 0; i < 5; i++)
        assert_true(number(at, 8 + 8 * i, 'd') == 0.5 * x[i] - 7);
    for (size_t i = 0; i < 4; i++)
        assert_true(number(at, 56 + 8 * i, 'd') == -0.25 * (double)i + 3);
    for (size_t i = 0; i < 3; i++)
        assert_true(number(at, 96 + 8 * i, 'd') == 8 * z[i] + 1.0 / 1024);
    assert_int_equal(number(at, 120, 'l'), 120);
    check_samples(&g, at + 128);
    free(bytes);
    grid_release(&g, &m);
}

/* ---- TIFF ---- */

static uint64_t little(const char *bytes, size_t at, int size) {
    uint64_t value = 0;
    for (int i = size; i-- > 0;)
        value = value << 8 | (unsigned char)bytes[at + (size_t)i];
    return value;
}

/* The value of a tag of a page. */
static uint64_t tag_of(const char *bytes, uint64_t page, unsigned tag, bool big) {
    const size_t entry = big ? 20 : 12, head = big ? 8 : 2;
    const size_t count = little(bytes, page, big ? 8 : 2);
    unsigned before = 0;
    for (size_t i = 0; i < count; i++) {
        const size_t at = page + head + i * entry;
        const unsigned its = (unsigned)little(bytes, at, 2);
        assert_true(its > before); /* in order */
        before = its;
        if (its == tag)
            return little(bytes, at + (big ? 12 : 8), big ? 8 : 4);
    }
    fail_msg("no tag %u", tag);
    return 0;
}

static uint64_t next_page(const char *bytes, uint64_t page, bool big) {
    const size_t count = little(bytes, page, big ? 8 : 2);
    return little(bytes, page + (big ? 8 + 20 * count : 2 + 12 * count), big ? 8 : 4);
}

static void check_pages(const char *bytes, const grid *g, size_t head, bool big) {
    const uint64_t slice = grid_slice_bytes(g);
    uint64_t page = little(bytes, big ? 8 : 4, big ? 8 : 4);
    assert_memory_equal(bytes, big ? "II\x2b\0\x08\0\0" : "II\x2a", big ? 8 : 4);
    for (uint32_t z = 0; z < g->dims[2]; z++, page = next_page(bytes, page, big)) {
        assert_true(page > 0 && page % 2 == 0 && page < head);
        assert_int_equal(tag_of(bytes, page, 256, big), g->dims[0]);
        assert_int_equal(tag_of(bytes, page, 257, big), g->dims[1]);
        assert_int_equal(tag_of(bytes, page, 258, big), 8 * sample_size(g->type));
        assert_int_equal(tag_of(bytes, page, 259, big), 1);
        assert_int_equal(tag_of(bytes, page, 262, big), 1);
        assert_int_equal(tag_of(bytes, page, 273, big), head + z * slice);
        assert_int_equal(tag_of(bytes, page, 278, big), g->dims[1]);
        assert_int_equal(tag_of(bytes, page, 279, big), slice);
        assert_int_equal(tag_of(bytes, page, 339, big), g->type == SAMPLE_F32 ? 3 : 1);
    }
    assert_int_equal(page, 0);
}

static void test_tiff(void **state) {
    (void)state;
    grid g = small_grid();
    double map[12];
    size_t size;
    char *bytes = write_grid("tiff", &g, false, "a.tif", &size);
    const size_t head = size - 2 * grid_samples(&g);
    assert_int_equal(head % 64, 0);
    check_pages(bytes, &g, head, false);
    check_samples(&g, bytes + head);
    const char *text = bytes + tag_of(bytes, little(bytes, 4, 4), 270, false);
    assert_true(strlen(text) < head);
    assert_non_null(strstr(text, "Name=\"a &lt;&quot;small&quot;&gt; &amp; grid\""));
    const char *at = strstr(text, "<M K=\"to_world\">");
    assert_non_null(at);
    at += strlen("<M K=\"to_world\">");
    for (int i = 0; i < 12; i++) {
        char *end;
        map[i] = strtod(at, &end);
        at = end;
    }
    assert_memory_equal(at, "</M>", 4);
    assert_memory_equal(map, g.to_world, sizeof map);
    const uint64_t across = tag_of(bytes, little(bytes, 4, 4), 282, false);
    const double pixels = (double)little(bytes, across, 4) / (double)little(bytes, across + 4, 4);
    const double apart = sqrt(0.5 * 0.5 + 0.125 * 0.125 + 1);
    assert_true(fabs(pixels * apart - 1) < 1e-8);
    free(bytes);
}

/* The head alone of what is too large for 32 bits. */
static void test_big_tiff(void **state) {
    (void)state;
    const uint32_t sizes[2][3] = {{65536, 32768, 1}, {65536, 32768, 2}};
    for (int big = 0; big < 2; big++) {
        grid g;
        mem m;
        out_stream *out;
        size_t size;
        mem_init(&m, 0);
        grid_init(&g, sizes[big], SAMPLE_U8);
        assert_int_equal(out_stream_create(&m, scratch_path("b.tif"), true, false, &out), ST_OK);
        assert_int_equal(format_of("tiff")->head(&m, out, &g), ST_OK);
        assert_int_equal(out_stream_commit(out), ST_OK);
        assert_int_equal(mem_used(&m), 0);
        char *bytes = scratch_read(scratch_path("b.tif"), &size);
        check_pages(bytes, &g, size, big);
        free(bytes);
    }
}

/* One file a slice; nothing stays where one fails. */
static void test_slices(void **state) {
    (void)state;
    grid g = small_grid();
    const size_t slice = (size_t)g.dims[0] * g.dims[1], before = scratch_count();
    uint16_t *samples = few_samples(&g);
    char pattern[4096];
    mem m;
    mem_init(&m, 0);
    snprintf(pattern, sizeof pattern, "%s", scratch_path("slice%02d.tif"));
    slice_files *files;
    assert_int_equal(slice_files_create(&m, pattern, false, format_of("tiff"), &g, &files), ST_OK);
    assert_int_equal(slice_files_take(files, samples, slice), ST_OK);
    assert_int_equal(slice_files_take(files, samples + slice, 2 * slice), ST_OK);
    assert_int_equal(slice_files_end(files, ST_OK), ST_OK);
    assert_int_equal(scratch_count(), before + 3);
    grid one = g;
    one.dims[2] = 1;
    for (uint32_t z = 0; z < 3; z++) {
        char name[32];
        size_t size;
        snprintf(name, sizeof name, "slice%02u.tif", z);
        char *bytes = scratch_read(scratch_path(name), &size);
        const size_t head = size - 2 * slice;
        check_pages(bytes, &one, head, false);
        assert_memory_equal(bytes + head, samples + z * slice, 2 * slice);
        free(bytes);
        if (z != 1)
            remove(scratch_path(name));
    }
    /* slice01 is there already. */
    assert_int_equal(slice_files_create(&m, pattern, false, format_of("tiff"), &g, &files),
                     ST_EXISTS);
    assert_int_equal(slice_files_create(&m, pattern, true, format_of("tiff"), &g, &files), ST_OK);
    assert_int_equal(slice_files_take(files, samples, 2 * slice), ST_OK);
    fault_arm(FAULT_WRITE, 1);
    const status st = slice_files_take(files, samples, slice);
    fault_arm(FAULT_WRITE, 0);
    assert_int_not_equal(st, ST_OK);
    assert_int_equal(slice_files_end(files, st), st);
    assert_int_equal(scratch_count(), before);
    assert_int_equal(mem_used(&m), 0);
    free(samples);
}

/* A part lies in the world as that of its nodes in the whole. */
static void test_maps(void **state) {
    (void)state;
    mem m;
    leaf_file *f;
    grid_part part;
    grid g;
    leaf_case c = leaf_files_case(20, 21, 22, SAMPLE_U8);
    c.samples = leaf_files_random(&c, 3, 0);
    c.axis_file[1] =
        scratch_text("y.txt", "20 19 18 17.5 16 15 14 13 12 11 10 9 8 7 6 5 4 3 2 1 0");
    mem_init(&m, 0);
    for (int even = 0; even < 2; even++) {
        if (even)
            c.axis_file[1] = NULL;
        assert_int_equal(leaf_file_open(&m, leaf_files_make(&c, "maps.leaf"), &f), ST_OK);
        for (uint32_t level = 0; level < 2; level++) {
            const uint32_t box[6] = {3, 1, 2, 9, 2, 8}, fine = 1u << level;
            assert_int_equal(grid_part_of(f, level, box, &part), ST_OK);
            assert_int_equal(grid_part_describe(&m, f, &part, &g), ST_OK);
            const double x = g.axis[0] ? g.axis[0][1] : 1, y = g.axis[1] ? g.axis[1][1] : 1;
            assert_int_equal(g.axis[1] != NULL, !even);
            assert_true(g.to_world[0][0] * x + g.to_world[0][3] == 4 * fine);
            assert_true(g.to_world[1][1] * y + g.to_world[1][3] == (even    ? 2 * fine
                                                                    : level ? 16
                                                                            : 18));
            grid_release(&g, &m);
        }
        leaf_file_close(f);
    }
    assert_int_equal(mem_used(&m), 0);
    free((void *)(uintptr_t)c.samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),    cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_levels),   cmocka_unit_test(test_refused),
        cmocka_unit_test(test_nrrd),     cmocka_unit_test(test_nifti),
        cmocka_unit_test(test_packed),   cmocka_unit_test(test_vti),
        cmocka_unit_test(test_vtr),      cmocka_unit_test(test_tiff),
        cmocka_unit_test(test_big_tiff), cmocka_unit_test(test_slices),
        cmocka_unit_test(test_maps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
