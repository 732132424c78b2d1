/* test_heap.c - binary heaps: items come out in order, whatever order they went in. */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

#include "formats/base/heap.h"

enum { ITEMS = 100 };

typedef struct item {
    uint32_t key, number;
} item;

static bool before(const item *a, const item *b) {
    return a->key != b->key ? a->key < b->key : a->number < b->number;
}

HEAP_RISE(item, item, before)
HEAP_SINK(item, item, before)

static item pop(item *items, size_t *count) {
    const item first = items[0], last = items[--*count];
    item_sink(items, 0, *count, last);
    return first;
}

static void check_heap(const item *items, size_t count) {
    for (size_t i = 1; i < count; i++)
        assert_false(before(&items[i], &items[(i - 1) / 2]));
}

/* Any number of items, and few keys: most are equal. */
static void test_push_pop(void **state) {
    (void)state;
    uint32_t random = 1;
    for (size_t total = 1; total <= ITEMS; total++) {
        item items[ITEMS + 1] = {0};
        size_t count = 0;
        items[total].key = 12345; /* behind them: stays */
        for (uint32_t i = 0; i < total; i++) {
            random = random * 1664525 + 1013904223;
            item_rise(items, count++, (item){random >> 24 & 15, i});
            check_heap(items, count);
        }
        item last = {0, 0};
        for (uint32_t i = 0; i < total; i++) {
            const item next = pop(items, &count);
            check_heap(items, count);
            assert_true(i == 0 || before(&last, &next));
            last = next;
        }
        assert_int_equal(count, 0);
        assert_int_equal(items[total].key, 12345);
    }
}

/* In and out by turns: each that comes out is the first of what is in. */
static void test_mixed(void **state) {
    (void)state;
    item items[ITEMS];
    bool in[1000] = {false};
    size_t count = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        const uint32_t key = i * 7919 % 1000;
        item_rise(items, count++, (item){key, 0});
        in[key] = true;
        while (count > (i % 3 ? ITEMS - 1 : ITEMS / 2)) {
            const uint32_t first = pop(items, &count).key;
            for (uint32_t k = 0; k < first; k++)
                assert_false(in[k]);
            assert_true(in[first]);
            in[first] = false;
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_push_pop),
                                       cmocka_unit_test(test_mixed)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
