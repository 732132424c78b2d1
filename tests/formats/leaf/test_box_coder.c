/* test_box_coder.c - boxes of samples, coded and back: the same bits, the same bytes from every
 * ISA, and few of them.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/box_coder.h"
#include "tests/support/box_lab.h"
#include "tests/support/naive_box.h"

enum { LEVEL = 3, GUARD = 0x5A, GUARDS = 64 };

static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
enum { TYPES = 5 };

static mem m;

/* ---- one code ---- */

static box_coder *coder_of(const box_lab *b, int level) {
    box_coder *c = NULL;
    assert_int_equal(box_coder_create(&m, b->type, b->samples, level, &c), ST_OK);
    return c;
}

/* The code of the boxes; malloc'ed. It takes box_coder_room() at most, and no byte is written
 * behind that. */
static unsigned char *encode(const box_lab *b, cpu_isa isa, size_t *bytes) {
    const size_t room = box_coder_room(b->type, b->samples);
    unsigned char *code = malloc(room + GUARDS);
    box_coder *c = coder_of(b, LEVEL);
    assert_non_null(code);
    memset(code, GUARD, room + GUARDS);
    box_coder_use(c, isa);
    *bytes = box_coder_encode(c, b->boxes, b->count, code);
    assert_in_range(*bytes, 16, room);
    for (size_t i = 0; i < GUARDS; i++)
        assert_int_equal(code[room + i], GUARD);
    assert_true(mem_used(&m) <= box_coder_memory(b->type, b->samples));
    box_coder_destroy(c);
    assert_int_equal(mem_used(&m), 0);
    return code;
}

static void decode(box_lab *b, cpu_isa isa, const unsigned char *code, size_t bytes) {
    box_coder *c = coder_of(b, 0);
    box_coder_use(c, isa);
    box_lab_wipe(b);
    assert_true(box_coder_decode(c, code, bytes, b->boxes, b->count, false));
    assert_true(box_lab_kept(b));
    box_coder_destroy(c);
}

/* What the independent reader makes of a code. */
static void decode_naively(const box_lab *b, const unsigned char *code, size_t bytes,
                           const unsigned char *want) {
    long sizes[BOX_LAB_MAX][3];
    unsigned char *got = malloc(b->samples * b->width);
    assert_non_null(got);
    for (uint32_t i = 0; i < b->count; i++)
        for (int a = 0; a < 3; a++)
            sizes[i][a] = b->boxes[i].size[a];
    const char *why = naive_boxes_decode((int)b->type, (const long(*)[3])sizes, (int)b->count, code,
                                         bytes, NULL, got);
    if (why)
        fail_msg("%s", why);
    assert_memory_equal(got, want, b->samples * b->width);
    free(got);
}

/* The samples are in want. Encode on each ISA: the same bytes; decode on each: the same samples.
 * Returns the bytes it takes. header: the code's first 16 bytes; may be NULL. */
static size_t check(box_lab *b, unsigned char header[16]) {
    unsigned char *want = box_lab_list(b);
    size_t bytes, other;
    unsigned char *code = encode(b, CPU_SCALAR, &bytes);
    for (int isa = CPU_SCALAR + 1; isa <= (int)cpu_best(); isa++) {
        unsigned char *same = encode(b, (cpu_isa)isa, &other);
        assert_int_equal(bytes, other);
        assert_memory_equal(code, same, bytes);
        free(same);
    }
    assert_true(box_lab_kept(b));
    for (int isa = CPU_SCALAR; isa <= (int)cpu_best(); isa++) {
        decode(b, (cpu_isa)isa, code, bytes);
        unsigned char *got = box_lab_list(b);
        assert_memory_equal(got, want, b->samples * b->width);
        free(got);
    }
    decode_naively(b, code, bytes, want);
    if (header)
        memcpy(header, code, 16);
    free(code);
    free(want);
    return bytes;
}

static size_t check_values(sample_type type, const box_shape *shape, box_lie lie, box_values what,
                           int detail, unsigned char header[16]) {
    box_lab b;
    box_lab_make(&b, type, shape, lie);
    box_lab_fill(&b, what, detail, 7 + (uint64_t)what);
    const size_t bytes = check(&b, header);
    box_lab_release(&b);
    return bytes;
}

static int values_of(sample_type type) {
    return type == SAMPLE_F32 ? BOX_VALUES : BOX_INTEGERS;
}

static void check_shape(const box_shape *shape, box_lie lie) {
    for (int t = 0; t < TYPES; t++)
        for (int what = 0; what < values_of(types[t]); what++)
            check_values(types[t], shape, lie, (box_values)what, 2, NULL);
}

/* ---- shapes ---- */

static void rows_of_all_lengths(void **state) {
    (void)state;
    for (uint32_t n = 1; n <= 70; n++) {
        const box_shape shape = {1, {{n, n % 4 + 1, n % 3 + 1}}};
        check_shape(&shape, (box_lie)(n % BOX_LIES));
    }
    for (uint32_t n = 1; n <= 70; n += 23) {
        const box_shape line = {1, {{n, 1, 1}}}, sheet = {1, {{5, n, 1}}}, deep = {1, {{9, 1, n}}};
        check_shape(&line, BOX_PACKED);
        check_shape(&sheet, BOX_TURNED);
        check_shape(&deep, BOX_GAPPED);
    }
    const box_shape longest = {1, {{BOX_ROW_MAX, 3, 2}}}, odd = {1, {{BOX_ROW_MAX - 1, 2, 3}}};
    check_shape(&longest, BOX_PACKED);
    check_shape(&odd, BOX_TURNED);
}

static void several_boxes(void **state) {
    (void)state;
    /* The shell of a family, boxes of one sample, and any. */
    static const box_shape shapes[] = {
        {7,
         {{35, 35, 3},
          {35, 3, 16},
          {16, 16, 3},
          {16, 16, 3},
          {35, 3, 16},
          {16, 16, 3},
          {16, 16, 3}}},
        {5, {{1, 1, 1}, {1, 1, 1}, {2, 1, 1}, {1, 3, 1}, {1, 1, 9}}},
        {3, {{131, 3, 2}, {8, 8, 8}, {7, 1, 30}}},
        {1, {{17, 18, 19}}},
    };
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; i++)
        for (int lie = 0; lie < BOX_LIES; lie++)
            check_shape(&shapes[i], (box_lie)lie);
}

/* ---- values of floats ---- */

static const box_shape cube = {1, {{20, 20, 20}}};
enum { CUBE = 20 * 20 * 20 };

/* Multiples of a step are recognized, and coded as such. */
static void decimals_and_binaries(void **state) {
    (void)state;
    unsigned char header[16];
    for (int d = 0; d <= 6; d++) {
        const size_t bytes = check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_DECIMALS, d, header);
        assert_int_equal(header[1], 1 + d);
        assert_in_range(bytes, 16, CUBE * 2);
    }
    for (int d = 7; d <= 24; d++) {
        const size_t bytes = check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_BINARIES, d, header);
        assert_int_equal(header[1], 7 + d);
        assert_in_range(bytes, 16, CUBE * 2);
    }
    check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_BINARIES, 25, header);
    assert_int_equal(header[1], 0);
    check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_STRAY, 1, header);
    assert_int_equal(header[1], 0);
    check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_ZEROS, 0, header);
    assert_int_equal(header[1], 0);
    check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_QUIET, 0, header);
    assert_true(header[1] > 0);
}

/* Multiples are below 2^30: then they are coded as such, and at 2^30 as floats. */
static void limits_of_multiples(void **state) {
    (void)state;
    unsigned char header[16];
    for (int d = 0; d <= 24; d++) {
        check_values(SAMPLE_F32, &cube, BOX_PACKED, BOX_LIMITS, d, header);
        assert_true(header[1] > 0);
        box_lab b;
        box_lab_make(&b, SAMPLE_F32, &cube, BOX_PACKED);
        box_lab_fill(&b, BOX_LIMITS, 0, 5);
        ((float *)b.boxes[0].at)[CUBE / 2 + d] = d % 2 ? 0x1p30F : -0x1p30F;
        check(&b, header);
        assert_int_equal(header[1], 0);
        box_lab_release(&b);
    }
}

/* ---- bytes ---- */

/* Enough for what the coder is made for, and too few if it does it no more. */
static void few_bytes(void **state) {
    (void)state;
    static const box_shape large = {1, {{32, 32, 32}}};
    enum { LARGE = 32 * 32 * 32 };
    static const struct {
        sample_type type;
        box_values what;
        int detail;
        size_t most;
    } cases[] = {
        {SAMPLE_U8, BOX_CONSTANT, 0, 64},
        {SAMPLE_F32, BOX_CONSTANT, 0, 64},
        {SAMPLE_F32, BOX_QUIET, 0, 64},
        {SAMPLE_U16, BOX_RAMP, 0, 600},
        {SAMPLE_I16, BOX_RAMP, 0, 600},
        {SAMPLE_U8, BOX_RAMP, 0, 600},
        {SAMPLE_U8, BOX_SMOOTH, 0, LARGE / 4},
        {SAMPLE_I8, BOX_SMOOTH, 0, LARGE / 4},
        {SAMPLE_U16, BOX_SMOOTH, 0, LARGE * 3 / 4},
        {SAMPLE_I16, BOX_SMOOTH, 0, LARGE * 3 / 4},
        {SAMPLE_F32, BOX_SMOOTH, 0, LARGE * 2},
        {SAMPLE_F32, BOX_RAMP, 0, LARGE * 2},
        {SAMPLE_U8, BOX_SPARSE, 0, 700},
        {SAMPLE_U16, BOX_SPARSE, 0, 800},
        {SAMPLE_F32, BOX_SPARSE, 0, 1200},
        {SAMPLE_F32, BOX_ZEROS, 0, LARGE / 7},
        {SAMPLE_U8, BOX_EXTREMES, 0, LARGE / 7},
        {SAMPLE_F32, BOX_DECIMALS, 3, LARGE * 5 / 4},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const size_t bytes =
            check_values(cases[i].type, &large, BOX_PACKED, cases[i].what, cases[i].detail, NULL);
        if (getenv("BOX_BYTES"))
            print_message("%s values %d: %zu of %zu bytes\n", sample_name(cases[i].type),
                          (int)cases[i].what, bytes, cases[i].most);
        if (bytes > cases[i].most)
            fail_msg("%s values %d: %zu bytes, not %zu", sample_name(cases[i].type),
                     (int)cases[i].what, bytes, cases[i].most);
    }
    for (int t = 0; t < TYPES; t++) {
        unsigned char header[16];
        const size_t bytes = check_values(types[t], &large, BOX_PACKED, BOX_NOISE, 0, header);
        assert_int_equal(bytes, box_coder_room(types[t], LARGE));
        assert_int_equal(header[0], 0);
    }
}

/* What is coded does not depend on how it lies, nor on what the coder coded before. */
static void the_same_again(void **state) {
    (void)state;
    for (int t = 0; t < TYPES; t++) {
        box_coder *c = NULL;
        const size_t room = box_coder_room(types[t], CUBE);
        unsigned char *first = malloc(room), *code = malloc(room);
        size_t bytes = 0;
        assert_true(first && code);
        assert_int_equal(box_coder_create(&m, types[t], CUBE, LEVEL, &c), ST_OK);
        for (int turn = 0; turn < 4 * BOX_LIES; turn++) {
            box_lab b;
            box_lab_make(&b, types[t], &cube, (box_lie)(turn / 4));
            box_lab_fill(&b, turn % 2 ? BOX_SPARSE : turn % 4 ? BOX_NOISE : BOX_SMOOTH, 0, 3);
            const size_t got = box_coder_encode(c, b.boxes, 1, code);
            if (turn == 0)
                memcpy(first, code, bytes = got);
            if (turn % 4 == 0) {
                assert_int_equal(got, bytes);
                assert_memory_equal(code, first, bytes);
            }
            unsigned char *want = box_lab_list(&b);
            box_lab_wipe(&b);
            assert_true(box_coder_decode(c, code, got, b.boxes, 1, false));
            unsigned char *is = box_lab_list(&b);
            assert_memory_equal(is, want, b.samples * b.width);
            free(want);
            free(is);
            box_lab_release(&b);
        }
        box_coder_destroy(c);
        free(first);
        free(code);
    }
}

/* With less memory than it says, a coder is refused, and nothing is left behind. */
static void little_memory(void **state) {
    (void)state;
    for (int level = 0; level <= LEVEL; level += LEVEL) {
        box_coder *c = NULL;
        const size_t enough = box_coder_memory(SAMPLE_F32, CUBE);
        mem_init(&m, enough);
        assert_int_equal(box_coder_create(&m, SAMPLE_F32, CUBE, level, &c), ST_OK);
        const size_t used = mem_used(&m);
        assert_true(used <= enough);
        box_coder_destroy(c);
        for (size_t limit = 1; limit < used; limit += 1 + limit / 3) {
            mem_init(&m, limit);
            assert_int_equal(box_coder_create(&m, SAMPLE_F32, CUBE, level, &c), ST_NOMEM);
            assert_null(c);
            assert_int_equal(mem_used(&m), 0);
        }
    }
    mem_init(&m, 0);
    box_coder_destroy(NULL);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_of_all_lengths),
        cmocka_unit_test(several_boxes),
        cmocka_unit_test(decimals_and_binaries),
        cmocka_unit_test(limits_of_multiples),
        cmocka_unit_test(few_bytes),
        cmocka_unit_test(the_same_again),
        cmocka_unit_test(little_memory),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
