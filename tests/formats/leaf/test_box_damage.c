/* test_box_damage.c - codes of boxes that are cut, changed, made up or hostile: refused, or read as
 * the independent reader reads them; and never a byte written that is no sample.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/box_judge.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

enum { LEVEL = 3, HEADER = 16, TYPES = 5 };

static const sample_type types[TYPES] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
static const box_shape shapes[] = {
    {1, {{13, 9, 8}}},
    {3, {{7, 7, 3}, {16, 3, 2}, {1, 5, 9}}},
    {1, {{70, 2, 2}}},
    {2, {{1, 1, 1}, {8, 1, 1}}},
};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static mem m;

static bool judge(box_lab *b, const unsigned char *code, size_t bytes) {
    bool good;
    const char *why = box_judge(&m, b, code, bytes, &good);
    if (why)
        fail_msg("%s, %zu bytes, method %d map %d prediction %d width %d: %s", sample_name(b->type),
                 bytes, code[0], code[1], code[2], code[3], why);
    return good;
}

static unsigned char *encode(const box_lab *b, size_t *bytes) {
    box_coder *c = NULL;
    unsigned char *code = malloc(box_coder_room(b->type, b->samples));
    assert_non_null(code);
    assert_int_equal(box_coder_create(&m, b->type, b->samples, LEVEL, &c), ST_OK);
    *bytes = box_coder_encode(c, b->boxes, b->count, code);
    box_coder_destroy(c);
    return code;
}

/* Each type, shape, and some values. */
static void each_code(void (*check)(box_lab *b, unsigned char *code, size_t bytes)) {
    static const box_values values[] = {BOX_NOISE, BOX_SMOOTH, BOX_SPARSE, BOX_DECIMALS};
    for (int t = 0; t < TYPES; t++)
        for (int s = 0; s < SHAPES; s++)
            for (int v = 0; v < (types[t] == SAMPLE_F32 ? 4 : 3); v++) {
                box_lab b;
                size_t bytes;
                box_lab_make(&b, types[t], &shapes[s], (box_lie)((s + v) % BOX_LIES));
                box_lab_fill(&b, values[v], 1, (uint64_t)s);
                unsigned char *code = encode(&b, &bytes);
                assert_true(judge(&b, code, bytes));
                check(&b, code, bytes);
                free(code);
                box_lab_release(&b);
            }
}

static void check_prefixes(box_lab *b, unsigned char *code, size_t bytes) {
    for (size_t n = 0; n < bytes; n += n < 64 || n + 8 > bytes ? 1 : 7)
        assert_false(judge(b, code, n));
    unsigned char *longer = calloc(bytes + 1, 1);
    assert_non_null(longer);
    memcpy(longer, code, bytes);
    assert_false(judge(b, longer, bytes + 1));
    free(longer);
}

static void check_header(box_lab *b, unsigned char *code, size_t bytes) {
    for (int i = 0; i < HEADER; i++) {
        const unsigned char was = code[i];
        for (int value = 0; value < 256; value += i < 4 ? 1 : 15) {
            code[i] = (unsigned char)value;
            (void)judge(b, code, bytes);
        }
        code[i] = was;
    }
}

static void check_flips(box_lab *b, unsigned char *code, size_t bytes) {
    field_random r = {bytes};
    for (int i = 0; i < (WATCHED ? 60 : 300); i++) {
        const long bit = field_random_below(&r, 8 * (long)bytes);
        code[bit / 8] ^= (unsigned char)(1 << bit % 8);
        (void)judge(b, code, bytes);
        if (i % 3) /* some changes stay */
            code[bit / 8] ^= (unsigned char)(1 << bit % 8);
    }
}

static void cut_codes(void **state) {
    (void)state;
    each_code(check_prefixes);
}

static void changed_headers(void **state) {
    (void)state;
    each_code(check_header);
}

static void changed_bits(void **state) {
    (void)state;
    each_code(check_flips);
}

static void random_bytes(void **state) {
    (void)state;
    field_random r = {11};
    for (int turn = 0; turn < 3000; turn++) {
        box_lab b;
        unsigned char code[200];
        const size_t bytes = (size_t)field_random_below(&r, sizeof code + 1);
        for (size_t i = 0; i < sizeof code; i++)
            code[i] = (unsigned char)field_random_bits(&r);
        code[0] = (unsigned char)(turn % 3);
        code[2] &= 15;
        code[3] &= 3;
        box_lab_make(&b, types[turn % TYPES], &shapes[turn % SHAPES], BOX_GAPPED);
        (void)judge(&b, code, bytes);
        box_lab_release(&b);
    }
}

/* ---- made up ---- */

static box_made made_of(field_random *r, const box_lab *b, unsigned char data[256]) {
    const uint64_t mask = (UINT64_C(1) << 8 * b->width) - 1;
    const bool floats = b->type == SAMPLE_F32;
    box_made x = {.data = data, .data_bytes = 1 + (size_t)field_random_below(r, 256), .fits = true};
    for (int i = 0; i < 256; i++)
        data[i] = (unsigned char)(field_random_bits(r) >> field_random_below(r, 9));
    x.code = (box_code){.method = 1,
                        .map = (uint8_t)(floats ? field_random_below(r, 32) : 0),
                        .prediction = (uint8_t)field_random_below(r, 16),
                        .width = (uint8_t)field_random_below(r, (long)b->width + 1),
                        .coded = (uint32_t)b->samples};
    x.code.base = x.code.map ? (uint32_t)field_random_bits(r) : 0;
    if (x.code.prediction & BOX_BACKGROUND)
        x.code.background = (uint32_t)(field_random_bits(r) & mask);
    return x;
}

/* Whatever the fields and the streams are, as long as they are possible: all read the same. Codes
 * that are larger than plain ones are refused. */
static void all_that_is_possible(void **state) {
    (void)state;
    field_random r = {3};
    long read = 0, count = WATCHED ? 1000 : 6000;
    for (int turn = 0; turn < count; turn++) {
        box_lab b;
        unsigned char data[256];
        size_t bytes;
        box_lab_make(&b, types[turn % TYPES], &shapes[turn / TYPES % SHAPES],
                     (box_lie)(turn % BOX_LIES));
        box_made made = made_of(&r, &b, data);
        unsigned char *code = box_judge_make(&b, &made, &bytes);
        const bool good = judge(&b, code, bytes);
        assert_int_equal(good, bytes <= box_coder_room(b.type, b.samples));
        read += good;
        free(code);
        box_lab_release(&b);
    }
    assert_true(read > count / 2);
}

/* ---- hostile ---- */

static const box_shape one_box = {1, {{13, 20, 20}}};
enum { ONE_BOX = 13 * 20 * 20 };

static const unsigned char ones[1] = {255}, zeros[1] = {0}, behind[1] = {0xF0};

/* Whether a code is taken. stretch: bytes more than there are that the last stream's size says. */
static bool takes(sample_type type, box_code code, bool fits, const unsigned char *data,
                  int stretch) {
    box_lab b;
    size_t bytes;
    box_made made = {.code = code, .data = data, .data_bytes = 1, .fits = fits};
    box_lab_make(&b, type, &one_box, BOX_GAPPED);
    unsigned char *made_code = box_judge_make(&b, &made, &bytes);
    const unsigned streams = code.width + (code.prediction & BOX_BACKGROUND ? 1U : 0U);
    if (stretch && streams)
        made_code[HEADER + 4 * (streams - 1)] += (unsigned char)stretch;
    if (stretch > 255 && streams)
        made_code[HEADER + 4 * (streams - 1) + 3] = 255;
    const bool good = judge(&b, made_code, bytes);
    free(made_code);
    box_lab_release(&b);
    return good;
}

static void hostile_fields(void **state) {
    (void)state;
    const box_code good = {1, 0, BOX_PLANE | BOX_ALONG, 1, 0, 0, ONE_BOX};
    const box_code marked = {1, 0, BOX_BACKGROUND | BOX_ROW, 1, 0, 9, 0};
    box_code x;
    assert_true(takes(SAMPLE_U16, good, false, zeros, 0));
    assert_true(takes(SAMPLE_U16, marked, true, ones, 0));
    for (int more = -1; more <= 1; more += 2) {
        x = good;
        x.coded += (uint32_t)more; /* fewer or more residuals than samples */
        assert_false(takes(SAMPLE_U16, x, false, zeros, 0));
        x = marked;
        x.coded = (uint32_t)more; /* and than the map has bits */
        assert_false(takes(SAMPLE_U16, x, false, zeros, 0));
    }
    x = marked;
    x.coded = ONE_BOX; /* bits behind rows, and all before */
    assert_false(takes(SAMPLE_U16, x, false, ones, 0));
    x.coded = 8 * 20 * 20; /* a bit is behind each row, and counted, or not */
    assert_false(takes(SAMPLE_U16, x, false, behind, 0));
    x.coded = 5 * 20 * 20;
    assert_false(takes(SAMPLE_U16, x, false, behind, 0));
    assert_true(takes(SAMPLE_U16, x, true, behind, 0));
    for (uint32_t coded = 0x7fffffff; coded; coded = coded == 0x7fffffff ? UINT32_MAX : 0) {
        x = good;
        x.coded = coded;
        assert_false(takes(SAMPLE_F32, x, false, zeros, 0));
        x = marked;
        x.coded = coded;
        assert_false(takes(SAMPLE_F32, x, false, zeros, 0));
    }
    for (int t = 0; t < TYPES; t++)
        for (int width = 0; width < 256; width += width < 5 ? 1 : 50) {
            x = good;
            x.width = (uint8_t)width;
            assert_int_equal(takes(types[t], x, false, zeros, 0),
                             width <= (int)sample_size(types[t]));
        }
}

static void hostile_streams(void **state) {
    (void)state;
    const box_code good = {1, 0, BOX_MEDIAN, 2, 0, 0, ONE_BOX};
    for (int stretch = 1; stretch <= 256; stretch++)
        assert_false(takes(SAMPLE_U16, good, false, zeros, stretch));
    /* Values that no field of an integer's code may have. */
    box_code x = good;
    x.map = 1;
    assert_false(takes(SAMPLE_U16, x, false, zeros, 0));
    assert_true(takes(SAMPLE_F32, x, false, zeros, 0));
    x.map = 32;
    assert_false(takes(SAMPLE_F32, x, false, zeros, 0));
    x = good;
    x.base = 1;
    assert_false(takes(SAMPLE_F32, x, false, zeros, 0));
    x = good;
    x.background = 1;
    assert_false(takes(SAMPLE_F32, x, false, zeros, 0));
    x.prediction |= BOX_BACKGROUND;
    x.background = 256;
    assert_true(takes(SAMPLE_U16, x, true, ones, 0));
    assert_false(takes(SAMPLE_U16, x, true, zeros, 0)); /* nothing is coded, but has a width */
    x.background = 65536;
    assert_false(takes(SAMPLE_U16, x, true, ones, 0));
    x.width = 1;
    x.background = 256;
    assert_false(takes(SAMPLE_I8, x, true, ones, 0));
    x.width = 0;
    x.background = 255;
    assert_true(takes(SAMPLE_I8, x, true, zeros, 0));
}

/* A stream is one frame: not two that make the bytes together, nor none. */
static void frames_of_streams(void **state) {
    (void)state;
    box_lab b;
    size_t bytes;
    box_made made = {
        .code = {1, 0, BOX_BACKGROUND, 1, 0, 9, 0}, .data = ones, .data_bytes = 1, .fits = true};
    box_lab_make(&b, SAMPLE_U8, &one_box, BOX_PACKED);
    unsigned char *code = box_judge_make(&b, &made, &bytes);
    assert_true(judge(&b, code, bytes));
    const unsigned last = code[HEADER + 4];
    code[HEADER + 4] = 0;
    assert_false(judge(&b, code, bytes - last));
    unsigned char twice[512];
    assert_true(bytes + last <= sizeof twice);
    memcpy(twice, code, bytes);
    memcpy(twice + bytes, code + bytes - last, last);
    twice[HEADER + 4] = (unsigned char)(2 * last);
    assert_false(judge(&b, twice, bytes + last));
    /* An empty frame before it adds no bytes. */
    static const unsigned char empty[] = {0x28, 0xB5, 0x2F, 0xFD, 0x20, 0, 1, 0, 0};
    memcpy(twice + bytes - last, empty, sizeof empty);
    memcpy(twice + bytes - last + sizeof empty, code + bytes - last, last);
    twice[HEADER + 4] = (unsigned char)(last + sizeof empty);
    assert_false(judge(&b, twice, bytes + sizeof empty));
    free(code);
    box_lab_release(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_codes),         cmocka_unit_test(changed_headers),
        cmocka_unit_test(changed_bits),      cmocka_unit_test(random_bytes),
        cmocka_unit_test(hostile_fields),    cmocka_unit_test(hostile_streams),
        cmocka_unit_test(frames_of_streams), cmocka_unit_test(all_that_is_possible),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
