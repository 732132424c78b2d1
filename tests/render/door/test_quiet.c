/* test_quiet.c - inputs that tell where they are one value: the same file as without that, byte for
 * byte, and what is quiet is not looked at; streams of tiles from importers.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/grid/nrrd.h"
#include "formats/grid/tile_stream.h"
#include "prep/grid/convert.h"
#include "tests/support/leaf_files.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* A volume in memory, of which few samples are not the quiet value. */
typedef struct sparse {
    leaf_case c;
    size_t width;
    uint8_t quiet[SLICE_SAMPLE_MAX];
    char *samples;
    uint32_t seed; /* which quiet tiles are called busy all the same */
    bool lies;     /* the memory of quiet tiles is filled with something else */
} sparse;

static char *slice_of(const sparse *s, uint32_t z) {
    return s->samples + (size_t)z * s->c.dims[0] * s->c.dims[1] * s->width;
}

static bool tile_is_quiet(const sparse *s, const char *slice, const slice_tile *t) {
    for (uint32_t y = t->y; y < t->end_y; y++)
        for (uint32_t x = t->x; x < t->end_x; x++)
            if (memcmp(slice + ((size_t)y * s->c.dims[0] + x) * s->width, s->quiet, s->width) != 0)
                return false;
    return true;
}

static void copy_tile(const sparse *s, const char *from, const slice_tile *t, char *to) {
    for (uint32_t y = t->y; y < t->end_y; y++) {
        const size_t at = ((size_t)y * s->c.dims[0] + t->x) * s->width;
        memcpy(to + at, from + at, (t->end_x - t->x) * s->width);
    }
}

static status read_tiles(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy) {
    sparse *s = ctx;
    const size_t tiles = slice_tiles_count(s->c.dims);
    for (uint32_t k = 0; k < count; k++)
        for (size_t i = 0; i < tiles; i++) {
            const slice_tile t = slice_tiles_at(s->c.dims, i);
            const char *from = slice_of(s, first + k);
            char *to = (char *)slices + k * (size_t)s->c.dims[0] * s->c.dims[1] * s->width;
            uint8_t *b = &busy[k * tiles + i];
            const bool was = *b;
            s->seed = s->seed * 1664525 + 1013904223;
            *b = !tile_is_quiet(s, from, &t) || (!s->lies && s->seed >> 24 < 10);
            if (*b || was)
                copy_tile(s, from, &t, to);
            else if (!s->lies)
                assert_true(tile_is_quiet(s, to, &t)); /* as the map has said */
            if (!*b && s->lies)
                slice_tiles_fill(s->c.dims, &t, s->width, "liar liar", to);
        }
    return ST_OK;
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    const sparse *s = ctx;
    memcpy(slices, slice_of(s, first), count * (size_t)s->c.dims[0] * s->c.dims[1] * s->width);
    return ST_OK;
}

static slice_source source_of(sparse *s, bool tiles, mem *m) {
    slice_source from = {.format = "test",
                         .name = "sparse",
                         .m = m,
                         .read = read_slices,
                         .read_tiles = tiles ? read_tiles : NULL,
                         .ctx = s};
    grid_init(&from.g, s->c.dims, s->c.type);
    memcpy(from.quiet, s->quiet, sizeof from.quiet);
    return from;
}

/* Balls of noise; where f32, with NaN and infinity among it. */
static sparse make(uint32_t nx, uint32_t ny, uint32_t nz, sample_type type, const void *quiet) {
    sparse s = {.c = leaf_files_case(nx, ny, nz, type), .width = sample_size(type), .seed = 1};
    memcpy(s.quiet, quiet, s.width);
    s.samples = leaf_files_random(&s.c, type, 20);
    for (uint32_t z = 0; z < nz; z++)
        for (uint32_t y = 0; y < ny; y++)
            for (uint32_t x = 0; x < nx; x++) {
                const int dx = (int)x - 20, dy = (int)y - 60, dz = (int)z - 18;
                const bool ball = dx * dx + dy * dy + dz * dz < 150;
                if (!ball && !(x > 190 && y > 40 && y < 44 && z > 100))
                    memcpy(slice_of(&s, z) + ((size_t)y * nx + x) * s.width, quiet, s.width);
            }
    return s;
}

static char *converted(sparse *s, bool tiles, size_t *size) {
    mem m;
    volume *v = NULL;
    convert_plan plan;
    convert_result result;
    mem_init(&m, (size_t)s->c.options.memory);
    slice_source from = source_of(s, tiles, &m);
    s->c.options.force = true;
    status st = volume_open_slices(&m, &from, NULL, &v);
    if (st == ST_OK)
        st = convert_plan_make(&m, volume_grid(v), &s->c.options, &plan);
    if (st == ST_OK)
        st = convert_run(&m, v, scratch_path("q.leaf"), &s->c.options, &plan, NULL, &result);
    volume_close(v);
    if (st != ST_OK)
        fail_msg("%s", status_text());
    assert_true(mem_peak(&m) <= plan.memory);
    assert_int_equal(mem_used(&m), 0);
    return scratch_read(scratch_path("q.leaf"), size);
}

static void check_same(sparse *s) {
    size_t size, size2;
    char *dense = converted(s, false, &size), *quick = converted(s, true, &size2);
    assert_int_equal(size, size2);
    assert_memory_equal(dense, quick, size);
    free(dense);
    free(quick);
}

static void test_same(void **state) {
    (void)state;
    static const float floats[] = {0, 1.5F, -3e38F, -0.0F, NAN, INFINITY, 1e-42F};
    static const uint8_t bytes[] = {0, 255};
    static const int16_t shorts[] = {0, -32768, 77};
    for (int way = 0; way < 12; way += WATCHED ? 5 : 1) {
        const int kind = way % 3;
        const sample_type type = kind == 0 ? SAMPLE_F32 : kind == 1 ? SAMPLE_U8 : SAMPLE_I16;
        const void *quiet = kind == 0   ? (const void *)&floats[way / 3]
                            : kind == 1 ? (const void *)&bytes[way / 3 % 2]
                                        : (const void *)&shorts[way / 3 % 3];
        sparse s = make(203 + (uint32_t)way, 95, 131, type, quiet);
        s.c.options.threads = 1 + way % 4;
        s.c.options.file.halo = way / 2 % 2;
        s.c.options.file.cells_log2 = 4 + way / 6;
        s.c.options.file.codec = way & 1 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
        check_same(&s);
        free(s.samples);
    }
    for (size_t i = 4; i < sizeof floats / sizeof *floats; i++) {
        sparse s = make(100, 95, 131, SAMPLE_F32, &floats[i]);
        check_same(&s);
        free(s.samples);
    }
}

/* Slabs of the finest levels go through scratch files, whose maps are not kept. */
static void test_spilled(void **state) {
    (void)state;
    const float quiet = 2;
    sparse s = make(203, 95, 131, SAMPLE_F32, &quiet);
    s.c.options.memory = leaf_files_least(&(leaf_case){.dims = {203, 95, 131},
                                                       .type = SAMPLE_F32,
                                                       .samples = s.samples,
                                                       .options = s.c.options}) +
                         20000;
    check_same(&s);
    free(s.samples);
}

/* What is said to be quiet is not looked at: a source that fills it with something else is
 * believed.
 */
static void test_left_out(void **state) {
    (void)state;
    const uint8_t quiet = 9;
    sparse s = make(203, 95, 131, SAMPLE_U8, &quiet);
    memset(s.samples, 9, (size_t)203 * 95 * 131);
    size_t size, size2;
    char *dense = converted(&s, false, &size);
    s.lies = true;
    char *quick = converted(&s, true, &size2);
    assert_int_equal(size, size2);
    assert_memory_equal(dense, quick, size);
    free(dense);
    free(quick);
    free(s.samples);
}

/* ---- streams ---- */

static const char *write_stream(sparse *s, mem *m) {
    const size_t bytes = (size_t)s->c.dims[0] * s->c.dims[1] * s->width;
    const size_t tiles = slice_tiles_count(s->c.dims);
    slice_source from = source_of(s, true, m);
    char *slice = malloc(bytes), *packed = malloc(bytes);
    uint8_t *busy = malloc(tiles);
    out_stream *out;
    assert_true(slice && packed && busy);
    memset(busy, 1, tiles);
    assert_int_equal(out_stream_create(m, scratch_path("t.tiles"), true, false, &out), ST_OK);
    assert_int_equal(tile_stream_begin(out, &from.g, s->quiet), ST_OK);
    for (uint32_t z = 0; z < s->c.dims[2]; z++) {
        assert_int_equal(read_tiles(s, z, 1, slice, busy), ST_OK);
        assert_int_equal(tile_stream_slice(out, &from.g, slice, busy, packed), ST_OK);
    }
    assert_int_equal(out_stream_commit(out), ST_OK);
    free(slice);
    free(packed);
    free(busy);
    return scratch_path("t.tiles");
}

static status open_stream(mem *m, const char *path, slice_source *out) {
    static const volume_hints none;
    volume_layout l = {.m = m};
    uint8_t quiet[SLICE_SAMPLE_MAX];
    bool known = false;
    status st = byte_stream_open_stored(m, path, &l.data);
    if (st == ST_OK)
        st = tile_stream_known(&l, &known, quiet);
    assert_true(st != ST_OK || known);
    if (st == ST_OK)
        st = nrrd_reader.layout(&l, &none);
    if (st == ST_OK)
        st = volume_layout_settle(&l, &none);
    if (st == ST_OK)
        st = tile_stream_open(&l, quiet, out);
    volume_layout_release(&l);
    return st;
}

/* All slices, by maps or without; the samples, or NULL and *st. */
static char *read_stream(const sparse *s, mem *m, const char *path, bool tiles, status *st) {
    const size_t bytes = (size_t)s->c.dims[0] * s->c.dims[1] * s->width;
    const size_t count = slice_tiles_count(s->c.dims);
    char *all = malloc(s->c.dims[2] * bytes), *slice = malloc(2 * bytes);
    uint8_t *busy = malloc(2 * count);
    uint64_t trailing = 0;
    slice_source from = {0};
    assert_true(all && slice && busy);
    memset(busy, 1, 2 * count);
    *st = open_stream(m, path, &from);
    for (uint32_t z = 0, n; z < s->c.dims[2] && *st == ST_OK; z += n) {
        n = s->c.dims[2] - z < 2 ? 1 : 2;
        *st =
            tiles ? from.read_tiles(from.ctx, z, n, slice, busy) : from.read(from.ctx, z, n, slice);
        memcpy(all + z * bytes, slice, n * bytes);
    }
    if (*st == ST_OK)
        *st = from.finish(from.ctx, &trailing);
    assert_int_equal(trailing, 0);
    slice_source_close(&from);
    free(slice);
    free(busy);
    if (*st == ST_OK)
        return all;
    free(all);
    return NULL;
}

static void test_stream(void **state) {
    (void)state;
    skip_under_thread();
    const float quiet = 2.5F;
    sparse s = make(203, 95, 131, SAMPLE_F32, &quiet);
    const size_t bytes = (size_t)203 * 95 * 131 * 4;
    mem m;
    size_t size;
    status st;
    mem_init(&m, 0);
    const char *path = write_stream(&s, &m);
    for (int tiles = 0; tiles < 2; tiles++) {
        char *all = read_stream(&s, &m, path, tiles, &st);
        assert_non_null(all);
        assert_memory_equal(all, s.samples, bytes);
        free(all);
    }
    char *stream = scratch_read(path, &size);
    assert_true(size < bytes / 10);
    for (size_t cut = 20; cut < size; cut += size / 37) {
        scratch_write("cut.tiles", stream, cut);
        assert_null(read_stream(&s, &m, scratch_path("cut.tiles"), cut & 1, &st));
        assert_int_equal(st, ST_CORRUPT);
    }
    free(stream);
    for (long k = 1, more = 1; more; k++) {
        fault_arm(FAULT_ALLOC, k);
        free(read_stream(&s, &m, path, true, &st));
        more = fault_fired(FAULT_ALLOC);
        fault_arm(FAULT_ALLOC, 0);
        assert_int_equal(st == ST_OK, !more);
    }
    assert_int_equal(mem_used(&m), 0);
    free(s.samples);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same),
        cmocka_unit_test(test_spilled),
        cmocka_unit_test(test_left_out),
        cmocka_unit_test(test_stream),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
