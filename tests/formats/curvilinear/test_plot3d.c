/* test_plot3d.c - curvilinear grids of PLOT3D in every layout, to the bit; layouts that are in
 * doubt; what is refused; cut and damaged files, faults; fields of a flow; real data.
 */
/* marks: bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/curvilinear/curvilinear_input.h"
#include "formats/curvilinear/plot3d_flow.h"
#include "formats/curvilinear/plot3d_layout.h"
#include "tests/support/plot3d_files.h"
#include "tests/support/scratch.h"

enum { FORMS = 64, NODES = 3 * 4 * 5 };

static bool recognised(const char *path) {
    mem m;
    mem_init(&m, 0);
    byte_stream *s;
    bool known = false;
    assert_int_equal(byte_stream_open(&m, path, &s), ST_OK);
    assert_int_equal(curvilinear_input_recognise(s, &known), ST_OK);
    assert_int_equal(byte_stream_position(s), 0);
    byte_stream_close(s);
    assert_int_equal(mem_used(&m), 0);
    return known;
}

static status read_zone(const curvilinear_source *s, uint32_t z) {
    static float places[PLOT3D_FILES_ROOM][3], values[PLOT3D_FILES_ROOM];
    static uint8_t is_node[PLOT3D_FILES_ROOM];
    const uint32_t *n = s->nodes[z];
    if ((uint64_t)n[0] * n[1] > PLOT3D_FILES_ROOM)
        return ST_FAILED;
    status st = ST_OK;
    for (uint32_t k = 0; st == ST_OK && k < n[2]; k++) {
        st = s->places(s->own, z, k, 1, places);
        if (st == ST_OK)
            st = s->values(s->own, z, 0, k, 1, values);
        if (st == ST_OK && s->blanked)
            st = s->blanks(s->own, z, k, 1, is_node);
    }
    return st;
}

/* Open, read all, close. */
static status read_all(const char *path, const curvilinear_hints *hints) {
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x = NULL;
    status_describe(ST_OK, "%s", "");
    status st = curvilinear_input_open(&m, path, hints, &x);
    const curvilinear_source *s = st == ST_OK ? curvilinear_input_source(x) : NULL;
    for (uint32_t z = 0; st == ST_OK && z < s->zones; z++)
        st = read_zone(s, z);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    assert_true(st == ST_OK || status_text()[0]);
    return st;
}

static void refused(const char *path, const curvilinear_hints *hints, status want,
                    const char *said) {
    const status st = read_all(path, hints);
    if (st != want || !strstr(status_text(), said))
        fail_msg("status %d, expected %d; \"%s\", expected \"%s\"", st, want, status_text(), said);
}

/* ---- every layout ---- */

static void check_places(const plot3d_form *f, uint32_t z, uint32_t first, uint32_t count,
                         float (*p)[3]) {
    const uint64_t plane = (uint64_t)f->nodes[z][0] * f->nodes[z][1];
    for (uint64_t n = 0; n < count * plane; n++)
        for (uint32_t a = 0; a < 3; a++)
            assert_true(p[n][a] == (float)plot3d_number(f, z, first * plane + n, a));
}

static void check_values(const plot3d_form *f, uint32_t z, uint32_t number, uint32_t first,
                         uint32_t count, const float *v) {
    const uint64_t plane = (uint64_t)f->nodes[z][0] * f->nodes[z][1];
    for (uint64_t n = 0; n < count * plane; n++)
        assert_true(v[n] == (float)plot3d_number(f, z, first * plane + n, number));
}

static void check_planes(const plot3d_form *f, const curvilinear_source *s, uint32_t z,
                         uint32_t first, uint32_t count) {
    static const uint32_t numbers[] = {3, 7, 5, 9}; /* as open_all() takes them */
    float places[NODES][3], values[NODES];
    uint8_t is_node[NODES];
    assert_int_equal(s->places(s->own, z, first, count, places), ST_OK);
    check_places(f, z, first, count, places);
    for (uint32_t field = 0; field < s->fields; field++) {
        assert_int_equal(s->values(s->own, z, field, first, count, values), ST_OK);
        check_values(f, z, numbers[field], first, count, values);
    }
    if (!f->blanks)
        return;
    const uint64_t plane = (uint64_t)f->nodes[z][0] * f->nodes[z][1];
    assert_int_equal(s->blanks(s->own, z, first, count, is_node), ST_OK);
    for (uint64_t n = 0; n < count * plane; n++)
        assert_int_equal(is_node[n], plot3d_blank(z, first * plane + n) != 0);
}

static void check_form(const plot3d_form *f, bool told) {
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    const char *path = plot3d_write(f, PLOT3D_PART_GRID, "grid.bin");
    const curvilinear_hints hints = {
        .solutions = plot3d_one(plot3d_write(f, PLOT3D_PART_SOLUTION, "q.bin")),
        .functions = plot3d_one(plot3d_write(f, PLOT3D_PART_FUNCTIONS, "f.bin")),
        .layout = told ? plot3d_form_words(f) : NULL};
    assert_true(recognised(path));
    assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_OK);
    static const char *const names[] = {"density", "energy", "momentum_y", "function_2"};
    assert_int_equal(curvilinear_input_take(x, names, 4), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->zones, f->zones);
    assert_int_equal(s->fields, 4);
    assert_int_equal(s->blanked, f->blanks);
    const double *flow = curvilinear_input_conditions(x);
    assert_true(flow[0] == 2.5 && flow[1] == 3.5 && flow[2] == 4.5 && flow[3] == 5.5);
    for (uint32_t z = s->zones; z-- > 0;) {
        assert_memory_equal(s->nodes[z], f->nodes[z], sizeof f->nodes[z]);
        check_planes(f, s, z, 0, f->nodes[z][2]);
        for (uint32_t k = f->nodes[z][2]; k-- > 0;)
            check_planes(f, s, z, k, 1);
    }
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
}

/* C binary of planes is taken for the whole unless the layout says so. */
static void test_forms(void **state) {
    (void)state;
    for (unsigned bits = 0; bits < FORMS; bits++) {
        const plot3d_form f = plot3d_form_of(bits);
        if (f.records || !f.planes)
            check_form(&f, false);
        check_form(&f, true);
    }
}

/* Zones larger than a chunk, whose planes are not. */
static void test_large(void **state) {
    (void)state;
    static float places[9000][3], values[9000];
    for (unsigned planes = 0; planes < 2; planes++) {
        plot3d_form f = {.records = true, .zones = 1, .nodes = {{17, 23, 13}}, .planes = planes};
        const uint32_t *n = f.nodes[0];
        const curvilinear_hints hints = {
            .functions = plot3d_one(plot3d_write(&f, PLOT3D_PART_FUNCTIONS, "f.bin"))};
        mem m;
        mem_init(&m, 0);
        curvilinear_input *x;
        const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
        assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_OK);
        const curvilinear_source *s = curvilinear_input_source(x);
        assert_int_equal(s->places(s->own, 0, 1, n[2] - 1, places), ST_OK);
        check_places(&f, 0, 1, n[2] - 1, places);
        assert_int_equal(s->values(s->own, 0, 0, 0, n[2], values), ST_OK);
        check_values(&f, 0, 8, 0, n[2], values);
        curvilinear_input_close(x);
    }
}

/* Text, which is found without a word. */
static void test_text(void **state) {
    (void)state;
    for (unsigned bits = 0; bits < FORMS; bits += 4) {
        plot3d_form f = plot3d_form_of(bits);
        f.text = true;
        if (!f.planes)
            check_form(&f, false);
        check_form(&f, true);
    }
}

/* Text of other things, and of grids that are cut. */
static void test_text_refused(void **state) {
    (void)state;
    static const char *const others[] = {"1 2 3\n",
                                         "2 2 2\n0.5\n",
                                         "8 3 0 1\n1 0.5 0.5 0.5\n",
                                         "x 2 2 2",
                                         "2.0 2.0 2.0 1 2 3",
                                         "",
                                         "100 100 100\n1 2 3 4 5 6 7 8 9 10"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_false(recognised(scratch_text("a.xyz", others[i])));
    char table[8192] = "2 2 2\n";
    for (size_t at = strlen(table); at + 4 < sizeof table; at += 4)
        memcpy(table + at, "0.5 ", 5);
    assert_false(recognised(scratch_text("a.xyz", table)));
    plot3d_form f = plot3d_form_of(16);
    f.text = true;
    size_t size;
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
    bytes[size - 8] = ' '; /* it has words of several digits */
    refused(scratch_write("a.xyz", bytes, size), NULL, ST_CORRUPT, "how many it has");
    bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
    memcpy(bytes + size - 6, "what", 4);
    refused(scratch_write("a.xyz", bytes, size), NULL, ST_CORRUPT, "expected a number");
    /* Only a last number that lacks digits is not seen. */
    for (size_t cut = 0; cut < size - 30; cut += 11)
        assert_true(read_all(scratch_write("a.xyz", bytes, cut),
                             &(curvilinear_hints){.layout = "text,multi"}) != ST_OK);
    /* Text beside bytes, and words that contradict. */
    f = plot3d_form_of(0);
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    f.text = true;
    const curvilinear_hints hints = {
        .solutions = plot3d_one(plot3d_write(&f, PLOT3D_PART_SOLUTION, "q.txt"))};
    assert_int_equal(read_all(path, &hints), ST_OK);
    refused(path, &(curvilinear_hints){.layout = "text"}, ST_CORRUPT, "expected a number");
    plot3d_words w;
    assert_int_equal(plot3d_words_parse("text,f32", &w), ST_USAGE);
    assert_int_equal(plot3d_words_parse("binary,text", &w), ST_USAGE);
    assert_int_equal(plot3d_words_parse("blanks,text,multi", &w), ST_OK);
    char text[PLOT3D_LAYOUT_TEXT];
    assert_string_equal(plot3d_layout_print(PLOT3D_GRID, w.layout, text),
                        "text,blanks,multi,whole,3d");
}

/* ---- steps ---- */

static void put_float(uint8_t *to, float value) {
    uint32_t bits;
    memcpy(&bits, &value, 4);
    for (int i = 0; i < 4; i++)
        to[i] = (uint8_t)(bits >> (24 - 8 * i));
}

/* The solution of a step, in big-endian C binary of two zones: its time is 10 + 5 step, the first
 * node's density 100 + step. */
static const char *write_step(int step) {
    const plot3d_form f = plot3d_form_of(16);
    size_t size;
    char name[32];
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_SOLUTION, &size);
    snprintf(name, sizeof name, "q_%d.bin", step);
    put_float(bytes + 40, 10 + 5 * (float)step);
    put_float(bytes + 44, 100 + (float)step);
    return scratch_write(name, bytes, size);
}

static void check_step(curvilinear_input *x, int step) {
    float v[NODES];
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->values(s->own, 0, 0, 0, 1, v), ST_OK);
    assert_true(v[0] == 100 + (float)step);
    assert_true(curvilinear_input_conditions(x)[3] == 10 + 5 * step);
}

/* One solution a step, and a file of functions for all of them. */
static void test_steps(void **state) {
    (void)state;
    const plot3d_form f = plot3d_form_of(16);
    char *paths[4], grid[4096];
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    for (int i = 0; i < 4; i++)
        paths[i] = strdup(i < 3 ? write_step(i) : "/nowhere");
    snprintf(grid, sizeof grid, "%s", plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin"));
    curvilinear_hints hints = {.solutions = {paths, 3},
                               .functions =
                                   plot3d_one(plot3d_write(&f, PLOT3D_PART_FUNCTIONS, "f.bin")),
                               .step = 2};
    assert_int_equal(curvilinear_input_open(&m, grid, &hints, &x), ST_OK);
    const double *times;
    assert_true(curvilinear_input_may_have_steps(x) && curvilinear_input_still(x));
    assert_int_equal(curvilinear_input_steps(x, &times), 3);
    assert_true(times[0] == 10 && times[1] == 15 && times[2] == 20);
    check_step(x, 2);
    static const int order[] = {0, 1, 1, 2, 0};
    for (int i = 0; i < 5; i++) {
        assert_int_equal(curvilinear_input_seek(x, (uint32_t)order[i]), ST_OK);
        assert_int_equal(curvilinear_input_fields(x), PLOT3D_FLOWS + PLOT3D_FILES_FUNCTIONS);
        check_step(x, order[i]);
    }
    assert_int_equal(curvilinear_input_seek(x, 3), ST_USAGE);
    curvilinear_input_close(x);
    assert_int_equal(mem_used(&m), 0);
    /* Steps of functions alone have no times. */
    free(paths[2]);
    paths[2] = strdup(plot3d_write(&f, PLOT3D_PART_FUNCTIONS, "f.bin"));
    hints = (curvilinear_hints){.functions = {(char *[]){paths[2], paths[2]}, 2}};
    assert_int_equal(curvilinear_input_open(&m, grid, &hints, &x), ST_OK);
    assert_int_equal(curvilinear_input_steps(x, &times), 2);
    assert_null(times);
    curvilinear_input_close(x);
    /* What is wrong with a later step shows at once. */
    refused(grid, &(curvilinear_hints){.solutions = {paths, 2}, .step = 2}, ST_USAGE,
            "no step 2: there are 2");
    refused(grid, &(curvilinear_hints){.solutions = {paths, 3}}, ST_CORRUPT, "a PLOT3D solution");
    refused(grid, &(curvilinear_hints){.solutions = {paths + 3, 1}}, ST_IO, "/nowhere");
    free(paths[2]);
    paths[2] = strdup(paths[0]);
    refused(grid, &(curvilinear_hints){.solutions = {paths, 4}}, ST_IO, "/nowhere");
    refused(grid, &(curvilinear_hints){.solutions = {paths, 3}, .functions = {paths, 2}}, ST_USAGE,
            "3 solutions and 2 files of functions");
    for (int i = 0; i < 4; i++)
        free(paths[i]);
}

/* ---- doubts ---- */

static void test_several(void **state) {
    (void)state;
    /* 2 zones, or one of 2 x 2 x 7 nodes with IBLANK: 460 bytes in both cases. */
    plot3d_form f = {.multi = true, .zones = 2, .nodes = {{2, 7, 2}, {2, 2, 2}}};
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    assert_false(recognised(path));
    refused(
        path, &(curvilinear_hints){.layout = "big"}, ST_USAGE,
        "\"binary,big,f32,blanks,single,whole,3d\", \"binary,big,f32,no-blanks,multi,whole,3d\"");
    assert_int_equal(read_all(path, &(curvilinear_hints){.layout = "multi"}), ST_OK);
    assert_int_equal(
        read_all(path, &(curvilinear_hints){.layout = "binary,big,f32,no-blanks,multi,whole,3d"}),
        ST_OK);
    refused(path, &(curvilinear_hints){.layout = "f64"}, ST_CORRUPT,
            "fit no layout of those words");
}

static void test_words(void **state) {
    (void)state;
    plot3d_words w;
    assert_int_equal(plot3d_words_parse(NULL, &w), ST_OK);
    assert_int_equal(w.said, 0);
    assert_int_equal(plot3d_words_parse("records,little,whole", &w), ST_OK);
    assert_int_equal(w.said, PLOT3D_RECORDS | PLOT3D_LITTLE | PLOT3D_PLANES);
    assert_int_equal(w.layout, PLOT3D_RECORDS | PLOT3D_LITTLE);
    static const char *const bad[] = {"record",  "big,little", "big,,f32", "Big",
                                      "f32 f64", ",",          "bigger"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(plot3d_words_parse(bad[i], &w), ST_USAGE);
    char text[PLOT3D_LAYOUT_TEXT];
    for (unsigned layout = 0; layout < PLOT3D_LAYOUTS; layout++) {
        assert_int_equal(plot3d_words_parse(plot3d_layout_print(PLOT3D_GRID, layout, text), &w),
                         ST_OK);
        assert_int_equal(w.layout, layout);
        assert_int_equal(w.said, PLOT3D_LAYOUTS - 1);
    }
}

/* ---- refusals ---- */

static void test_refused(void **state) {
    (void)state;
    static const uint8_t flat[8 + 8 * 6] = {0, 0, 0, 2, 0, 0, 0, 3};
    const char *path = scratch_write("flat.bin", flat, sizeof flat);
    assert_true(recognised(path));
    refused(path, NULL, ST_UNSUPPORTED, "two dimensions");
    for (unsigned records = 0; records < 2; records++) {
        plot3d_form thin = {.records = records, .zones = 1, .nodes = {{3, 2, 1}}};
        path = plot3d_write(&thin, PLOT3D_PART_GRID, "thin.bin");
        refused(path, NULL, ST_UNSUPPORTED, "zone 1 has 3 x 2 x 1 nodes, expected 2 or more");
    }
    path = scratch_text("text.xyz", "2 2 2\n0 1 0 1 0 1 0 1\n");
    assert_false(recognised(path));
    refused(path, NULL, ST_UNSUPPORTED, "");
    assert_int_equal(read_all(scratch_write("empty", "", 0), NULL), ST_CORRUPT);
    refused(path, &(curvilinear_hints){.layout = "big"}, ST_CORRUPT, "its size of 22 bytes fit no");
}

static void test_places_not_finite(void **state) {
    (void)state;
    static const double bad[] = {NAN, INFINITY, 1e39, -3.5e38};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const plot3d_form f = {.wide = true, .little = true, .zones = 1, .nodes = {{3, 4, 5}}};
        size_t size;
        uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
        memcpy(bytes + 12 + 8 * (NODES + 1 + 3 * (2 + 4 * 3)), &bad[i], 8);
        refused(scratch_write("grid.bin", bytes, size), NULL, ST_CORRUPT,
                "zone 1: node 1 2 3: y is ");
    }
}

/* A value beyond floats becomes inf, as in meshes. */
static void test_values_beyond(void **state) {
    (void)state;
    const plot3d_form f = {.wide = true, .little = true, .zones = 1, .nodes = {{3, 4, 5}}};
    size_t size;
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_FUNCTIONS, &size);
    const double values[] = {1e39, -1e39, NAN, 1e-60, 0.1};
    memcpy(bytes + 16, values, sizeof values);
    const curvilinear_hints hints = {.functions = plot3d_one(scratch_write("f.bin", bytes, size))};
    mem m;
    mem_init(&m, 0);
    curvilinear_input *x;
    float v[NODES];
    assert_int_equal(curvilinear_input_open(&m, path, &hints, &x), ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->values(s->own, 0, 0, 0, 5, v), ST_OK);
    assert_true(v[0] == INFINITY && v[1] == -INFINITY && isnan(v[2]) && v[3] == 0 && v[4] == 0.1f);
    curvilinear_input_close(x);
}

/* ---- damage ---- */

static void test_cut(void **state) {
    (void)state;
    for (unsigned bits = 0; bits < FORMS; bits += 5) {
        const plot3d_form f = plot3d_form_of(bits);
        const curvilinear_hints hints = {.layout = plot3d_form_words(&f)};
        size_t size;
        uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
        int known = 0;
        for (size_t cut = 0; cut < size; cut++) {
            const char *path = scratch_write("cut.bin", bytes, cut);
            known += recognised(path);
            assert_true(read_all(path, &hints) != ST_OK);
        }
        /* Cut to what another layout of C binary needs: f32 or f64, with IBLANK or not, 2D, one
         * zone. */
        assert_true(known <= 16);
        bytes[size] = 0;
        const char *path = scratch_write("long.bin", bytes, size + 1);
        assert_false(recognised(path));
        assert_int_equal(read_all(path, &hints), ST_OK);
        bytes[size] = 1;
        assert_int_equal(read_all(scratch_write("long.bin", bytes, size + 1), &hints), ST_CORRUPT);
    }
}

static void test_solution_cut(void **state) {
    (void)state;
    static uint8_t padded[PLOT3D_FILES_ROOM + 4096];
    for (unsigned bits = 0; bits < FORMS; bits += 3) {
        const plot3d_form f = plot3d_form_of(bits);
        const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
        curvilinear_hints hints = {0};
        size_t size;
        const uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_SOLUTION, &size);
        for (size_t cut = 0; cut < size; cut += cut < 200 ? 1 : 37) {
            hints.solutions = plot3d_one(scratch_write("q.bin", bytes, cut));
            assert_true(read_all(path, &hints) != ST_OK);
        }
        memset(padded, 0, sizeof padded);
        memcpy(padded, bytes, size);
        /* So many zeros might be the half of a solution of f64. */
        hints.layout = plot3d_form_words(&f);
        hints.solutions = plot3d_one(scratch_write("q.bin", padded, size + 4095));
        assert_int_equal(read_all(path, &hints), ST_OK);
        hints.solutions = plot3d_one(scratch_write("q.bin", padded, size + 4096));
        refused(path, &hints, ST_CORRUPT, "expected a PLOT3D solution of the grid's ");
        padded[size + 4094] = 1;
        hints.solutions = plot3d_one(scratch_write("q.bin", padded, size + 4095));
        assert_int_equal(read_all(path, &hints), ST_CORRUPT);
    }
}

/* Files of another grid, and a grid that is given as its own solution. */
static void test_others(void **state) {
    (void)state;
    plot3d_form f = plot3d_form_of(16), other = f;
    other.nodes[1][2]++;
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    const char *q = plot3d_write(&other, PLOT3D_PART_SOLUTION, "q.bin");
    refused(path, &(curvilinear_hints){.solutions = plot3d_one(q)}, ST_CORRUPT,
            "2 zones, the first with 3 x 4 x 5 nodes");
    refused(path, &(curvilinear_hints){.solutions = plot3d_one(path)}, ST_CORRUPT,
            "a PLOT3D solution");
    refused(path, &(curvilinear_hints){.functions = plot3d_one(q)}, ST_CORRUPT,
            "a PLOT3D file of functions");
    refused(path, &(curvilinear_hints){.functions = plot3d_one("/nowhere")}, ST_IO, "/nowhere");
    /* Another number of functions in the second zone, and the bytes for it. */
    size_t size;
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_FUNCTIONS, &size);
    bytes[4 + 31]++;
    q = scratch_write("f.bin", bytes, size + 4 * 12);
    refused(path, &(curvilinear_hints){.functions = plot3d_one(q)}, ST_UNSUPPORTED,
            "zone 2 has 3 functions, expected 2");
}

/* Every byte of the head, and every length of a record, changed: an error or a grid. */
static void test_lies(void **state) {
    (void)state;
    static const uint8_t lies[] = {0, 1, 0x7f, 0x80, 0xff};
    for (unsigned bits = 0; bits < FORMS; bits++) {
        const plot3d_form f = plot3d_form_of(bits);
        const curvilinear_hints hints = {.layout = plot3d_form_words(&f)};
        size_t size;
        uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
        for (size_t at = 0; at < 60; at++)
            for (size_t i = 0; i < sizeof lies; i++) {
                const uint8_t was = bytes[at];
                const bool head = at < (f.multi ? 28U : 12U) + (!f.records ? 0U
                                                                : f.multi  ? 16U
                                                                           : 8U);
                bytes[at] = lies[i];
                const char *path = scratch_write("lie.bin", bytes, size);
                const status st = read_all(path, &hints);
                if (head && was != lies[i] && st == ST_OK)
                    fail_msg("%s: byte %zu: %d", hints.layout, at, lies[i]);
                bytes[at] = was;
            }
    }
}

static void test_lengths(void **state) {
    (void)state;
    plot3d_form f = {.records = true,
                     .multi = true,
                     .planes = true,
                     .zones = 2,
                     .nodes = {{3, 4, 2}, {2, 2, 3}}};
    size_t size;
    uint8_t *bytes = plot3d_bytes(&f, PLOT3D_PART_GRID, &size);
    size_t at = 12 + 24 + 8, checked = 0;
    for (uint32_t z = 0; z < 2; z++)
        for (uint32_t k = 0; k < f.nodes[z][2]; k++)
            for (int side = 0; side < 2; side++, checked++) {
                char said[64];
                snprintf(said, sizeof said, "byte %zu: a record's length of", at);
                bytes[at + 3] ^= 1;
                refused(scratch_write("bad.bin", bytes, size),
                        &(curvilinear_hints){.layout = "records"}, ST_CORRUPT,
                        checked ? said : "fit no layout");
                bytes[at + 3] ^= 1;
                at += side ? 4 : 4 + 12 * f.nodes[z][0] * f.nodes[z][1];
            }
    assert_int_equal(at, size);
    assert_int_equal(checked, 10);
    /* Those of a solution's conditions, too. */
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    bytes = plot3d_bytes(&f, PLOT3D_PART_SOLUTION, &size);
    bytes[44 + 3] ^= 1;
    const curvilinear_hints hints = {.solutions = plot3d_one(scratch_write("q.bin", bytes, size))};
    refused(path, &hints, ST_CORRUPT, "byte 44: a record's length of 17, expected 16");
}

static void check_faults(const plot3d_form *form) {
    const plot3d_form f = *form;
    const char *path = plot3d_write(&f, PLOT3D_PART_GRID, "grid.bin");
    const curvilinear_hints hints = {
        .solutions = plot3d_one(plot3d_write(&f, PLOT3D_PART_SOLUTION, "q.bin")),
        .functions = plot3d_one(plot3d_write(&f, PLOT3D_PART_FUNCTIONS, "f.bin")),
        .field = "mach"};
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_READ};
    for (int i = 0; i < 2; i++) {
        long k = 0;
        for (bool fired = true; fired; k += fired) {
            fault_arm(kinds[i], k + 1);
            const status st = read_all(path, &hints);
            fired = fault_fired(kinds[i]);
            fault_arm(kinds[i], 0);
            assert_true(fired ? st != ST_OK : st == ST_OK);
        }
        assert_true(k > 10);
    }
}

static void test_faults(void **state) {
    (void)state;
    plot3d_form f = plot3d_form_of(1 + 8 + 16);
    check_faults(&f);
    f = plot3d_form_of(8 + 16);
    f.text = true;
    check_faults(&f);
}

/* ---- fields of a flow ---- */

static const plot3d_flow *flow_named(const char *name) {
    for (int i = 0; i < PLOT3D_FLOWS; i++)
        if (strcmp(plot3d_flows[i].name, name) == 0)
            return &plot3d_flows[i];
    fail();
    return NULL;
}

static double flow_at(const char *name, const double q[5]) {
    double out[3];
    flow_named(name)->of(q, out);
    return out[0];
}

static void near(double a, double b) {
    if (!(fabs(a - b) <= 1e-12 * (1 + fabs(b))))
        fail_msg("%.17g, expected %.17g", a, b);
}

/* The free stream at a Mach number, and a gas of another density and pressure that moves in any
 * direction. */
static void test_flow(void **state) {
    (void)state;
    const double g = 1.4;
    for (double mach = 0; mach < 4; mach += 0.5) {
        const double q[5] = {1, 0, mach, 0, 1 / (g * (g - 1)) + mach * mach / 2};
        near(flow_at("pressure", q), 1 / g);
        near(flow_at("temperature", q), 1 / g);
        near(flow_at("sound_speed", q), 1);
        near(flow_at("mach", q), mach);
        near(flow_at("entropy", q), 0);
    }
    const double r = 0.25, p = 3, v[3] = {2, -3, 6}; /* |v| = 7 */
    const double q[5] = {r, r * v[0], r * v[1], r * v[2], p / (g - 1) + r * 49 / 2};
    double out[3];
    flow_named("velocity")->of(q, out);
    for (int a = 0; a < 3; a++)
        near(out[a], v[a]);
    near(flow_at("pressure", q), p);
    near(flow_at("temperature", q), p / r);
    near(flow_at("mach", q), 7 / sqrt(g * p / r));
    near(flow_at("entropy", q), (log(g * p) - g * log(r)) / (g - 1));
    near(flow_at("density", q), r);
    near(flow_at("energy", q), q[4]);
    const double vacuum[5] = {0, 1, 0, 0, 1}, cold[5] = {1, 2, 0, 0, 0};
    assert_false(isfinite(flow_at("velocity", vacuum)));
    assert_false(isfinite(flow_at("entropy", cold)));
    assert_false(isfinite(flow_at("mach", cold)));
}

/* ---- real data ---- */

static void check_real(const char *grid, const char *solution, const uint32_t nodes[3],
                       const char *lo, const char *hi) {
    char q[4096];
    const char *path = scratch_data(solution);
    if (!path)
        return;
    snprintf(q, sizeof q, "%s", path);
    path = scratch_data(grid);
    mem m;
    mem_init(&m, 1 << 20);
    curvilinear_input *x;
    assert_true(recognised(path));
    assert_false(recognised(q));
    assert_int_equal(
        curvilinear_input_open(&m, path, &(curvilinear_hints){.solutions = plot3d_one(q)}, &x),
        ST_OK);
    const curvilinear_source *s = curvilinear_input_source(x);
    assert_int_equal(s->zones, 1);
    assert_memory_equal(s->nodes[0], nodes, 3 * sizeof *nodes);
    assert_false(s->blanked);
    const size_t count = (size_t)nodes[0] * nodes[1] * nodes[2];
    float *values = malloc(count * sizeof *values), range[2] = {FLT_MAX, -FLT_MAX};
    assert_int_equal(s->values(s->own, 0, 0, 0, nodes[2], values), ST_OK);
    for (size_t i = 0; i < count; i++) {
        range[0] = fminf(range[0], values[i]);
        range[1] = fmaxf(range[1], values[i]);
    }
    free(values);
    char text[2][32];
    for (int i = 0; i < 2; i++)
        snprintf(text[i], sizeof text[i], "%.*f", (int)strlen(strchr(i ? hi : lo, '.')) - 1,
                 (double)range[i]);
    assert_string_equal(text[0], lo);
    assert_string_equal(text[1], hi);
    curvilinear_input_close(x);
}

static void test_real(void **state) {
    (void)state;
    check_real("bluntfin/bluntfinxyz.bin", "bluntfin/bluntfinq.bin", (const uint32_t[]){40, 32, 32},
               "0.1926", "4.9775");
    check_real("combustor/combxyz.bin", "combustor/combq.bin", (const uint32_t[]){57, 33, 25},
               "0.197813", "0.710419");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_forms),
        cmocka_unit_test(test_steps),
        cmocka_unit_test(test_text),
        cmocka_unit_test(test_text_refused),
        cmocka_unit_test(test_large),
        cmocka_unit_test(test_several),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_places_not_finite),
        cmocka_unit_test(test_values_beyond),
        cmocka_unit_test(test_cut),
        cmocka_unit_test(test_solution_cut),
        cmocka_unit_test(test_others),
        cmocka_unit_test(test_lies),
        cmocka_unit_test(test_lengths),
        cmocka_unit_test(test_faults),
        cmocka_unit_test(test_flow),
        cmocka_unit_test(test_real),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
