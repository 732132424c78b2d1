#include "tests/support/leaf_compare.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <string.h>

#include "formats/leaf/leaf_unpacker.h"

leaf_file *leaf_compare_open(mem *m, const char *path) {
    leaf_file *f = NULL;
    if (leaf_file_open(m, path, &f) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

uint64_t leaf_compare(const char *whole, const char *index, size_t limit, leaf_compared *each) {
    mem m, small;
    leaf_unpacker *u = NULL;
    uint64_t read = 0;
    mem_init(&m, 0);
    mem_init(&small, limit);
    leaf_file *a = leaf_compare_open(&m, whole), *b = leaf_compare_open(&small, index);
    assert_int_equal(leaf_unpacker_create(&m, b, &u), ST_OK);
    char *want = mem_alloc(&m, leaf_layout_payload_max(&a->layout));
    char *got = mem_alloc(&m, leaf_layout_payload_max(&a->layout));
    assert_true(want && got && b->samples && !a->samples);
    for (uint32_t t = 0; t < a->layout.treelets; t++) {
        const size_t bytes = leaf_layout_payload_bytes(&a->layout, t);
        memset(got, 0x55, bytes);
        assert_int_equal(leaf_file_load(a, t, NULL, want), ST_OK);
        if (leaf_file_load(b, t, u, got) != ST_OK)
            fail_msg("%s", status_text());
        assert_memory_equal(want, got, bytes);
        const uint64_t more = leaf_unpacker_take(u);
        if (each)
            each(b, t, more);
        read += leaf_file_is_outside(b, t) ? more : 0;
        assert_int_equal(leaf_file_is_implied(a, t), leaf_file_is_implied(b, t));
    }
    mem_free(&m, want);
    mem_free(&m, got);
    leaf_unpacker_destroy(u);
    leaf_file_close(a);
    leaf_file_close(b);
    assert_int_equal(mem_used(&m) + mem_used(&small), 0);
    return read;
}
