/* test_curvilinear_stream.c - the curvilinear stream: what is written is read, from a file and
 * from what is none, in any order; refusals that name the line or the node; cut files; faults.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/curvilinear/curvilinear_source.h"
#include "formats/curvilinear/curvilinear_stream.h"
#include "tests/support/scratch.h"

static const uint32_t sides[2][3] = {{2, 3, 4}, {3, 2, 2}};
static const char *const names[2] = {"heat", "speed"};
enum { NODES = 24 + 12, FIRST = 24 };

static float place(uint32_t node, uint32_t axis) {
    return (float)(node * 3 + axis) / 7;
}

static float value(uint32_t field, uint32_t node) {
    return node == 5 ? NAN : (float)(field * 100 + node);
}

static uint8_t mark(uint32_t node) {
    return node == 7 ? 0 : node == 9 ? CURVILINEAR_NODE | CURVILINEAR_HIDDEN : CURVILINEAR_NODE;
}

static const curvilinear_stream_header both = {.name = "two zones",
                                               .fields = names,
                                               .field_count = 2,
                                               .nodes = sides,
                                               .zones = 2,
                                               .blanked = true};

static status write_grid(mem *m, const char *path, const curvilinear_stream_header *h) {
    curvilinear_stream_writer *w;
    status st = curvilinear_stream_create(m, path, true, h, &w);
    if (st != ST_OK)
        return st;
    for (uint32_t n = 0; n < NODES && st == ST_OK; n++)
        st = curvilinear_stream_places(w, 1,
                                       &(const float[3]){place(n, 0), place(n, 1), place(n, 2)});
    for (uint32_t n = 0; n < NODES && st == ST_OK && h->blanked; n++)
        st = curvilinear_stream_blanks(w, 1, &(const uint8_t){mark(n)});
    for (uint32_t f = 0; f < h->field_count; f++)
        for (uint32_t n = 0; n < NODES && st == ST_OK; n++)
            st = curvilinear_stream_values(w, 1, &(const float){value(f, n)});
    if (st == ST_OK)
        return curvilinear_stream_commit(w);
    curvilinear_stream_discard(w);
    return st;
}

static const char *write_file(const char *name, const curvilinear_stream_header *h) {
    mem m;
    mem_init(&m, 0);
    const char *path = scratch_path(name);
    assert_int_equal(write_grid(&m, path, h), ST_OK);
    assert_int_equal(mem_used(&m), 0);
    return path;
}

static bool same(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

/* Read a plane of a zone, whose first node is node `first` of all. */
static void check_plane(const curvilinear_source *s, uint32_t zone, uint32_t k, uint32_t first) {
    float p[6][3], v[6];
    uint8_t is_node[6];
    const uint32_t count = sides[zone][0] * sides[zone][1];
    assert_int_equal(s->places(s->own, zone, k, 1, p), ST_OK);
    assert_int_equal(s->blanks(s->own, zone, k, 1, is_node), ST_OK);
    for (uint32_t n = 0; n < count; n++) {
        for (uint32_t a = 0; a < 3; a++)
            assert_true(same(p[n][a], place(first + n, a)));
        assert_int_equal(is_node[n], mark(first + n));
    }
    for (uint32_t f = 0; f < s->fields; f++) {
        assert_int_equal(s->values(s->own, zone, f, k, 1, v), ST_OK);
        for (uint32_t n = 0; n < count; n++)
            assert_true(same(v[n], value(1 - f, first + n)));
    }
}

/* Read all of a grid, backwards, with its fields in the other order. */
static void check_grid(curvilinear_input *x) {
    static const char *const turned[] = {"speed", "heat"};
    assert_string_equal(curvilinear_input_format(x), "curvilinear stream");
    assert_string_equal(curvilinear_input_name(x), "two zones");
    assert_int_equal(curvilinear_input_fields(x), 2);
    assert_int_equal(curvilinear_input_take(x, turned, 2), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->zones, 2);
    assert_memory_equal(s->nodes, sides, sizeof sides);
    assert_true(s->blanked);
    for (uint32_t k = 2; k-- > 0;)
        check_plane(s, 1, k, FIRST + 6 * k);
    for (uint32_t k = 4; k-- > 0;)
        check_plane(s, 0, k, 6 * k);
}

static void test_round_trip(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    const char *path = write_file("two.curv", &both);
    assert_int_equal(curvilinear_input_open(&m, path, NULL, &x), ST_OK);
    check_grid(x);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

/* A stream that is no file: bytes in memory, in small parts. */
typedef struct bytes {
    char *all;
    size_t size, at;
} bytes;

static status read_bytes(void *ctx, void *to, size_t size, size_t *got) {
    bytes *b = ctx;
    const size_t left = b->size - b->at, some = left < 100 ? left : 100;
    *got = size < some ? size : some;
    memcpy(to, b->all + b->at, *got);
    b->at += *got;
    return ST_OK;
}

static void close_bytes(void *ctx) {
    bytes *b = ctx;
    free(b->all);
    b->all = NULL;
}

/* Open the grid in the first bytes of a file and some more, from a stream. */
static status open_bytes(mem *m, const char *path, ptrdiff_t more, curvilinear_input **out) {
    static bytes b;
    byte_stream *s;
    b = (bytes){0};
    b.all = scratch_read(path, &b.size); /* with a NUL behind */
    b.size = (size_t)((ptrdiff_t)b.size + more);
    status st =
        byte_stream_open_source(m, "a stream", &(byte_source){read_bytes, close_bytes, &b}, &s);
    if (st == ST_OK)
        st = curvilinear_input_open_stream(m, s, NULL, out);
    return st;
}

static void test_stream(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    assert_int_equal(open_bytes(&m, write_file("piped.curv", &both), 0, &x), ST_OK);
    check_grid(x);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

static void test_cut_stream(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    const char *path = write_file("whole.curv", &both);
    static const ptrdiff_t more[] = {-1, 1, -700};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(open_bytes(&m, path, more[i], &x), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "a stream: "));
        assert_non_null(strstr(status_text(), "bytes behind the header, expected 756 for 36 nodes "
                                              "and 2 fields"));
    }
    assert_int_equal(mem_used(&m), 0);
}

static void test_plain(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    const curvilinear_stream_header bare = {.name = "", .nodes = sides, .zones = 2};
    assert_int_equal(curvilinear_input_open(&m, write_file("bare.curv", &bare), NULL, &x), ST_OK);
    assert_int_equal(curvilinear_input_fields(x), 0);
    assert_string_equal(curvilinear_input_name(x), "");
    assert_false(curvilinear_input_source(x)->blanked);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- refusals ---- */

#define HEAD "LEAFCAST CURVILINEAR 1\n"

static void test_headers(void **state) {
    (void)state;
    static const struct {
        const char *text, *says;
        status st;
    } bad[] = {
        {"LEAFCAST CURVILINEAR 2\nzone: 2 2 2\n\n", "expected \"LEAFCAST CURVILINEAR 1\"",
         ST_UNSUPPORTED},
        {HEAD "zone: 2 2\n\n", "line 2: \"zone: 2 2\", expected nodes along i, j and k",
         ST_CORRUPT},
        {HEAD "zone: 2 1 2\n\n", "three whole numbers from 2 on", ST_CORRUPT},
        {HEAD "zone: 2 2.5 2\n\n", "three whole numbers from 2 on", ST_CORRUPT},
        {HEAD "zone: 2 2 -3\n\n", "three whole numbers from 2 on", ST_CORRUPT},
        {HEAD "\n", "line 2: \"\", expected a line \"zone: NI NJ NK\" before it", ST_CORRUPT},
        {HEAD "name: a\nname: b\nzone: 2 2 2\n\n", "line 3: \"name: b\", expected each line once",
         ST_CORRUPT},
        {HEAD "field: a\nfield: a\n", "line 3: \"field: a\", expected each field once", ST_CORRUPT},
        {HEAD "field: \n", "line 2: \"field:\", expected name, field, zone, blanked", ST_CORRUPT},
        {HEAD "blanked: no\n", "line 2: \"blanked: no\", expected \"blanked: yes\"", ST_CORRUPT},
        {HEAD "points: 3\n", "line 2: \"points: 3\", expected name", ST_CORRUPT},
        {HEAD "zone: 2 2 2\n", "expected a line; the file ends here", ST_CORRUPT},
        {HEAD "zone: 134217728 134217728 134217728\n\n", "more than 2^48 nodes", ST_UNSUPPORTED},
        {HEAD "zone: 2 2 2\n\n", "0 bytes behind the header, expected 96 for 8 nodes and 0 fields",
         ST_CORRUPT},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        mem m;
        mem_init(&m, 0);
        curvilinear_input *x;
        const char *path = scratch_text("bad.curv", bad[i].text);
        assert_int_equal(curvilinear_input_open(&m, path, NULL, &x), bad[i].st);
        assert_non_null(strstr(status_text(), "bad.curv: "));
        if (!strstr(status_text(), bad[i].says))
            fail_msg("%s, expected %s", status_text(), bad[i].says);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* Overwrite bytes of a file. */
static void patch(const char *path, long at, const void *with, size_t size) {
    FILE *f = fopen(path, "r+b");
    assert_non_null(f);
    assert_int_equal(fseek(f, at, SEEK_END), 0);
    assert_int_equal(fwrite(with, 1, size, f), size);
    assert_int_equal(fclose(f), 0);
}

static void test_nodes(void **state) {
    (void)state;
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    float p[12][3];
    uint8_t is_node[12];
    const long values = 2L * 4 * NODES, marks = values + NODES, places = marks + 12L * NODES;
    const char *path = write_file("odd.curv", &both);
    patch(path, -(places - 12L * (FIRST + 7)), &(const float){INFINITY}, sizeof(float));
    patch(path, -(marks - (FIRST + 8)), "\2", 1);
    patch(path, -(marks - 3), "\4", 1);
    assert_int_equal(curvilinear_input_open(&m, path, NULL, &x), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->places(s->own, 1, 0, 1, p), ST_OK);
    assert_int_equal(s->places(s->own, 1, 1, 1, p), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "node 31 (counted from 0) has a place that is not"));
    assert_int_equal(s->blanks(s->own, 1, 0, 2, is_node), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "node 32 (counted from 0) has a mark that is none of"));
    assert_int_equal(s->blanks(s->own, 0, 0, 1, is_node), ST_CORRUPT);
    assert_non_null(strstr(status_text(), "node 3 "));
    assert_int_equal(s->blanks(s->own, 0, 1, 1, is_node), ST_OK);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

/* ---- faults ---- */

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE};
    const char *path = write_file("fault.curv", &both);
    for (int i = 0; i < 2; i++) {
        bool fired = true;
        long k = 1;
        for (; fired && k < 100; k++) {
            mem m;
            mem_init(&m, 0);
            curvilinear_input *x = NULL;
            fault_arm(kinds[i], k);
            const status st = open_bytes(&m, path, 0, &x);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            assert_int_equal(st == ST_OK, !fired);
            if (st == ST_OK)
                curvilinear_input_close(x);
            assert_int_equal(mem_used(&m), 0);
        }
        assert_true(k > (i ? 2 : 8) && k < 100);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip), cmocka_unit_test(test_stream),
        cmocka_unit_test(test_cut_stream), cmocka_unit_test(test_plain),
        cmocka_unit_test(test_headers),    cmocka_unit_test(test_nodes),
        cmocka_unit_test(test_faults),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
