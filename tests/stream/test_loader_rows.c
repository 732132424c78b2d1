/* test_loader_rows.c - the order in which treelets are read whose samples lie in chunks of other
 * files that each meet many treelets: row after row, so that a chunk is unpacked few times although
 * there is room for few.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>

#include "formats/grid/chunk_array.h"
#include "formats/leaf/leaf_unpacker.h"
#include "stream/loader.h"
#include "tests/support/fields.h"
#include "tests/support/leaf_files.h"
#include "tests/support/scratch.h"

/* Slices, of which each is one chunk: two layers of treelets need less than all, and more than
 * there is room for. */
enum { SIDE = 129, NZ = 81, SLICE = SIDE * SIDE, ROOM = 30 * SLICE };

typedef struct stage {
    mem m, chunks;
    leaf_file *f;
    loader *l;
} stage;

/* chunk: numbers along x and y of a chunk of one slice. */
static void stage_open(stage *s, uint32_t chunk) {
    static chunk_entry table[NZ];
    leaf_case c = leaf_files_case(SIDE, SIDE, NZ, SAMPLE_U8);
    const chunk_array array = {.axes = 3,
                               .chunk = {1, chunk, chunk},
                               .role = {ORDER_Z, ORDER_Y, ORDER_X},
                               .type = SAMPLE_U8,
                               .codec = ZARR_RAW,
                               .separator = '.'};
    void *samples = leaf_files_random(&c, FIELD_SEED, 0);
    const char *input = scratch_write("all.bin", samples, (size_t)SLICE * NZ);
    for (uint32_t z = 0; z < NZ; z++)
        table[z] = (chunk_entry){(uint64_t)z * SLICE, SLICE, 0};
    const sample_place at = {.path = input,
                             .stored = {.type = SAMPLE_U8},
                             .chunks = &array,
                             .table = table,
                             .table_count = NZ};
    c.samples = samples;
    c.in_place = true;
    c.place = chunk == SIDE ? &at : NULL;
    const char *path = leaf_files_make(&c, "rows.leaf");
    free(samples);
    /* Room for the directory, and four times that for chunks, of which a quarter is taken. */
    mem_init(&s->chunks, 0);
    assert_int_equal(leaf_file_open(&s->chunks, path, &s->f), ST_OK);
    const size_t directory = mem_used(&s->chunks);
    leaf_file_close(s->f);
    mem_init(&s->chunks, directory + 4 * ROOM);
    assert_int_equal(leaf_file_open(&s->chunks, path, &s->f), ST_OK);
    mem_init(&s->m, 0);
    const loader_options options = {.source = SOURCE_ARENA, .workers = 2, .isa = CPU_SCALAR};
    assert_int_equal(loader_create(&s->m, s->f, &options, NULL, &s->l), ST_OK);
    loader_set_capacity(s->l, s->f->layout.treelets, 0);
}

static void stage_close(stage *s) {
    loader_destroy(s->l);
    leaf_file_close(s->f);
    assert_int_equal(mem_used(&s->m) + mem_used(&s->chunks), 0);
}

/* Ask for all treelets of level 0, each with the priority that `order` gives, and have them read.
 * Returns the bytes. */
static uint64_t read_all(stage *s, uint64_t (*order)(uint32_t i)) {
    const leaf_level *level = &s->f->layout.level[0];
    loader_request *all = malloc(level->count * sizeof *all);
    assert_non_null(all);
    for (uint32_t i = 0; i < level->count; i++)
        all[i] = (loader_request){level->first + i, order(i)};
    loader_reset_statistics(s->l);
    loader_want(s->l, all, level->count);
    assert_int_equal(loader_settle(s->l), ST_OK);
    free(all);
    const loader_stats stats = loader_statistics(s->l);
    assert_int_equal(stats.loads, level->count);
    return stats.bytes_read;
}

static uint64_t scattered(uint32_t i) {
    return i * UINT64_C(0x9E3779B97F4A7C15) >> 40;
}

/* Slices at the border of two layers are needed by both: 18 of 16 each, and two more are on their
 * way. In the order of the priorities it would be nearly all slices of a layer for each treelet. */
static void test_rows(void **state) {
    stage s;
    (void)state;
    stage_open(&s, SIDE);
    assert_int_equal(leaf_file_rows(s.f), 8 * 5);
    const uint64_t read = read_all(&s, scattered), all = (uint64_t)NZ * SLICE;
    assert_true(read >= all && read <= 2 * all);
    stage_close(&s);
}

/* Of samples in one piece any order is as good. */
static void test_piece(void **state) {
    stage s;
    (void)state;
    stage_open(&s, 0);
    assert_int_equal(leaf_file_rows(s.f), 0);
    (void)read_all(&s, scattered);
    stage_close(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_rows), cmocka_unit_test(test_piece)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
