/* test_coarse_grids.c - the coarse grids in treelet files of meshes, of tets or of whole cells, and
 * of curvilinear grids: they are the cells resampled, the same bytes whatever the way; what is
 * wrong with them is found, in meshes of tets by both readers alike.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/hash.h"
#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_verify.h"
#include "prep/resample/coarse_grids.h"
#include "prep/resample/grid_cover.h"
#include "prep/resample/resample.h"
#include "tests/support/coarse_hexes.h"
#include "tests/support/coarse_subjects.h"
#include "tests/support/fields.h"
#include "tests/support/mesh_cases.h"
#include "tests/support/naive_leaf.h"
#include "tests/support/naive_mesh.h"
#include "tests/support/scratch.h"

static mem m;

static status try_convert(const mesh_case *c, const char *name) {
    mesh_result r;
    const status st = mesh_cases_convert(&m, c, name, 0, &r);
    m.limit = 0;
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static char *convert(const mesh_case *c, const char *name, size_t *size) {
    if (try_convert(c, name) != ST_OK)
        fail_msg("%s", status_text());
    return scratch_read(scratch_path(name), size);
}

static mesh_case small(uint32_t dims) {
    mesh_case c = mesh_cases_kuhn(5, 4, 3);
    mesh_cases_shuffle(&c, 23);
    c.options.treelet_tets = 100;
    c.options.coarse = true;
    c.options.coarse_dims = dims;
    return c;
}

/* ---- what it is ---- */

typedef struct samples {
    float *at;
    size_t count;
} samples;

static status take(void *ctx, const float *from, size_t count) {
    samples *s = ctx;
    memcpy(s->at + s->count, from, count * sizeof *from);
    s->count += count;
    return ST_OK;
}

/* Level 0 of the grid of a set, as the second reader has it, against the cells of the same file,
 * resampled. */
static void check_samples(leaf_file *f, uint32_t set, leaf_file *coarse, const char *part) {
    naive_leaf naive;
    if (!naive_leaf_load(&naive, scratch_path(part)))
        fail_msg("%s", naive.why);
    resample_grid g;
    for (int a = 0; a < 3; a++) {
        g.dims[a] = coarse->header.dims[a];
        g.spacing[a] = coarse->header.to_world[5 * a];
        g.origin[a] = coarse->header.to_world[4 * a + 3];
    }
    samples s = {.at = malloc((size_t)g.dims[0] * g.dims[1] * g.dims[2] * sizeof(float))};
    const resample_options o = {.set = set, .memory = 1 << 30, .threads = 1};
    resample_result r;
    assert_non_null(s.at);
    assert_int_equal(resample_run(&m, f, &g, &o, NULL, take, &s, &r), ST_OK);
    assert_int_equal(r.held, r.nodes);
    size_t at = 0;
    for (uint32_t z = 0; z < g.dims[2]; z++)
        for (uint32_t y = 0; y < g.dims[1]; y++)
            for (uint32_t x = 0; x < g.dims[0]; x++, at++)
                assert_true(naive_leaf_sample(&naive, 0, x, y, z) == s.at[at]);
    naive_leaf_release(&naive);
    free(s.at);
}

static void test_is_the_mesh_resampled(void **state) {
    (void)state;
    mesh_case c = small(41);
    size_t size;
    char *bytes = convert(&c, "coarse.leaf", &size);
    leaf_file *f = NULL, *coarse = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path("coarse.leaf"), &f), ST_OK);
    assert_true(leaf_file_has_coarse(f, 0));
    assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    const uint32_t dims[3] = {41, 33, 25};
    assert_memory_equal(coarse->header.dims, dims, sizeof dims);
    assert_int_equal(coarse->header.levels, 2);
    const leaf_part *part = &f->coarse[0];
    assert_int_equal(part->offset, f->payloads_end);
    assert_int_equal(part->offset + part->bytes, size);
    (void)scratch_write("part.leaf", bytes + part->offset, (size_t)part->bytes);
    check_samples(f, 0, coarse, "part.leaf");
    leaf_file_close(coarse);
    leaf_file_close(f);
    naive_mesh other;
    if (!naive_mesh_load(&other, scratch_path("coarse.leaf")))
        fail_msg("%s", other.why);
    naive_mesh_release(&other);
    free(bytes);
    mesh_cases_free(&c);
    assert_int_equal(mem_used(&m), 0);
}

static void test_same_bytes(void **state) {
    (void)state;
    mesh_case c = small(0);
    for (int codec = LEAF_CODEC_RAW; codec <= LEAF_CODEC_ZSTD; codec++) {
        c.options.file.codec = (leaf_codec)codec;
        c.options.file.zstd_level = 3;
        c.options.memory = 1 << 30;
        size_t size, other;
        char *want = convert(&c, "want.leaf", &size);
        for (int threads = 1; threads <= 4; threads += 3) {
            c.options.threads = threads;
            c.options.memory = threads == 1 ? 16 << 20 : 1 << 30;
            char *got = convert(&c, "other.leaf", &other);
            assert_int_equal(other, size);
            assert_memory_equal(got, want, size);
            free(got);
        }
        free(want);
    }
    mesh_cases_free(&c);
}

/* Without it nothing changes, and with it but the directory does. size: of the file without. */
static void check_payloads_stay(const char *with, const char *a, const char *without, const char *b,
                                size_t size) {
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path(without), &f), ST_OK);
    assert_false(leaf_file_has_coarse(f, 0));
    assert_int_equal(f->payloads_end, size);
    const uint64_t at = f->offsets[0];
    leaf_file_close(f);
    assert_int_equal(leaf_file_open(&m, scratch_path(with), &f), ST_OK);
    assert_memory_equal(a + f->offsets[0], b + at, size - at);
    leaf_file_close(f);
}

static void test_payloads_stay(void **state) {
    (void)state;
    mesh_case c = small(9);
    size_t with, without;
    char *a = convert(&c, "a.leaf", &with);
    c.options.coarse = false;
    char *b = convert(&c, "b.leaf", &without);
    assert_true(with > without);
    check_payloads_stay("a.leaf", a, "b.leaf", b, without);
    free(a);
    free(b);
    mesh_cases_free(&c);
}

/* ---- of hexahedra ---- */

static char *convert_hexes(const coarse_hexes *c, const char *name, size_t *size) {
    if (coarse_hexes_convert(&m, c, name) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(mem_used(&m), 0);
    return scratch_read(scratch_path(name), size);
}

/* Each set has a regular grid, of so many nodes if dims > 0, one behind the other, and after the
 * last the file ends. */
static void check_sets(const char *name, uint32_t sets, uint32_t dims) {
    size_t size;
    char *bytes = scratch_read(scratch_path(name), &size);
    leaf_file *f = NULL;
    assert_int_equal(leaf_file_open(&m, scratch_path(name), &f), ST_OK);
    assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
    assert_int_equal(f->layout.sets, sets);
    uint64_t end = f->payloads_end;
    for (uint32_t set = 0; set < sets; set++) {
        const leaf_part *part = &f->coarse[set];
        leaf_file *coarse = NULL;
        assert_true(leaf_file_has_coarse(f, set) && part->offset >= end);
        assert_int_equal(leaf_file_open_coarse(&m, f, set, &coarse), ST_OK);
        if (dims > 0)
            assert_int_equal(coarse->header.dims[0], dims);
        (void)scratch_write("part.leaf", bytes + part->offset, (size_t)part->bytes);
        check_samples(f, set, coarse, "part.leaf");
        end = part->offset + part->bytes;
        leaf_file_close(coarse);
    }
    assert_int_equal(end, size);
    leaf_file_close(f);
    free(bytes);
}

static void test_hexahedra_resampled(void **state) {
    (void)state;
    for (int whole = 0; whole < 2; whole++) {
        coarse_hexes c = coarse_hexes_of(whole, 8, 41);
        c.steps = 2;
        assert_int_equal(coarse_hexes_convert(&m, &c, "hexes.leaf"), ST_OK);
        check_sets("hexes.leaf", 2, 41);
    }
    /* By default about as many nodes as the cells have. */
    coarse_hexes c = coarse_hexes_of(true, 8, 0);
    leaf_file *f = NULL, *coarse = NULL;
    c.codec = LEAF_CODEC_ZSTD;
    assert_int_equal(coarse_hexes_convert(&m, &c, "hexes.leaf"), ST_OK);
    check_sets("hexes.leaf", 1, 0);
    assert_int_equal(leaf_file_open(&m, scratch_path("hexes.leaf"), &f), ST_OK);
    assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
    for (int a = 0; a < 3; a++)
        assert_in_range(coarse->header.dims[a], 8, 9);
    leaf_file_close(coarse);
    leaf_file_close(f);
}

/* ---- how many cells a grid shows ---- */

enum { COVER_CELLS = 8, COVER_NODES = 7 * 6 * 5 };

static bool is_covered(const resample_grid *g, const float *at, const double point[3]) {
    double low[3];
    for (int a = 0; a < 3; a++) {
        low[a] = floor((point[a] - g->origin[a]) / g->spacing[a]);
        if (low[a] < 0.0 || low[a] > g->dims[a] - 2.0)
            return false;
    }
    bool all = true;
    for (int c = 0; c < 8; c++) {
        const double node[3] = {low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2)};
        all = all && !isnan(at[(size_t)(node[0] + g->dims[0] * (node[1] + g->dims[1] * node[2]))]);
    }
    return all;
}

/* As many as of the lattice's own cells, by their corners. */
static uint64_t count_covered(const mesh_case *points, const resample_grid *g, const float *at) {
    enum { SIDE = COVER_CELLS + 1 };
    uint64_t covered = 0;
    for (size_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        double middle[3] = {0.0, 0.0, 0.0};
        if (n % SIDE == COVER_CELLS || n / SIDE % SIDE == COVER_CELLS ||
            n / SIDE / SIDE == COVER_CELLS)
            continue;
        for (size_t c = 0; c < 8; c++)
            for (int a = 0; a < 3; a++)
                middle[a] +=
                    (double)points
                        ->points[n + (c & 1) + SIDE * (c >> 1 & 1) + SIDE * SIDE * (c >> 2)][a] /
                    8;
        covered += is_covered(g, at, middle);
    }
    return covered;
}

static void test_cover(void **state) {
    (void)state;
    coarse_hexes h = coarse_hexes_of(false, COVER_CELLS, 0);
    const resample_grid g = {
        .dims = {7, 6, 5}, .origin = {-0.5, 1.1, 0.2}, .spacing = {1.5, 1.3, 1.8}};
    mesh_case points = mesh_cases_kuhn(COVER_CELLS, COVER_CELLS, COVER_CELLS);
    field_random r = {3};
    leaf_file *f = NULL;
    h.coarse = false;
    assert_int_equal(coarse_hexes_convert(&m, &h, "cover.leaf"), ST_OK);
    assert_int_equal(leaf_file_open(&m, scratch_path("cover.leaf"), &f), ST_OK);
    for (int k = 0; k < 20; k++) {
        float at[COVER_NODES];
        uint64_t cells, covered;
        grid_cover c;
        for (int n = 0; n < COVER_NODES; n++)
            at[n] = k > 0 && field_random_below(&r, 1 + 100 / k) == 0 ? NAN : 1.0F;
        assert_int_equal(grid_cover_init(&c, &m, &g), ST_OK);
        for (size_t n = 0, run = 1; n < COVER_NODES; n += run, run = run % 37 + 1)
            grid_cover_take(&c, at + n, run < COVER_NODES - n ? run : COVER_NODES - n);
        assert_int_equal(grid_cover_count(&c, f, 0, &cells, &covered), ST_OK);
        assert_int_equal(cells, COVER_CELLS * COVER_CELLS * COVER_CELLS);
        assert_int_equal(covered, count_covered(&points, &g, at));
        assert_true(covered < cells && (k > 0 || covered > cells / 4));
        grid_cover_release(&c);
    }
    leaf_file_close(f);
    mesh_cases_free(&points);
}

/* ---- in computational space ---- */

/* By default, with a regular grid of it inside; its nodes: test_curvilinear_thinned.c. */
static void test_thinned(void **state) {
    (void)state;
    for (uint32_t cells = 4; cells <= 40; cells += 12) {
        coarse_hexes c = coarse_hexes_of(false, cells, 0);
        leaf_file *f = NULL, *coarse = NULL;
        assert_int_equal(coarse_hexes_convert(&m, &c, "thin.leaf"), ST_OK);
        assert_int_equal(leaf_file_open(&m, scratch_path("thin.leaf"), &f), ST_OK);
        assert_int_equal(leaf_file_open_coarse(&m, f, 0, &coarse), ST_OK);
        assert_ptr_equal(coarse->geometry, f->geometry);
        assert_true(coarse->layout.treelets <= f->layout.treelets);
        assert_true(curvilinear_directory_of(coarse)->zones[0][0] == cells / 2 + 1);
        assert_int_equal(leaf_verify(&m, f, 2, NULL), ST_OK);
        leaf_file_close(coarse);
        leaf_file_close(f);
        coarse_subjects_take_part(&m, "thin.leaf", 0, "thinned.leaf");
        check_sets("thinned.leaf", 1, 0);
        assert_int_equal(mem_used(&m), 0);
    }
}

typedef struct reports {
    double last;
    int count, late; /* late: of what follows the cells' own conversion */
    bool falls;
} reports;

static void take_report(void *ctx, const char *stage, double fraction) {
    reports *r = ctx;
    (void)stage;
    r->count++;
    r->late += fraction > 0.9;
    r->falls = r->falls || fraction < r->last || fraction > 1.0;
    r->last = fraction;
}

/* Progress rises to the end, also while grids are made. */
static void test_progress(void **state) {
    (void)state;
    for (int of = 0; of < 3; of++) { /* 2: thinned */
        coarse_hexes c = coarse_hexes_of(of == 1, 8, of == 2 ? 0 : 20);
        reports r = {0.0, 0, 0, false};
        const progress p = {take_report, NULL, &r};
        c.threads = 1;
        c.steps = 3;
        c.progress = &p;
        assert_int_equal(coarse_hexes_convert(&m, &c, "told.leaf"), ST_OK);
        assert_false(r.falls);
        assert_true(r.count > r.late && r.late > 2 && r.last > 0.99);
    }
}

/* A grid that is far too large is refused before anything is written. */
static void test_too_large(void **state) {
    (void)state;
    for (int whole = 0; whole < 2; whole++) {
        const coarse_hexes c = coarse_hexes_of(whole, 4, 300);
        assert_int_equal(coarse_hexes_convert(&m, &c, "large.leaf"), ST_UNSUPPORTED);
        assert_non_null(strstr(status_text(), "300 x 300 x 300"));
        assert_int_not_equal(access(scratch_path("large.leaf"), F_OK), 0);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* The same bytes whatever the threads and the memory; without grids, all before them but the
 * directory. */
static void test_hexahedra_same_bytes(void **state) {
    (void)state;
    for (int of = 0; of < 3; of++) { /* 2: thinned */
        coarse_hexes c = coarse_hexes_of(of == 1, 8, of == 2 ? 0 : 20);
        size_t size, other;
        char *want = convert_hexes(&c, "want.leaf", &size);
        for (int threads = 1; threads <= 4; threads += 3) {
            c.threads = threads;
            c.memory = threads == 1 ? 16 << 20 : 1 << 30;
            char *got = convert_hexes(&c, "other.leaf", &other);
            assert_int_equal(other, size);
            assert_memory_equal(got, want, size);
            free(got);
        }
        c.coarse = false;
        char *without = convert_hexes(&c, "without.leaf", &other);
        check_payloads_stay("want.leaf", want, "without.leaf", without, other);
        free(without);
        free(want);
    }
}

/* ---- what is wrong with it ---- */

static status verify(const char *path) {
    leaf_file *f = NULL;
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = leaf_verify(&m, f, 1, NULL);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void check_refused(const char *bytes, size_t size, const char *what, size_t at) {
    const char *path = scratch_write("bad.leaf", bytes, size);
    const status st = verify(path);
    if (st != ST_CORRUPT && st != ST_UNSUPPORTED)
        fail_msg("%s %zu: status %d", what, at, st);
    naive_mesh other;
    if (naive_mesh_load(&other, path))
        fail_msg("%s %zu: the second reader sees nothing", what, at);
    naive_mesh_release(&other);
}

static void test_hexahedra_damage(void **state) {
    (void)state;
    for (int of = 0; of < 3; of++) { /* 2: thinned */
        const coarse_hexes c = coarse_hexes_of(of == 1, 4, of == 2 ? 0 : 7);
        size_t size;
        char *bytes = convert_hexes(&c, "made.leaf", &size);
        leaf_file *f = NULL;
        assert_int_equal(leaf_file_open(&m, scratch_path("made.leaf"), &f), ST_OK);
        const uint64_t start = f->coarse[0].offset;
        leaf_file_close(f);
        for (size_t at = (size_t)start; at < size; at += at % 997 ? 31 : 7) {
            bytes[at] ^= 4;
            assert_int_equal(verify(scratch_write("bad.leaf", bytes, size)), ST_CORRUPT);
            bytes[at] ^= 4;
        }
        for (size_t cut = size; cut > start; cut -= 1000)
            assert_int_equal(verify(scratch_write("bad.leaf", bytes, cut - 1)), ST_CORRUPT);
        free(bytes);
    }
}

/* Right checksums and id after a change to the directory. */
static void seal(char *bytes) {
    leaf_header *h = (leaf_header *)bytes;
    leaf_section *table = (leaf_section *)(bytes + leaf_table_at(h));
    for (uint32_t i = 0; i < h->sections; i++)
        table[i].checksum = hash_bytes(bytes + table[i].offset, (size_t)table[i].bytes);
    const hash_id id = leaf_header_id(h, table);
    h->id[0] = id.lo;
    h->id[1] = id.hi;
    h->checksum = leaf_header_checksum(h);
}

static leaf_part *part_of(char *bytes) {
    const leaf_header *h = (const leaf_header *)bytes;
    const leaf_section *table = (const leaf_section *)(bytes + leaf_table_at(h));
    for (uint32_t i = 0; i < h->sections; i++)
        if (table[i].kind == LEAF_SECTION_COARSE)
            return (leaf_part *)(bytes + table[i].offset);
    fail_msg("no section");
    return NULL;
}

static void test_damage(void **state) {
    (void)state;
    mesh_case c = small(7);
    size_t size;
    char *bytes = convert(&c, "made.leaf", &size);
    const leaf_part *part = part_of(bytes);
    for (size_t at = (size_t)part->offset; at < size; at += at % 997 ? 31 : 7) {
        bytes[at] ^= 4;
        check_refused(bytes, size, "byte", at);
        bytes[at] ^= 4;
    }
    for (size_t cut = size; cut > part->offset; cut -= 1000)
        check_refused(bytes, cut - 1, "cut at", cut - 1);
    free(bytes);
    mesh_cases_free(&c);
}

static void test_lies(void **state) {
    (void)state;
    mesh_case c = small(7);
    size_t size;
    char *bytes = convert(&c, "made.leaf", &size);
    leaf_part *part = part_of(bytes);
    const leaf_part sound = *part;
    const leaf_part lies[] = {
        {sound.offset - 4096, sound.bytes, {sound.id[0], sound.id[1]}},
        {sound.offset + 4096, sound.bytes - 4096, {sound.id[0], sound.id[1]}},
        {sound.offset, sound.bytes - 4096, {sound.id[0], sound.id[1]}},
        {sound.offset, sound.bytes + 4096, {sound.id[0], sound.id[1]}},
        {sound.offset, sound.bytes - 1, {sound.id[0], sound.id[1]}},
        {sound.offset, UINT64_MAX - 4095, {sound.id[0], sound.id[1]}},
        {sound.offset, 0, {sound.id[0], sound.id[1]}},
        {0, 0, {1, 0}},
        {0, 0, {0, 0}},
        {UINT64_MAX - 4095, sound.bytes, {sound.id[0], sound.id[1]}},
        {sound.offset, sound.bytes, {sound.id[0] ^ 1, sound.id[1]}},
        {0, size, {sound.id[0], sound.id[1]}},
    };
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        *part = lies[i];
        seal(bytes);
        check_refused(bytes, size, "lie", i);
    }
    *part = sound;
    seal(bytes);
    assert_int_equal(verify(scratch_write("good.leaf", bytes, size)), ST_OK);
    free(bytes);
    mesh_cases_free(&c);
}

static status try_kind(int kind) {
    if (kind == 3) {
        mesh_case c = small(5);
        c.options.threads = 1;
        const status st = try_convert(&c, "fault.leaf");
        mesh_cases_free(&c);
        return st;
    }
    coarse_hexes c = coarse_hexes_of(kind == 1, 4, kind == 2 ? 0 : 5); /* 2: thinned */
    c.threads = 1;
    const status st = coarse_hexes_convert(&m, &c, "fault.leaf");
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static void check_faults(int of, fault_kind kind) {
    const size_t before = scratch_count();
    bool fired = true;
    for (long k = 1; fired; k += 1 + k / 16) {
        fault_arm(kind, k);
        const status st = try_kind(of);
        fired = fault_fired(kind);
        fault_arm(kind, 0);
        if (st == ST_OK)
            assert_int_equal(unlink(scratch_path("fault.leaf")), 0);
        assert_int_equal(scratch_count(), before);
    }
}

/* Nothing but the file is left, and not even that after a failure. */
static void test_faults(void **state) {
    (void)state;
    (void)unlink(scratch_path("fault.leaf"));
    assert_int_equal(try_kind(1), ST_OK); /* its input stays */
    (void)unlink(scratch_path("fault.leaf"));
    for (int of = 0; of < 4; of++)
        for (fault_kind kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++)
            check_faults(of, kind);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_is_the_mesh_resampled),
        cmocka_unit_test(test_same_bytes),
        cmocka_unit_test(test_payloads_stay),
        cmocka_unit_test(test_hexahedra_resampled),
        cmocka_unit_test(test_cover),
        cmocka_unit_test(test_thinned),
        cmocka_unit_test(test_progress),
        cmocka_unit_test(test_too_large),
        cmocka_unit_test(test_hexahedra_same_bytes),
        cmocka_unit_test(test_hexahedra_damage),
        cmocka_unit_test(test_damage),
        cmocka_unit_test(test_lies),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
