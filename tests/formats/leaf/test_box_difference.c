/* Boxes that are coded by their differences to earlier ones. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/box_coder.h"
#include "tests/support/box_lab.h"
#include "tests/support/fields.h"
#include "tests/support/naive_box.h"

enum { LEVEL = 1 };

static mem m;

static const sample_type types[] = {SAMPLE_U8, SAMPLE_I8, SAMPLE_U16, SAMPLE_I16, SAMPLE_F32};
static const box_shape shapes[] = {
    {1, {{33, 9, 12}}}, {3, {{40, 5, 7}, {3, 21, 6}, {1, 1, 1}}}, {1, {{64, 40, 9}}}};

/* Two labs of one shape: `now` has the samples of `before`, of which some have changed a little. */
static void change_some(const box_lab *before, box_lab *now, int one_in, field_random *r) {
    memcpy(now->memory, before->memory, before->bytes);
    for (uint32_t i = 0; i < now->count; i++) {
        const coded_box *b = &now->boxes[i];
        for (uint32_t z = 0; z < b->size[2]; z++)
            for (uint32_t y = 0; y < b->size[1]; y++)
                for (uint32_t x = 0; x < b->size[0]; x++) {
                    const size_t at = (size_t)x * b->stride[0] + (size_t)y * b->stride[1] +
                                      (size_t)z * b->stride[2];
                    if (field_random_below(r, (uint64_t)one_in) == 0)
                        ((unsigned char *)b->at)[at * now->width] ^= 1;
                }
    }
}

/* What the independent reader makes of a code of differences, or of none. */
static void decode_naively(const box_lab *b, const unsigned char *code, size_t bytes,
                           const unsigned char *earlier, const unsigned char *want) {
    long sizes[BOX_LAB_MAX][3];
    unsigned char *got = malloc(b->samples * b->width);
    assert_non_null(got);
    for (uint32_t i = 0; i < b->count; i++)
        for (int a = 0; a < 3; a++)
            sizes[i][a] = b->boxes[i].size[a];
    const char *why = naive_boxes_decode((int)b->type, (const long(*)[3])sizes, (int)b->count, code,
                                         bytes, earlier, got);
    if (why)
        fail_msg("%s", why);
    assert_memory_equal(got, want, b->samples * b->width);
    assert_non_null(naive_boxes_decode((int)b->type, (const long(*)[3])sizes, (int)b->count, code,
                                       bytes, earlier ? NULL : want, got));
    free(got);
}

/* Decode over the earlier samples, in place, by every ISA. */
static void decode_all(box_coder *c, box_lab *now, const box_lab *before, const unsigned char *code,
                       size_t bytes, const unsigned char *want) {
    const bool difference = box_coder_is_difference(code);
    for (unsigned isa = 0; isa <= cpu_best(); isa++) {
        box_coder_use(c, (cpu_isa)isa);
        memcpy(now->memory, before->memory, before->bytes);
        assert_true(box_coder_decode(c, code, bytes, now->boxes, now->count, difference));
        unsigned char *got = box_lab_list(now);
        assert_memory_equal(got, want, now->samples * now->width);
        free(got);
        assert_false(box_coder_decode(c, code, bytes, now->boxes, now->count, !difference));
    }
}

/* Returns whether the code is one of differences; *bytes: its size. */
static bool check(box_lab *now, const box_lab *before, size_t *bytes) {
    box_coder *c = NULL;
    const size_t room = box_coder_room(now->type, now->samples);
    unsigned char *code = malloc(room), *again = malloc(room);
    assert_int_equal(box_coder_create(&m, now->type, now->samples, LEVEL, &c), ST_OK);
    unsigned char *want = box_lab_list(now), *earlier = box_lab_list(before);
    const uint64_t hash = box_coder_hash(c, now->boxes, now->count);
    const bool same = memcmp(want, earlier, now->samples * now->width) == 0;
    *bytes = box_coder_encode_from(c, now->boxes, before->boxes, now->count, code);
    assert_int_equal(*bytes == 0, same);
    assert_int_equal(hash == box_coder_hash(c, before->boxes, before->count), same);
    const bool difference = !same && box_coder_is_difference(code);
    for (unsigned isa = 0; isa <= cpu_best() && !same; isa++) {
        box_coder_use(c, (cpu_isa)isa);
        assert_int_equal(box_coder_encode_from(c, now->boxes, before->boxes, now->count, again),
                         *bytes);
        assert_memory_equal(code, again, *bytes);
    }
    if (!same) {
        decode_naively(now, code, *bytes, difference ? earlier : NULL, want);
        decode_all(c, now, before, code, *bytes, want);
    }
    free(want);
    free(earlier);
    free(code);
    free(again);
    box_coder_destroy(c);
    return difference;
}

static size_t whole_bytes(const box_lab *b) {
    box_coder *c = NULL;
    unsigned char *code = malloc(box_coder_room(b->type, b->samples));
    assert_int_equal(box_coder_create(&m, b->type, b->samples, LEVEL, &c), ST_OK);
    const size_t bytes = box_coder_encode(c, b->boxes, b->count, code);
    box_coder_destroy(c);
    free(code);
    return bytes;
}

/* Every kind of samples after every other, and after itself with few changes. */
static void test_all_pairs(void **state) {
    (void)state;
    field_random r = {FIELD_SEED};
    int differences = 0, whole = 0;
    for (size_t t = 0; t < sizeof types / sizeof *types; t++)
        for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++)
            for (int what = 0; what < BOX_VALUES; what++) {
                box_lab before, now;
                size_t bytes;
                const box_lie lie = (box_lie)((what + (int)s) % BOX_LIES);
                if (types[t] != SAMPLE_F32 && what >= BOX_DECIMALS)
                    break;
                box_lab_make(&before, types[t], &shapes[s], lie);
                box_lab_make(&now, types[t], &shapes[s], lie);
                for (int other = 0; other < BOX_VALUES; other++) {
                    if (types[t] != SAMPLE_F32 && other >= BOX_DECIMALS)
                        break;
                    box_lab_fill(&before, (box_values)other, other % 5, 11);
                    box_lab_fill(&now, (box_values)what, what % 5, 12);
                    if (check(&now, &before, &bytes))
                        differences++;
                    else
                        whole++;
                }
                box_lab_fill(&before, (box_values)what, what % 5, 13);
                for (int one_in = 1; one_in < 5000; one_in *= 17) {
                    change_some(&before, &now, one_in, &r);
                    differences += check(&now, &before, &bytes);
                }
                memcpy(now.memory, before.memory, before.bytes);
                assert_false(check(&now, &before, &bytes));
                assert_int_equal(bytes, 0);
                box_lab_release(&before);
                box_lab_release(&now);
            }
    assert_true(differences > 100 && whole > 100);
}

/* Where a sample in a thousand changes, and the rest is noise, a difference takes a small part of
 * the whole; unrelated noise is coded as if there were nothing before. */
static void test_sizes(void **state) {
    (void)state;
    field_random r = {FIELD_SEED + 1};
    for (size_t t = 0; t < sizeof types / sizeof *types; t++) {
        box_lab before, now;
        size_t bytes;
        box_lab_make(&before, types[t], &shapes[2], BOX_PACKED);
        box_lab_make(&now, types[t], &shapes[2], BOX_PACKED);
        box_lab_fill(&before, BOX_NOISE, 0, 5);
        change_some(&before, &now, 1000, &r);
        assert_true(check(&now, &before, &bytes));
        assert_in_range(bytes, 16, whole_bytes(&now) / 20);
        box_lab_fill(&now, BOX_NOISE, 0, 6);
        assert_false(check(&now, &before, &bytes));
        assert_int_equal(bytes, whole_bytes(&now));
        box_lab_fill(&now, BOX_SMOOTH, 0, 7);
        assert_false(check(&now, &before, &bytes));
        assert_int_equal(bytes, whole_bytes(&now));
        box_lab_release(&before);
        box_lab_release(&now);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_pairs),
        cmocka_unit_test(test_sizes),
    };
    mem_init(&m, 0);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
