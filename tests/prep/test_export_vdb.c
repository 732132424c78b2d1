/* test_export_vdb.c - OpenVDB files as a naive reader of the format understands them: every voxel,
 * what is active and what is not, tiles, several grids; within any budget; what cannot be held.
 */
/* marks: threads, bits, long */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "prep/export/vdb_writer.h"
#include "tests/support/leaf_files.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

/* ---- a naive reader ---- */

enum { UPPER = 4096, NODE = 128, LEAF = 8, LEAVES_MAX = 100000 };

typedef struct reader {
    const unsigned char *bytes;
    size_t size, at;
} reader;

typedef struct vdb_leaf {
    long origin[3];
    unsigned char mask[64];
} vdb_leaf;

/* A grid, of voxels within dims; all outside must be inactive. */
typedef struct vdb_grid {
    uint64_t offsets[3];
    char name[80], type[80], narrow[80];
    double map[16];
    uint32_t background;
    const uint32_t *dims;
    uint32_t *bits;
    unsigned char *active;
    vdb_leaf *leaves;
    size_t leaf_count, tiles, roots;
} vdb_grid;

static void take(reader *r, void *to, size_t size) {
    assert_true(r->size - r->at >= size);
    memcpy(to, r->bytes + r->at, size);
    r->at += size;
}

static uint32_t take_u32(reader *r) {
    unsigned char b[4];
    take(r, b, 4);
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static uint64_t take_u64(reader *r) {
    const uint64_t low = take_u32(r);
    return low | (uint64_t)take_u32(r) << 32;
}

static void take_string(reader *r, char text[80]) {
    const uint32_t size = take_u32(r);
    assert_true(size < 80);
    take(r, text, size);
    text[size] = 0;
}

static bool bit(const unsigned char *mask, size_t i) {
    return mask[i / 8] >> i % 8 & 1;
}

static void set_voxel(vdb_grid *g, const long at[3], uint32_t bits) {
    for (int a = 0; a < 3; a++)
        assert_true(at[a] >= 0 && at[a] < (long)g->dims[a]);
    const size_t i = ((size_t)at[2] * g->dims[1] + (size_t)at[1]) * g->dims[0] + (size_t)at[0];
    assert_false(g->active[i]);
    g->active[i] = 1;
    g->bits[i] = bits;
}

static void fill_tile(vdb_grid *g, const long origin[3], long side, uint32_t bits) {
    g->tiles++;
    for (long z = 0; z < side; z++)
        for (long y = 0; y < side; y++)
            for (long x = 0; x < side; x++)
                set_voxel(g, (const long[3]){origin[0] + x, origin[1] + y, origin[2] + z}, bits);
}

static void read_node(reader *r, vdb_grid *g, const long origin[3], long side) {
    const long part = side == UPPER ? NODE : LEAF, n = side / part;
    const size_t slots = (size_t)(n * n * n);
    unsigned char *children = malloc(slots / 8), *tiles = malloc(slots / 8), form;
    assert_true(children && tiles);
    take(r, children, slots / 8);
    take(r, tiles, slots / 8);
    take(r, &form, 1);
    assert_int_equal(form, 0); /* what is inactive is the background */
    for (int way = 0; way < 2; way++)
        for (size_t i = 0; i < slots; i++) {
            const long at[3] = {origin[0] + (long)i / n / n * part,
                                origin[1] + (long)i / n % n * part, origin[2] + (long)i % n * part};
            assert_false(bit(children, i) && bit(tiles, i));
            if (way == 0 && bit(tiles, i))
                fill_tile(g, at, part, take_u32(r));
            if (way == 0 || !bit(children, i))
                continue;
            if (part == NODE) {
                read_node(r, g, at, NODE);
                continue;
            }
            assert_true(g->leaf_count < LEAVES_MAX);
            vdb_leaf *l = &g->leaves[g->leaf_count++];
            memcpy(l->origin, at, sizeof l->origin);
            take(r, l->mask, sizeof l->mask);
        }
    free(children);
    free(tiles);
}

static void read_leaf(reader *r, vdb_grid *g, const vdb_leaf *l) {
    unsigned char mask[64], form;
    take(r, mask, sizeof mask);
    take(r, &form, 1);
    assert_memory_equal(mask, l->mask, sizeof mask);
    assert_int_equal(form, 0);
    for (long i = 0; i < 512; i++)
        if (bit(mask, (size_t)i))
            set_voxel(g,
                      (const long[3]){l->origin[0] + i / 64, l->origin[1] + i / 8 % 8,
                                      l->origin[2] + i % 8},
                      take_u32(r));
}

static void read_tree(reader *r, vdb_grid *g) {
    assert_int_equal(take_u32(r), 1);
    g->background = take_u32(r);
    assert_int_equal(take_u32(r), 0);
    g->roots = take_u32(r);
    for (size_t i = 0; i < g->roots; i++) {
        long origin[3];
        for (int a = 0; a < 3; a++)
            origin[a] = (int32_t)take_u32(r);
        read_node(r, g, origin, UPPER);
    }
    if (g->offsets[1])
        assert_int_equal(r->at, g->offsets[1]);
    for (size_t i = 0; i < g->leaf_count; i++)
        read_leaf(r, g, &g->leaves[i]);
}

static void read_grid(reader *r, vdb_grid *g) {
    char key[80], type[80], value[80];
    take_string(r, g->name);
    take_string(r, g->type);
    take_string(r, value);
    assert_string_equal(value, "");
    for (int i = 0; i < 3; i++)
        g->offsets[i] = take_u64(r);
    if (g->offsets[0])
        assert_int_equal(r->at, g->offsets[0]);
    assert_int_equal(take_u32(r), 2);
    for (uint32_t left = take_u32(r); left > 0; left--) {
        take_string(r, key);
        take_string(r, type);
        take_string(r, value);
        assert_string_equal(type, "string");
        if (strcmp(key, "leafcast_type") == 0)
            strcpy(g->narrow, value);
    }
    take_string(r, value);
    assert_string_equal(value, "AffineMap");
    for (int i = 0; i < 16; i++) {
        const uint64_t bits = take_u64(r);
        memcpy(&g->map[i], &bits, sizeof bits);
    }
    read_tree(r, g);
    if (g->offsets[2])
        assert_int_equal(r->at, g->offsets[2]);
}

static reader begin(const char *path, size_t *grids, char **bytes) {
    reader r = {0};
    char key[80], uuid[36], flag;
    *bytes = scratch_read(path, &r.size);
    r.bytes = (const unsigned char *)*bytes;
    assert_true(take_u64(&r) == 0x56444220);
    assert_int_equal(take_u32(&r), 224);
    take_u64(&r);
    take(&r, &flag, 1);
    assert_int_equal(flag, 1);
    take(&r, uuid, sizeof uuid);
    for (int i = 0; i < 36; i++)
        assert_int_equal(uuid[i] == '-', i == 8 || i == 13 || i == 18 || i == 23);
    for (uint32_t left = 3 * take_u32(&r); left > 0; left--)
        take_string(&r, key);
    *grids = take_u32(&r);
    return r;
}

static vdb_grid new_grid(const uint32_t *dims) {
    const size_t count = (size_t)dims[0] * dims[1] * dims[2];
    vdb_grid g = {.dims = dims,
                  .bits = malloc(count * sizeof *g.bits),
                  .active = calloc(count, 1),
                  .leaves = malloc(LEAVES_MAX * sizeof *g.leaves)};
    assert_true(g.bits && g.active && g.leaves);
    return g;
}

static void free_grid(vdb_grid *g) {
    free(g->bits);
    free(g->active);
    free(g->leaves);
}

/* ---- cases ---- */

static status try_export(const char *path, const char *out, const uint32_t *box, int threads,
                         size_t memory) {
    mem m;
    leaf_file *f = NULL;
    grid_part part;
    grid g = {.dims = {0}};
    const uint32_t set = 0;
    const char *name = "values";
    mem_init(&m, 0);
    status st = leaf_file_open(&m, path, &f);
    if (st == ST_OK)
        st = grid_part_of(f, 0, box, &part);
    if (st == ST_OK)
        st = grid_part_describe(&m, f, &part, &g);
    if (st == ST_OK)
        st = vdb_writer_check(&g);
    if (st == ST_OK) {
        const sample_export e = {.f = f,
                                 .part = &part,
                                 .sets = &set,
                                 .names = &name,
                                 .count = 1,
                                 .path = out,
                                 .force = true,
                                 .threads = threads};
        m.limit = memory ? mem_used(&m) + memory : 0;
        st = vdb_writer_run(&m, &e);
        m.limit = 0;
    }
    grid_release(&g, &m);
    leaf_file_close(f);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static uint32_t bits_of(const leaf_case *c, size_t i) {
    float f;
    int32_t v = 0;
    uint32_t bits;
    switch (c->type) {
    case SAMPLE_U8: v = ((const uint8_t *)c->samples)[i]; break;
    case SAMPLE_I8: v = ((const int8_t *)c->samples)[i]; break;
    case SAMPLE_U16: v = ((const uint16_t *)c->samples)[i]; break;
    case SAMPLE_I16: v = ((const int16_t *)c->samples)[i]; break;
    default:
        f = ((const float *)c->samples)[i];
        memcpy(&bits, &f, sizeof bits);
        return bits;
    }
    return (uint32_t)v;
}

/* All voxels of a box are the input's: active where they differ from the background, and at the
 * box's first and last corner. */
static void check_voxels(const vdb_grid *g, const leaf_case *c, const uint32_t box[6]) {
    size_t i = 0;
    for (uint32_t z = 0; z < c->dims[2]; z++)
        for (uint32_t y = 0; y < c->dims[1]; y++)
            for (uint32_t x = 0; x < c->dims[0]; x++, i++) {
                const uint32_t at[3] = {x, y, z};
                const bool in = x >= box[0] && y >= box[1] && z >= box[2] && x <= box[3] &&
                                y <= box[4] && z <= box[5];
                const bool corner =
                    memcmp(at, box, sizeof at) == 0 || memcmp(at, box + 3, sizeof at) == 0;
                const uint32_t want = bits_of(c, i);
                if (g->active[i] != (in && (want != g->background || corner)) ||
                    (g->active[i] && g->bits[i] != want))
                    fail_msg("voxel %u %u %u: %s %08x, not %08x", x, y, z,
                             g->active[i] ? "active" : "inactive", g->bits[i], want);
            }
}

static vdb_grid check_file(const char *path, const leaf_case *c, const uint32_t box[6]) {
    size_t grids;
    char *bytes;
    vdb_grid g = new_grid(c->dims);
    reader r = begin(path, &grids, &bytes);
    assert_int_equal(grids, 1);
    read_grid(&r, &g);
    assert_int_equal(r.at, r.size);
    assert_string_equal(g.name, "values");
    assert_string_equal(g.type, c->type == SAMPLE_F32 ? "Tree_float_5_4_3" : "Tree_int32_5_4_3");
    assert_string_equal(g.narrow, c->type == SAMPLE_F32 ? "" : sample_name(c->type));
    check_voxels(&g, c, box);
    free(bytes);
    return g;
}

/* Noise in one corner, a block of a value, the rest another one. */
static leaf_case blocks(uint32_t nx, uint32_t ny, uint32_t nz, sample_type type) {
    leaf_case c = leaf_files_case(nx, ny, nz, type);
    const size_t width = sample_size(type), count = (size_t)nx * ny * nz;
    char *samples = leaf_files_random(&c, type, 0), two[2][4];
    memcpy(two[0], samples, width);
    memcpy(two[1], samples + width, width);
    assert_memory_not_equal(two[0], two[1], width);
    for (size_t i = 0; i < count; i++) {
        const size_t x = i % nx, y = i / nx % ny, z = i / nx / ny;
        if (x > 30 || y > 50 || z > 40)
            memcpy(samples + i * width, two[x >= 128 && y >= 7 && z >= 9], width);
    }
    c.samples = samples;
    return c;
}

static void test_types(void **state) {
    (void)state;
    skip_under_thread();
    static const uint32_t boxes[][6] = {{0, 0, 0, 69, 52, 44},
                                        {3, 5, 7, 69, 51, 17},
                                        {16, 16, 16, 31, 31, 31},
                                        {69, 52, 44, 69, 52, 44}};
    for (int type = SAMPLE_U8; type <= SAMPLE_F32; type++)
        for (size_t b = 0; b < sizeof boxes / sizeof *boxes; b++) {
            if (type > SAMPLE_I16 && type != SAMPLE_F32)
                continue;
            leaf_case c = blocks(70, 53, 45, (sample_type)type);
            c.options.file.codec = b & 1 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW;
            c.options.file.halo = b > 1;
            const char *path = leaf_files_make(&c, "types.leaf");
            if (try_export(path, scratch_path("x.vdb"), boxes[b], 2, 0) != ST_OK)
                fail_msg("%s", status_text());
            vdb_grid g = check_file(scratch_path("x.vdb"), &c, boxes[b]);
            free_grid(&g);
            free((void *)(uintptr_t)c.samples);
        }
}

/* Whole treelets and nodes of one value: the background costs nothing, others are tiles. */
static void test_tiles(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = blocks(290, 150, 140, SAMPLE_U8);
    const uint32_t all[6] = {0, 0, 0, 289, 149, 139};
    const char *path = leaf_files_make(&c, "tiles.leaf");
    assert_int_equal(try_export(path, scratch_path("x.vdb"), NULL, 3, 0), ST_OK);
    vdb_grid g = check_file(scratch_path("x.vdb"), &c, all);
    assert_true(g.tiles > 1000);
    assert_true(g.leaf_count < 5000); /* of 37 x 19 x 18 */
    free_grid(&g);
    /* One value alone: what is active are two corners. */
    memset((void *)(uintptr_t)c.samples, 7, (size_t)290 * 150 * 140);
    path = leaf_files_make(&c, "tiles.leaf");
    assert_int_equal(try_export(path, scratch_path("x.vdb"), NULL, 3, 0), ST_OK);
    g = check_file(scratch_path("x.vdb"), &c, all);
    assert_int_equal(g.background, 7);
    assert_int_equal(g.tiles, 0);
    assert_int_equal(g.leaf_count, 2);
    free_grid(&g);
    free((void *)(uintptr_t)c.samples);
}

/* A whole node of 128^3 is a tile where the directory tells it; several nodes of 4096^3. */
static void test_far(void **state) {
    (void)state;
    if (SLOW) /* whole nodes are skipped by their ranges, of any values */
        skip();
    leaf_case c = leaf_files_case(4600, 140, 129, SAMPLE_U8);
    const uint32_t all[6] = {0, 0, 0, 4599, 139, 128};
    const size_t count = (size_t)4600 * 140 * 129;
    uint8_t *samples = malloc(count);
    assert_non_null(samples);
    for (size_t i = 0; i < count; i++)
        samples[i] = i % 4600 < 300 ? 9 : 0;
    samples[4100] = 1;
    c.samples = samples;
    const char *path = leaf_files_make(&c, "far.leaf");
    assert_int_equal(try_export(path, scratch_path("x.vdb"), NULL, 2, 0), ST_OK);
    vdb_grid g = check_file(scratch_path("x.vdb"), &c, all);
    assert_int_equal(g.roots, 2);
    assert_int_equal(g.background, 0);
    free_grid(&g);
    size_t size;
    free(scratch_read(scratch_path("x.vdb"), &size));
    assert_true(size < 12000000); /* of tiles of 128^3 none has leaves */
    free(samples);
}

/* The same bytes for any number of threads and any budget from the least on. */
static void test_budgets(void **state) {
    (void)state;
    leaf_case c = blocks(WATCHED_THREADS ? 150 : 290, 150, 140, SAMPLE_U16);
    const char *path = leaf_files_make(&c, "budget.leaf");
    size_t least = 1 << 20, size, size2;
    while (try_export(path, scratch_path("x.vdb"), NULL, 4, least) == ST_NOMEM) {
        assert_non_null(strstr(status_text(), "memory"));
        least += 1 << 20;
    }
    assert_true(least < (size_t)20 << 20);
    char *one = scratch_read(scratch_path("x.vdb"), &size);
    for (int threads = 1; threads < 5; threads += 3)
        for (size_t memory = 0; memory <= 3 * least; memory += 3 * least) {
            assert_int_equal(try_export(path, scratch_path("y.vdb"), NULL, threads, memory), ST_OK);
            char *other = scratch_read(scratch_path("y.vdb"), &size2);
            assert_int_equal(size, size2);
            assert_memory_equal(one, other, size);
            free(other);
        }
    free(one);
    free((void *)(uintptr_t)c.samples);
}

/* A fault is an error that leaves no file, or it has no consequence (fsync of the folder). */
static void test_faults(void **state) {
    (void)state;
    skip_under_thread();
    leaf_case c = blocks(70, 53, 45, SAMPLE_U16);
    const char *path = leaf_files_make(&c, "faults.leaf");
    size_t size, size2, failed = 0;
    assert_int_equal(try_export(path, scratch_path("x.vdb"), NULL, 1, 0), ST_OK);
    char *whole = scratch_read(scratch_path("x.vdb"), &size);
    const size_t files = scratch_count();
    for (int kind = FAULT_ALLOC; kind <= FAULT_WRITE; kind++)
        for (long k = 1, more = 1; more; k += 1 + (SLOW ? k / 8 : 0)) {
            remove(scratch_path("x.vdb"));
            fault_arm((fault_kind)kind, k);
            const status st = try_export(path, scratch_path("x.vdb"), NULL, 1, 0);
            more = fault_fired((fault_kind)kind);
            fault_arm((fault_kind)kind, 0);
            assert_int_equal(scratch_count(), files - (st != ST_OK));
            failed += st != ST_OK;
            assert_true(st == ST_OK || more);
            if (st != ST_OK)
                continue;
            char *bytes = scratch_read(scratch_path("x.vdb"), &size2);
            assert_int_equal(size, size2);
            assert_memory_equal(whole, bytes, size);
            free(bytes);
        }
    assert_true(failed > (SLOW ? 20 : 50));
    free(whole);
    free((void *)(uintptr_t)c.samples);
}

static void test_refused(void **state) {
    (void)state;
    const uint32_t dims[3] = {4, 4, 4};
    const double x[4] = {0, 1, 3, 4};
    grid g;
    mem m;
    mem_init(&m, 0);
    grid_init(&g, dims, SAMPLE_U8);
    assert_int_equal(vdb_writer_check(&g), ST_OK);
    for (int a = 0; a < 3; a++)
        g.to_world[a][a] = 1e-5;
    assert_int_equal(vdb_writer_check(&g), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "singular"));
    g.to_world[0][0] = 10;
    assert_int_equal(vdb_writer_check(&g), ST_OK);
    assert_int_equal(grid_set_axis(&g, &m, "x", 0, x), ST_OK);
    assert_int_equal(vdb_writer_check(&g), ST_UNSUPPORTED);
    grid_release(&g, &m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_types),  cmocka_unit_test(test_tiles),
        cmocka_unit_test(test_far),    cmocka_unit_test(test_budgets),
        cmocka_unit_test(test_faults), cmocka_unit_test(test_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
