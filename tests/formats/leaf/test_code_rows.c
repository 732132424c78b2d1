/* test_code_rows.c - ranges of blocks and their codes: what a search block by block finds, from
 * each ISA, for treelets of any size, without a look beside their samples.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/code_rows.h"
#include "formats/leaf/leaf.h"
#include "tests/support/fields.h"

enum {
    BLOCK = 1 << LEAF_BLOCK_LOG2,
    CELLS_MAX = 1 << LEAF_CELLS_LOG2_MAX,
    BLOCKS_MAX = 1 << 3 * (LEAF_CELLS_LOG2_MAX - LEAF_BLOCK_LOG2)
};

static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
enum { TYPES = sizeof types / sizeof *types };

/* Ranges and codes of a treelet's blocks, in Morton order. */
typedef struct found {
    float lo[BLOCKS_MAX], hi[BLOCKS_MAX], whole[2];
    uint8_t codes[2][BLOCKS_MAX];
    bool non_finite;
} found;

/* ---- block by block ---- */

static uint32_t morton(const uint32_t at[3]) {
    uint32_t m = 0;
    for (uint32_t bit = 0; bit < 4; bit++)
        for (uint32_t a = 0; a < 3; a++)
            m |= (at[a] >> bit & 1) << (3 * bit + a);
    return m;
}

static void begin(found *f) {
    memset(f, 0, sizeof *f);
    for (uint32_t m = 0; m < BLOCKS_MAX; m++) {
        f->lo[m] = INFINITY;
        f->hi[m] = -INFINITY;
    }
    f->whole[0] = INFINITY;
    f->whole[1] = -INFINITY;
}

static void take(found *f, uint32_t m, float v) {
    f->non_finite |= !isfinite(v);
    if (!isfinite(v))
        return;
    f->lo[m] = fminf(v, f->lo[m]);
    f->hi[m] = fmaxf(v, f->hi[m]);
    f->whole[0] = fminf(v, f->whole[0]);
    f->whole[1] = fmaxf(v, f->whole[1]);
}

/* Look at all nodes of a block. */
static void search_block(const code_samples *s, sample_type type, const uint32_t block[3],
                         found *f) {
    uint32_t first[3], last[3];
    for (int a = 0; a < 3; a++) {
        first[a] = block[a] * BLOCK;
        last[a] = first[a] + BLOCK < s->cells[a] ? first[a] + BLOCK : s->cells[a];
    }
    for (uint32_t z = first[2]; z <= last[2]; z++)
        for (uint32_t y = first[1]; y <= last[1]; y++)
            for (uint32_t x = first[0]; x <= last[0]; x++)
                take(f, morton(block), sample_get(type, s->first, x + y * s->row + z * s->slice));
}

static void search(const code_samples *s, sample_type type, uint32_t count, found *f) {
    uint32_t b[3];
    begin(f);
    for (b[2] = 0; b[2] * BLOCK < s->cells[2]; b[2]++)
        for (b[1] = 0; b[1] * BLOCK < s->cells[1]; b[1]++)
            for (b[0] = 0; b[0] * BLOCK < s->cells[0]; b[0]++)
                search_block(s, type, b, f);
    const quantizer q = quantizer_of(f->whole[0], f->whole[1], type);
    for (uint32_t m = 0; m < count; m++) {
        const bool empty = f->lo[m] > f->hi[m];
        f->codes[0][m] = empty ? 255 : quantizer_floor(&q, (double)f->lo[m]);
        f->codes[1][m] = empty ? 0 : quantizer_ceil(&q, (double)f->hi[m]);
    }
}

/* ---- by the loops of an ISA ---- */

static void run(const code_samples *s, sample_type type, cpu_isa isa, uint32_t count, found *f) {
    const code_rows *rows = code_rows_for(isa, type);
    begin(f);
    f->non_finite = rows->ranges(s, f->lo, f->hi);
    rows->whole(f->lo, f->hi, count, f->whole);
    const quantizer q = quantizer_of(f->whole[0], f->whole[1], type);
    rows->encode(&q, f->lo, f->hi, count, f->codes[0], f->codes[1]);
}

/* Values, as a zero may have either sign. */
static bool same_values(const float *a, const float *b, uint32_t count) {
    bool same = true;
    for (uint32_t i = 0; i < count; i++)
        same &= a[i] == b[i];
    return same;
}

static void compare(const code_samples *s, sample_type type, cpu_isa isa, uint32_t count,
                    const found *want) {
    static found got;
    run(s, type, isa, count, &got);
    const bool same =
        same_values(got.lo, want->lo, BLOCKS_MAX) && same_values(got.hi, want->hi, BLOCKS_MAX) &&
        same_values(got.whole, want->whole, 2) && got.non_finite == want->non_finite &&
        memcmp(got.codes, want->codes, sizeof got.codes) == 0;
    if (!same)
        fail_msg("%u x %u x %u cells of %s: others from %s", s->cells[0], s->cells[1], s->cells[2],
                 sample_name(type), cpu_isa_name(isa));
}

/* ---- treelets ---- */

typedef enum contents { ALL_BITS, NARROW, ONE_VALUE, MISSING, NOTHING, CONTENTS } contents;

static void fill(field_random *r, sample_type type, contents what, void *samples, size_t count) {
    unsigned char *bytes = samples;
    float *f = samples;
    for (size_t i = 0; i < count && type == SAMPLE_F32; i++) {
        f[i] = what == ONE_VALUE ? -2.5F : (float)field_random_in(r, -1, what == NARROW ? -0.9 : 3);
        if (what == NOTHING || (what == MISSING && field_random_below(r, 3) > 0))
            f[i] = i % 2 ? NAN : -INFINITY;
    }
    for (size_t i = 0; i < count * sample_size(type) && type != SAMPLE_F32; i++) {
        const bool low = i % sample_size(type) == 0;
        bytes[i] = (unsigned char)field_random_below(r, what == NARROW ? (low ? 90 : 1) : 256);
        bytes[i] = what == ONE_VALUE ? 77 : bytes[i];
    }
}

/* The samples end where their memory ends: tools see what is read behind them. */
static void check_treelet(field_random *r, sample_type type, const uint32_t cells[3],
                          contents what) {
    static found want;
    const size_t row = cells[0] + 1 + field_random_below(r, 3);
    const size_t slice = row * (cells[1] + 1 + field_random_below(r, 3));
    const size_t count = slice * cells[2] + row * cells[1] + cells[0] + 1;
    char *samples = malloc(count * sample_size(type));
    assert_non_null(samples);
    fill(r, type, what, samples, count);
    const code_samples s = {samples, row, slice, {cells[0], cells[1], cells[2]}};
    uint32_t levels = 2;
    for (int a = 0; a < 3; a++)
        while (cells[a] > (uint32_t)BLOCK << levels)
            levels++;
    search(&s, type, 1U << 3 * levels, &want);
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++)
        compare(&s, type, (cpu_isa)isa, 1U << 3 * levels, &want);
    free(samples);
}

static void test_sizes(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    for (int t = 0; t < TYPES; t++)
        for (uint32_t x = 1; x <= CELLS_MAX; x++) {
            const uint32_t cells[3] = {x, 1 + (uint32_t)field_random_below(&r, 9),
                                       1 + (uint32_t)field_random_below(&r, 9)};
            for (int what = 0; what < CONTENTS; what++)
                check_treelet(&r, types[t], cells, (contents)what);
        }
}

static void test_whole_treelets(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 1};
    for (int t = 0; t < TYPES; t++)
        for (uint32_t side = 16; side <= CELLS_MAX; side *= 2)
            check_treelet(&r, types[t], (const uint32_t[3]){side, side, side}, ALL_BITS);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_sizes),
                                       cmocka_unit_test(test_whole_treelets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
