/* test_mem.c - the counted allocator, its budget, the fault hook; statuses and their descriptions.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/mem.h"
#include "formats/base/status.h"

static void test_counts(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    char *a = mem_alloc(&m, 1), *b = mem_zalloc(&m, 1000);
    assert_non_null(a);
    assert_int_equal((uintptr_t)a % 64, 0);
    assert_int_equal((uintptr_t)b % 64, 0);
    for (int i = 0; i < 1000; i++)
        assert_int_equal(b[i], 0);
    size_t both = mem_used(&m);
    assert_true(both >= 1001);
    mem_free(&m, a);
    assert_true(mem_used(&m) < both);
    mem_free(&m, b);
    mem_free(&m, NULL);
    assert_int_equal(mem_used(&m), 0);
    assert_int_equal(mem_peak(&m), both);
    char *text = mem_copy_text(&m, "text");
    assert_string_equal(text, "text");
    mem_free(&m, text);
}

static void test_budget(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 4096);
    char *a = mem_alloc(&m, 3000);
    assert_non_null(a);
    assert_null(mem_alloc(&m, 2000));
    assert_non_null(strstr(status_text(), "2000 bytes"));
    assert_non_null(strstr(status_text(), "4096 bytes"));
    mem_free(&m, a);
    a = mem_alloc(&m, 3900);
    assert_non_null(a);
    mem_free(&m, a);
    assert_int_equal(mem_used(&m), 0);
}

static void test_grow(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    uint32_t *list = NULL;
    size_t room = 0;
    for (uint32_t i = 0; i < 100; i++) {
        assert_int_equal(mem_grow(&m, &list, sizeof *list, i, 3, &room), ST_OK);
        assert_true(room > i);
        list[i] = 7 * i;
    }
    assert_int_equal(room, 192);
    for (uint32_t i = 0; i < 100; i++)
        assert_int_equal(list[i], 7 * i);
    const uint32_t *kept = list;
    m.limit = mem_used(&m);
    assert_int_equal(mem_grow(&m, &list, sizeof *list, 192, 3, &room), ST_NOMEM);
    assert_ptr_equal(list, kept);
    assert_int_equal(room, 192);
    mem_free(&m, list);
    assert_int_equal(mem_used(&m), 0);
}

static void test_overflow(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    assert_null(mem_alloc(&m, SIZE_MAX));
    assert_null(mem_array(&m, SIZE_MAX / 2, 3));
    assert_null(mem_array(&m, SIZE_MAX, SIZE_MAX));
    void *none = mem_array(&m, 0, 8);
    assert_non_null(none);
    mem_free(&m, none);
    assert_int_equal(mem_used(&m), 0);
}

/* Large blocks: zeros each time, as aligned and counted as small ones, given back in whole. */
static void test_large(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    for (size_t size = MEM_LARGE_PAGE - 200; size < MEM_LARGE_PAGE + 200; size += 67) {
        for (int round = 0; round < 2; round++) {
            char *a = mem_zalloc(&m, size), *b = mem_alloc(&m, 2 * size);
            assert_non_null(a);
            assert_non_null(b);
            assert_int_equal((uintptr_t)a % 64, 0);
            assert_int_equal((uintptr_t)b % 64, 0);
            assert_in_range(mem_used(&m), 3 * size, 3 * size + 512);
            for (size_t i = 0; i < size; i++)
                if (a[i] != 0)
                    fail_msg("byte %zu of %zu is %d", i, size, a[i]);
            memset(a, 7, size);
            memset(b, 7, 2 * size);
            mem_free(&m, a);
            mem_free(&m, b);
            assert_int_equal(mem_used(&m), 0);
        }
    }
    m.limit = MEM_LARGE_PAGE;
    assert_null(mem_zalloc(&m, MEM_LARGE_PAGE));
    assert_int_equal(mem_used(&m), 0);
}

/* How many bytes of address space the process has. */
static size_t mapped_now(void) {
    char text[64];
    size_t pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    assert_non_null(f);
    assert_non_null(fgets(text, sizeof text, f));
    fclose(f);
    pages = strtoul(text, NULL, 10);
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

static void test_map(void **state) {
    (void)state;
    static const size_t sizes[] = {1, 4096, MEM_LARGE_PAGE, MEM_LARGE_PAGE + 1,
                                   3 * MEM_LARGE_PAGE - 1};
    enum { SIZES = (int)(sizeof sizes / sizeof *sizes), ROUNDS = 5 };
    const size_t odd = MEM_LARGE_PAGE / 2; /* so that the next place is no multiple by itself */
    char *maps[SIZES * ROUNDS], *between[SIZES * ROUNDS];
    const size_t before = mapped_now();
    size_t wanted = 0;
    for (int i = 0; i < SIZES * ROUNDS; i++) {
        const size_t size = sizes[i % SIZES];
        between[i] = mmap(NULL, odd, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        assert_true(between[i] != MAP_FAILED);
        maps[i] = mem_map(size);
        assert_non_null(maps[i]);
        assert_int_equal((uintptr_t)maps[i] % MEM_LARGE_PAGE, 0);
        assert_int_equal(maps[i][0] | maps[i][size - 1], 0);
        memset(maps[i], 1, size);
        wanted += odd + (size + 4095) / 4096 * 4096;
    }
    /* No more than asked for, but for what stdio takes. */
    assert_in_range(mapped_now() - before, wanted, wanted + (1 << 20));
    for (int i = 0; i < SIZES * ROUNDS; i++) {
        munmap(maps[i], sizes[i % SIZES]);
        munmap(between[i], odd);
    }
    assert_in_range(mapped_now() - before, 0, 1 << 20);
    assert_null(mem_map(SIZE_MAX));
    assert_null(mem_map(SIZE_MAX / 2));
}

static void test_fault(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    fault_arm(FAULT_ALLOC, 2);
    void *a = mem_alloc(&m, 8);
    assert_non_null(a);
    assert_false(fault_fired(FAULT_ALLOC));
    assert_null(mem_alloc(&m, 8));
    assert_true(fault_fired(FAULT_ALLOC));
    void *b = mem_alloc(&m, 8);
    assert_non_null(b);
    assert_false(fault_hit(FAULT_READ));
    fault_arm(FAULT_ALLOC, 0);
    assert_false(fault_fired(FAULT_ALLOC));
    mem_free(&m, a);
    mem_free(&m, b);
    assert_int_equal(mem_used(&m), 0);
}

static void test_status(void **state) {
    (void)state;
    assert_int_equal(status_describe(ST_IO, "%s: %d", "x", 7), ST_IO);
    assert_string_equal(status_text(), "x: 7");
    /* A description may be made of the one before. */
    assert_int_equal(status_describe(ST_IO, "[%s]", status_text()), ST_IO);
    assert_string_equal(status_text(), "[x: 7]");
    status_note note;
    status_note_take(&note, ST_CORRUPT);
    (void)status_describe(ST_IO, "other");
    assert_int_equal(status_note_raise(&note), ST_CORRUPT);
    assert_string_equal(status_text(), "[x: 7]");
    char text[3000];
    memset(text, 'a', sizeof text);
    text[sizeof text - 1] = 0;
    (void)status_describe(ST_IO, "%s", text);
    assert_int_equal(strlen(status_text()), STATUS_TEXT_MAX - 1);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_counts),   cmocka_unit_test(test_budget), cmocka_unit_test(test_grow),
        cmocka_unit_test(test_overflow), cmocka_unit_test(test_large),  cmocka_unit_test(test_map),
        cmocka_unit_test(test_fault),    cmocka_unit_test(test_status),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
