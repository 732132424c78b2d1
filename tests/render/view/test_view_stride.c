/* test_view_stride.c - which step is expected behind those that were shown.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdbool.h>
#include <stdint.h>

#include "render/view/view_stride.h"

enum { SHOWN = 8 };

typedef struct order {
    uint32_t steps;
    uint32_t shown[SHOWN], next[SHOWN];
} order;

static const order ORDERS[] = {
    /* Nothing plays yet. Then forward, round the end. */
    {5, {2, 2, 3, 4, 0, 1, 1, 1}, {2, 2, 4, 0, 1, 2, 2, 2}},
    /* Backward, and turned round. */
    {6, {1, 0, 5, 4, 5, 0, 1, 2}, {1, 5, 4, 3, 0, 1, 2, 3}},
    /* A jump before anything plays; steps play from there; another one. */
    {100, {0, 40, 40, 41, 42, 7, 7, 8}, {0, 41, 41, 42, 43, 8, 8, 9}},
    /* Jumps while steps play backward. */
    {100, {9, 8, 7, 50, 49, 20, 90, 90}, {9, 7, 6, 49, 48, 19, 89, 89}},
    /* A movie of every third step, some every fourth. */
    {100, {0, 3, 6, 10, 13, 16, 20, 20}, {0, 4, 9, 13, 16, 19, 23, 23}},
    /* The same round the end: 97 to 0 is three on, 2 to 99 three back. */
    {100, {91, 94, 97, 0, 3, 0, 97, 94}, {91, 95, 0, 3, 6, 3, 94, 91}},
    /* Backward, a jump to the last step, and forward from there. */
    {100, {50, 49, 48, 99, 0, 1, 1, 2}, {50, 48, 47, 98, 1, 2, 2, 3}},
    /* Two steps are neighbours either way; one has none. */
    {2, {0, 1, 0, 1, 1, 0, 1, 0}, {0, 0, 1, 0, 0, 1, 0, 1}},
    {1, {0, 0, 0, 0, 0, 0, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 0}},
    /* Half of the circle is the same way every time. */
    {4, {0, 2, 0, 2, 0, 2, 0, 2}, {0, 3, 2, 0, 2, 0, 2, 0}},
};

static void test_orders(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof ORDERS / sizeof *ORDERS; i++) {
        const order *o = &ORDERS[i];
        view_stride s = {false, 0, 0, 0};
        for (int k = 0; k < SHOWN; k++) {
            const uint32_t next = view_stride_next(&s, o->shown[k], o->steps);
            if (next != o->next[k])
                fail_msg("order %zu, %d: step %u, not %u", i, k, next, o->next[k]);
        }
    }
}

/* Steps that come meanwhile change no direction: backward past the first step is the new end. */
static void test_grown(void **state) {
    view_stride s = {false, 0, 0, 0};
    (void)state;
    (void)view_stride_next(&s, 2, 3);
    assert_int_equal(view_stride_next(&s, 1, 3), 0);
    assert_int_equal(view_stride_next(&s, 0, 3), 2);
    assert_int_equal(view_stride_next(&s, 0, 10), 9);
    assert_int_equal(view_stride_next(&s, 9, 10), 8);
    /* Sizes beyond 31 bits. */
    s = (view_stride){false, 0, 0, 0};
    (void)view_stride_next(&s, UINT32_MAX - 1, UINT32_MAX);
    assert_int_equal(view_stride_next(&s, 0, UINT32_MAX), 1);
    assert_int_equal(view_stride_next(&s, UINT32_MAX - 1, UINT32_MAX), UINT32_MAX - 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_orders),
        cmocka_unit_test(test_grown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
