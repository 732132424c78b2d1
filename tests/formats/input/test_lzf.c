/* test_lzf.c - what LZF packed comes out as it was; streams that are none are refused, at each byte
 * at which they can end, and nothing is written behind what was measured.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "formats/input/lzf.h"

enum { BYTES = 20000, FARTHEST = 8192, LONGEST = 264, GUARD = 16, SEED = 11 };

static uint32_t next_random(uint32_t *random) {
    *random = *random * 1664525 + 1013904223;
    return *random >> 8;
}

/* ---- a packer: the longest of what a few places behind have ---- */

static size_t same_bytes(const uint8_t *at, size_t i, size_t size, size_t back) {
    size_t n = 0;
    while (n < LONGEST && i + n < size && at[i + n] == at[i + n - back])
        n++;
    return n;
}

static size_t put_literal(uint8_t *to, const uint8_t *from, size_t count) {
    to[0] = (uint8_t)(count - 1);
    memcpy(to + 1, from, count);
    return count + 1;
}

static size_t put_reference(uint8_t *to, size_t length, size_t back) {
    const size_t high = (back - 1) >> 8, n = length - 2;
    size_t size = 0;
    to[size++] = (uint8_t)((n < 7 ? n : 7) << 5 | high);
    if (n >= 7)
        to[size++] = (uint8_t)(n - 7);
    to[size++] = (uint8_t)((back - 1) & 255);
    return size;
}

static size_t pack(const uint8_t *from, size_t size, uint8_t *to) {
    static const size_t places[] = {1, 2, 3, 8, 100, 255, 256, 257, 5000, FARTHEST};
    size_t packed = 0;
    for (size_t i = 0; i < size;) {
        size_t length = 0, back = 0;
        for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
            const size_t n = places[k] <= i ? same_bytes(from, i, size, places[k]) : 0;
            if (n > length)
                length = n, back = places[k];
        }
        const size_t rest = size - i, literals = rest < 1 + i % 32 ? rest : 1 + i % 32;
        packed += length > 2 ? put_reference(to + packed, length, back)
                             : put_literal(to + packed, from + i, literals);
        i += length > 2 ? length : literals;
    }
    return packed;
}

/* ---- tests ---- */

/* Runs, patterns, and noise. */
static void fill(uint8_t *bytes, size_t size, uint32_t *random) {
    for (size_t i = 0; i < size;) {
        const size_t run = 1 + next_random(random) % 900, back = 1 + next_random(random) % FARTHEST;
        const uint32_t kind = next_random(random) % 3;
        for (size_t end = i + run; i < end && i < size; i++)
            bytes[i] = kind == 2 || back > i ? (uint8_t)next_random(random) : bytes[i - back];
    }
}

static void test_round(void **state) {
    (void)state;
    static uint8_t bytes[BYTES], packed[2 * BYTES], out[BYTES + GUARD];
    uint32_t random = SEED;
    for (size_t size = 0; size <= BYTES; size += 1 + size / 3) {
        size_t measured;
        fill(bytes, size, &random);
        const size_t n = pack(bytes, size, packed);
        assert_null(lzf_size(packed, n, &measured));
        assert_int_equal(measured, size);
        memset(out, 0xa5, sizeof out);
        lzf_unpack(packed, n, out);
        assert_memory_equal(out, bytes, size);
        for (int i = 0; i < GUARD; i++)
            assert_int_equal(out[size + i], 0xa5);
    }
}

/* Made by hand: each form of an item, and those that overlap. */
static void test_items(void **state) {
    (void)state;
    static const uint8_t packed[] = {2,        'a', 'b',  'c', 0x20, 2, /* abc, 3 of them again */
                                     0xc0 | 0, 0,   0xe0, 0,   5};      /* 8 x c; 9, 6 back */
    char out[24] = "";
    size_t size;
    assert_null(lzf_size(packed, sizeof packed, &size));
    assert_int_equal(size, 23);
    lzf_unpack(packed, sizeof packed, out);
    assert_string_equal(out, "abcabcccccccccccccccccc");
    assert_null(lzf_size(packed, 0, &size));
    assert_int_equal(size, 0);
}

/* Each beginning of a stream is one, or is refused; so is noise. Bytes lie at the end of a block of
 * their own, where reading behind them is seen by the sanitizers. */
static void test_hostile(void **state) {
    (void)state;
    uint32_t random = SEED;
    int sound = 0, refused = 0;
    for (int round = 0; round < 3000; round++) {
        const size_t size = next_random(&random) % 40;
        uint8_t *bytes = malloc(size + 1);
        size_t measured;
        for (size_t i = 0; i < size; i++)
            bytes[i] = (uint8_t)(next_random(&random) & (round % 2 ? 0x2f : 0xff));
        memmove(bytes + 1, bytes, size);
        if (lzf_size(bytes + 1, size, &measured)) {
            refused++;
        } else {
            assert_true(measured <= 88 * size);
            uint8_t *out = malloc(measured + !measured);
            lzf_unpack(bytes + 1, size, out);
            free(out);
            sound++;
        }
        free(bytes);
    }
    assert_true(sound > 100 && refused > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round),
        cmocka_unit_test(test_items),
        cmocka_unit_test(test_hostile),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
