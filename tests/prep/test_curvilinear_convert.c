/* test_curvilinear_convert.c - curvilinear grids to treelet files: each node and cell is the
 * input's, the bytes are those of a writer of the tests' own, whatever the threads; blanks, several
 * fields, steps that stay, move or come later; what verify finds; faults.
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/fault.h"
#include "formats/base/hexahedron.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_grow.h"
#include "formats/leaf/leaf_stats.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_verify.h"
#include "tests/support/curvilinear_steps.h"
#include "tests/support/fields.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

static mem m;

/* ---- grids ---- */

enum { ZONES_MAX = CURVILINEAR_STEPS_ZONES };

/* How a zone is made. */
typedef enum shape {
    PLAIN,
    LEFT = 1,       /* left-handed */
    BLANKED = 2,    /* nodes inside, the first ones, and two whole planes */
    NUMBERLESS = 4, /* some values are NaN or infinite */
    FOLDED = 8,     /* some nodes are far off */
    NOTHING = 16    /* all is blanked */
} shape;

typedef struct case_zone {
    uint32_t nodes[3];
    unsigned shape;
} case_zone;

typedef struct grid_case {
    const char *name;
    uint32_t zones;
    case_zone zone[ZONES_MAX];
} grid_case;

static const grid_case cases[] = {
    {"one cell", 1, {{{2, 2, 2}, PLAIN}}},
    {"one treelet", 1, {{{5, 33, 7}, PLAIN}}},
    {"a cell more", 1, {{{34, 3, 34}, LEFT}}},
    {"layers", 1, {{{4, 35, 98}, BLANKED}}},
    {"zones", 3, {{{9, 4, 3}, PLAIN}, {{3, 3, 70}, LEFT | BLANKED}, {{40, 5, 2}, FOLDED}}},
    {"numbers", 2, {{{6, 6, 40}, NUMBERLESS}, {{4, 4, 4}, NOTHING}}},
    {"odd", 1, {{{3, 2, 66}, BLANKED | NUMBERLESS | FOLDED}}},
};
enum { CASES = sizeof cases / sizeof *cases };

static bool is_blanked(const case_zone *c, uint32_t i, uint32_t j, uint32_t k) {
    if (c->shape & NOTHING)
        return true;
    return c->shape & BLANKED &&
           ((i < 2 && j == 0 && k < 2) || (i + j + k) % 11 == 4 || k / 2 == 9);
}

static void make_zone(const case_zone *c, curvilinear_zone *z) {
    const size_t all = (size_t)c->nodes[0] * c->nodes[1] * c->nodes[2];
    float(*p)[3] = malloc(all * sizeof *p), *values = malloc(all * sizeof *values);
    uint8_t *blank = c->shape & (BLANKED | NOTHING) ? malloc(all) : NULL;
    field_random r = {FIELD_SEED};
    assert_true(p && values);
    size_t n = 0;
    for (uint32_t k = 0; k < c->nodes[2]; k++)
        for (uint32_t j = 0; j < c->nodes[1]; j++)
            for (uint32_t i = 0; i < c->nodes[0]; i++, n++) {
                const double shake = 0.4, x = i + shake * field_random_unit(&r),
                             y = j + shake * field_random_unit(&r),
                             w = k + shake * field_random_unit(&r);
                p[n][0] = (float)(c->shape & LEFT ? -x : x);
                p[n][1] = (float)(y + sin(0.1 * w));
                p[n][2] = (float)w;
                values[n] = (float)(10.0 * field_random_unit(&r) - 5.0);
                if (c->shape & NUMBERLESS && n % 13 == 5)
                    values[n] = n % 2 ? NAN : INFINITY;
                if (c->shape & FOLDED && n % 17 == 3)
                    p[n][2] += 5.0f;
                if (blank)
                    blank[n] = is_blanked(c, i, j, k) ? 0 : n % 13 == 5 ? 3 : 1;
                if (blank && !blank[n]) /* what a solver leaves there */
                    p[n][0] = p[n][1] = values[n] = 1e30f;
            }
    *z = (curvilinear_zone){
        {c->nodes[0], c->nodes[1], c->nodes[2]}, (const float(*)[3])p, values, blank};
}

static void make(const grid_case *c, curvilinear_zone zones[ZONES_MAX]) {
    for (uint32_t z = 0; z < c->zones; z++)
        make_zone(&c->zone[z], &zones[z]);
}

static void release(const grid_case *c, curvilinear_zone zones[ZONES_MAX]) {
    for (uint32_t z = 0; z < c->zones; z++) {
        free((void *)zones[z].p);
        free((void *)zones[z].values);
        free((void *)zones[z].blank);
    }
}

/* ---- converting ---- */

static curvilinear_options options(int threads) {
    return (curvilinear_options){.file = {.run_align_log2 = 12, .histograms = true},
                                 .memory = 1 << 30,
                                 .threads = threads,
                                 .force = true};
}

static status try_convert(const curvilinear_steps *s, const char *name,
                          const curvilinear_options *o, curvilinear_result *r) {
    const status st = curvilinear_convert(&m, &s->series, "shapes", scratch_path(name), o, NULL, r);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

static curvilinear_result convert(const curvilinear_steps *s, const char *name, int threads) {
    const curvilinear_options o = options(threads);
    curvilinear_result r;
    if (try_convert(s, name, &o, &r) != ST_OK)
        fail_msg("%s", status_text());
    return r;
}

static leaf_file *open_file(const char *name) {
    leaf_file *f = NULL;
    if (leaf_file_open(&m, scratch_path(name), &f) != ST_OK)
        fail_msg("%s", status_text());
    return f;
}

/* ---- what is in the file ---- */

typedef struct at_treelet {
    const curvilinear_steps *s;
    leaf_file *f;
    leaf_unpacker *unpacker;
    uint32_t t, zone, first[3], cells[3];
    uint64_t cells_of[4]; /* so far, of each code */
} at_treelet;

static size_t node_of(const at_treelet *at, uint32_t i, uint32_t j, uint32_t k) {
    const uint32_t *nodes = at->s->zones[at->zone].nodes;
    return at->first[0] + i +
           (size_t)nodes[0] * (at->first[1] + j + (size_t)nodes[1] * (at->first[2] + k));
}

static float *load(const at_treelet *at, uint32_t p) {
    float *payload = aligned_alloc(64, leaf_layout_payload_max(&at->f->layout));
    assert_non_null(payload);
    if (leaf_file_load(at->f, p, at->unpacker, payload) != ST_OK)
        fail_msg("%s", status_text());
    return payload;
}

static unsigned code_of(const at_treelet *at, uint32_t step, uint32_t i, uint32_t j, uint32_t k) {
    const curvilinear_zone *z = &at->s->zones[at->zone];
    double p[HEX_CORNERS][3];
    for (uint32_t c = 0; c < HEX_CORNERS; c++) {
        const size_t n = node_of(at, i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        float place[3];
        if (z->blank && (!z->blank[n] || (c == 0 && z->blank[n] & 2)))
            return HEX_NONE;
        curvilinear_steps_place(at->s, at->zone, n, step, place);
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)place[a];
    }
    const int sense = hexahedron_sense((const double(*)[3])p);
    return sense > 0 ? HEX_RIGHT : sense < 0 ? HEX_LEFT : HEX_FOLDED;
}

static void check_codes(at_treelet *at, uint32_t step, const uint8_t *codes) {
    uint32_t n = 0;
    for (uint32_t k = 0; k < at->cells[2]; k++)
        for (uint32_t j = 0; j < at->cells[1]; j++)
            for (uint32_t i = 0; i < at->cells[0]; i++, n++) {
                const unsigned code = codes[n / 4] >> 2 * (n % 4) & 3;
                assert_int_equal(code, code_of(at, step, i, j, k));
                at->cells_of[code] += step == 0;
            }
}

static void check_places(at_treelet *at, uint32_t step) {
    const uint32_t nodes = curvilinear_nodes(at->cells);
    float *p = load(at, hex_treelet_places(&at->f->layout, step, at->t)), expected[3];
    uint32_t n = 0;
    for (uint32_t k = 0; k <= at->cells[2]; k++)
        for (uint32_t j = 0; j <= at->cells[1]; j++)
            for (uint32_t i = 0; i <= at->cells[0]; i++, n++) {
                const size_t stands =
                    curvilinear_file_stands(&at->s->zones[at->zone], node_of(at, i, j, k));
                curvilinear_steps_place(at->s, at->zone, stands, step, expected);
                for (uint32_t a = 0; a < 3; a++)
                    assert_true(p[a * nodes + n] == expected[a]);
            }
    check_codes(at, step, (const uint8_t *)(p + 3 * (size_t)nodes));
    free(p);
}

static void check_values(const at_treelet *at, uint32_t which, uint32_t step) {
    const leaf_layout *l = &at->f->layout;
    const curvilinear_zone *z = &at->s->zones[at->zone];
    float *v = load(at, leaf_layout_values(l, leaf_layout_set(l, which, step), at->t));
    uint32_t n = 0;
    for (uint32_t k = 0; k <= at->cells[2]; k++)
        for (uint32_t j = 0; j <= at->cells[1]; j++)
            for (uint32_t i = 0; i <= at->cells[0]; i++, n++) {
                const size_t node = node_of(at, i, j, k);
                const float expected = curvilinear_steps_value(at->s, at->zone, node, which, step);
                if ((z->blank && !z->blank[node]) || isnan(expected))
                    assert_true(isnan(v[n]));
                else
                    assert_true(v[n] == expected);
            }
    free(v);
}

static void check_treelet(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    at_treelet *at = ctx;
    const leaf_sets *sets = &at->s->series.sets;
    memcpy(at->first, first, sizeof at->first);
    memcpy(at->cells, cells, sizeof at->cells);
    for (uint32_t step = 0; step < sets->steps; step++) {
        check_places(at, step);
        for (uint32_t which = 0; which < sets->fields; which++)
            check_values(at, which, step);
    }
    at->t++;
}

static void check_file(const curvilinear_steps *s, const char *name, const curvilinear_result *r) {
    at_treelet at = {.s = s, .f = open_file(name)};
    assert_int_equal(leaf_unpacker_create(&m, at.f, &at.unpacker), ST_OK);
    for (at.zone = 0; at.zone < s->source.zones; at.zone++)
        curvilinear_zones_walk(s->zones[at.zone].nodes, check_treelet, &at);
    assert_int_equal(at.t, at.f->layout.treelets);
    assert_memory_equal(at.cells_of, r->cells, sizeof at.cells_of);
    if (leaf_verify(&m, at.f, 2, NULL) != ST_OK)
        fail_msg("%s", status_text());
    assert_int_equal(r->header.id[0], at.f->header.id[0]);
    leaf_unpacker_destroy(at.unpacker);
    leaf_file_close(at.f);
}

static void test_nodes_and_cells(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < CASES; i++) {
        curvilinear_zone zones[ZONES_MAX];
        curvilinear_steps s;
        make(&cases[i], zones);
        curvilinear_steps_init(&s, zones, cases[i].zones, 1, 1);
        const curvilinear_result r = convert(&s, "a.leaf", 1);
        check_file(&s, "a.leaf", &r);
        release(&cases[i], zones);
    }
}

/* Steps that move or stay; several fields. */
static void test_sets(void **state) {
    (void)state;
    static const struct {
        uint32_t fields, steps;
        bool moves;
    } sets[] = {{2, 1, false}, {1, 3, false}, {1, 2, true}, {3, 2, true}};
    for (size_t n = WATCHED_THREADS ? 3 : 0; n < sizeof sets / sizeof *sets; n++)
        for (int i = 0; i < CASES; i++) {
            curvilinear_zone zones[ZONES_MAX];
            curvilinear_steps s;
            make(&cases[i], zones);
            curvilinear_steps_init(&s, zones, cases[i].zones, sets[n].fields, sets[n].steps);
            s.moves = sets[n].moves;
            const curvilinear_result r = convert(&s, "a.leaf", 2);
            assert_int_equal(r.header.moving, sets[n].moves);
            check_file(&s, "a.leaf", &r);
            release(&cases[i], zones);
        }
}

/* ---- growing ---- */

/* Convert steps as a new file, or as further ones of it. */
static status put(const curvilinear_steps *s, bool grow, leaf_codec codec, curvilinear_result *r) {
    curvilinear_options o = options(2);
    o.grows = true;
    o.file.codec = codec;
    o.file.zstd_level = 1;
    status st = grow ? leaf_grow_open(&m, scratch_path("grown.leaf"), &o.grow) : ST_OK;
    if (st == ST_OK)
        st = curvilinear_convert(&m, &s->series, "shapes", scratch_path("grown.leaf"), &o, NULL, r);
    leaf_grow_close(o.grow);
    assert_int_equal(mem_used(&m), 0);
    return st;
}

/* One step, then two, then one: each is in the file as it was read, and places are there once. */
static void test_growing(void **state) {
    (void)state;
    static const uint32_t parts[] = {1, 2, 1};
    for (int i = 0; i < CASES; i++) {
        curvilinear_zone zones[ZONES_MAX];
        curvilinear_steps s;
        curvilinear_result r;
        uint64_t bytes[3];
        make(&cases[i], zones);
        curvilinear_steps_init(&s, zones, cases[i].zones, 2, 1);
        for (int k = 0; k < 3; k++, s.before += s.series.sets.steps) {
            s.series.sets.steps = parts[k];
            if (put(&s, k > 0, i % 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW, &r) != ST_OK)
                fail_msg("%s: %s", cases[i].name, status_text());
            bytes[k] = r.header.payload_bytes;
        }
        s.before = 0;
        s.series.sets.steps = 4;
        check_file(&s, "grown.leaf", &r);
        assert_true(bytes[2] < bytes[0]);
        release(&cases[i], zones);
    }
}

static void refused(const curvilinear_steps *s, const char *why) {
    size_t before, after;
    curvilinear_result r;
    char *bytes = scratch_read(scratch_path("grown.leaf"), &before);
    assert_int_equal(put(s, true, LEAF_CODEC_RAW, &r), ST_USAGE);
    assert_non_null(strstr(status_text(), why));
    char *now = scratch_read(scratch_path("grown.leaf"), &after);
    assert_int_equal(before, after);
    assert_memory_equal(now + LEAF_HEADER_BYTES, bytes + LEAF_HEADER_BYTES,
                        before - LEAF_HEADER_BYTES);
    free(bytes);
    free(now);
}

/* What is no further step, and leaves the file as it was. */
static void test_no_further_step(void **state) {
    (void)state;
    curvilinear_zone zones[ZONES_MAX], others[ZONES_MAX];
    curvilinear_steps s, t;
    curvilinear_result r;
    make(&cases[4], zones);
    make(&cases[4], others);
    curvilinear_steps_init(&s, zones, 3, 1, 1);
    curvilinear_steps_init(&t, others, 3, 1, 1);
    assert_int_equal(put(&s, false, LEAF_CODEC_RAW, &r), ST_OK);
    float *x = &((float(*)[3])(uintptr_t)others[2].p)[7][1];
    *x += 0.001f;
    refused(&t, "lie elsewhere, or are blanked otherwise");
    *x -= 0.001f;
    t.moves = true;
    t.series.sets.steps = 2;
    refused(&t, "nodes that move from step to step");
    assert_int_equal(put(&t, false, LEAF_CODEC_RAW, &r), ST_USAGE);
    curvilinear_steps_init(&t, others, 2, 1, 1);
    refused(&t, "it has 2 zones, expected 3");
    others[1].nodes[0] = 35, others[1].nodes[1] = 3, others[1].nodes[2] = 6;
    curvilinear_steps_init(&t, others, 3, 1, 1);
    refused(&t, "zone 1 has 35 x 3 x 6 nodes, expected 3 x 3 x 70");
    release(&cases[4], zones);
    release(&cases[4], others);
}

/* ---- histograms ---- */

/* All cells of small grids are drawn: those that are active at each edge of a bin, counted. */
static uint32_t count_active(const curvilinear_zone *z, double edge) {
    const uint32_t *n = z->nodes;
    uint32_t count = 0;
    for (uint32_t k = 0; k + 1 < n[2]; k++)
        for (uint32_t j = 0; j + 1 < n[1]; j++)
            for (uint32_t i = 0; i + 1 < n[0]; i++) {
                double lo = (double)INFINITY, hi = -(double)INFINITY;
                bool sound = true;
                for (uint32_t c = 0; c < HEX_CORNERS; c++) {
                    const size_t at =
                        i + (c & 1) + n[0] * (j + (c >> 1 & 1) + (size_t)n[1] * (k + (c >> 2)));
                    sound = sound && isfinite(z->values[at]) &&
                            (!z->blank || (z->blank[at] && (c > 0 || z->blank[at] == 1)));
                    lo = fmin(lo, (double)z->values[at]);
                    hi = fmax(hi, (double)z->values[at]);
                }
                count += sound && lo < edge && edge <= hi;
            }
    return count;
}

static void test_histograms(void **state) {
    (void)state;
    skip_under_thread();
    for (int i = 0; i < CASES; i++) {
        curvilinear_zone zones[ZONES_MAX];
        curvilinear_steps s;
        make(&cases[i], zones);
        curvilinear_steps_init(&s, zones, cases[i].zones, 1, 1);
        (void)convert(&s, "a.leaf", 2);
        leaf_file *f = open_file("a.leaf");
        const histogram *h = &f->histograms[0];
        assert_int_equal(h->total, curvilinear_directory_of(f)->first[f->layout.treelets]);
        for (uint32_t bin = 0; bin < h->bins; bin++) {
            uint32_t count = 0;
            for (uint32_t z = 0; z < cases[i].zones; z++)
                count += count_active(&zones[z], h->edges[bin]);
            assert_int_equal(h->active[bin], count);
            leaf_activity levels[LEAF_LEVELS_MAX];
            assert_int_equal(leaf_stats_activity(&m, f, 0, h->edges[bin], 2, NULL, levels), ST_OK);
            assert_int_equal(levels[0].cells, count);
        }
        leaf_file_close(f);
        release(&cases[i], zones);
    }
}

/* What two writers may tell apart: who made it. */
static void forget_maker(char *bytes) {
    leaf_header *h = (leaf_header *)(void *)bytes;
    memset(h->name, 0, sizeof h->name);
    memset(h->provenance, 0, sizeof h->provenance);
    memset(h->id, 0, sizeof h->id);
    h->checksum = 0;
}

static void test_bytes(void **state) {
    (void)state;
    for (int i = 0; i < CASES; i++) {
        curvilinear_zone zones[ZONES_MAX];
        curvilinear_steps s;
        size_t size;
        make(&cases[i], zones);
        curvilinear_steps_init(&s, zones, cases[i].zones, 1, 1);
        (void)convert(&s, "a.leaf", 1);
        (void)convert(&s, "b.leaf", 3);
        scratch_same(cases[i].name, scratch_path("a.leaf"), scratch_path("b.leaf"));
        curvilinear_options o = options(2);
        curvilinear_result r;
        o.file.histograms = false;
        assert_int_equal(try_convert(&s, "a.leaf", &o, &r), ST_OK);
        char *bytes = scratch_read(scratch_path("a.leaf"), &size);
        leaf_image image = curvilinear_file(zones, cases[i].zones);
        assert_int_equal(size, image.size);
        forget_maker(bytes);
        forget_maker(image.bytes);
        assert_memory_equal(bytes, image.bytes, size);
        free(bytes);
        free(image.bytes);
        release(&cases[i], zones);
    }
}

/* ---- verify ---- */

/* Of the first treelet of what is damaged. */
static const uint32_t damaged[3] = {4, 3, 32};

typedef void damage(const leaf_image *i, char *places, char *values);

static void turn_cell(const leaf_image *i, char *places, char *values) {
    (void)i, (void)values;
    ((uint8_t *)places)[12 * curvilinear_nodes(damaged)] ^= 3;
}

static void add_tail(const leaf_image *i, char *places, char *values) {
    (void)i, (void)values;
    places[curvilinear_place_bytes(damaged) - 1] = 1;
}

static void move_node(const leaf_image *i, char *places, char *values) {
    (void)i, (void)values;
    ((float *)(void *)places)[0] -= 0.5f;
}

/* The box is larger then. */
static void draw_in(const leaf_image *i, char *places, char *values) {
    float *x = (float *)(void *)places;
    uint32_t least = 0;
    (void)i, (void)values;
    for (uint32_t n = 1; n < curvilinear_nodes(damaged); n++)
        least = x[n] < x[least] ? n : least;
    x[least] = x[least + 1];
}

static void pull_node(const leaf_image *i, char *places, char *values) {
    (void)i, (void)values;
    memset(places, 0xff, sizeof(float));
}

static void change_value(const leaf_image *i, char *places, char *values) {
    (void)i, (void)places;
    ((float *)(void *)values)[5] = 100.0f;
}

static void lose_value(const leaf_image *i, char *places, char *values) {
    (void)i, (void)places;
    ((float *)(void *)values)[5] = NAN;
}

static void add_value_tail(const leaf_image *i, char *places, char *values) {
    (void)i, (void)places;
    values[4 * curvilinear_nodes(damaged)] = 1;
}

static void count_wrong(const leaf_image *i, char *places, char *values) {
    (void)places, (void)values;
    i->header->non_finite++;
}

static const struct {
    damage *apply;
    const char *told;
} damages[] = {
    {turn_cell, "bits are not those of its corners"},
    {add_tail, "expected 0 as padding"},
    {move_node, "its box is not that of its nodes"},
    {draw_in, "its box is not that of its nodes"},
    {pull_node, "a node is nowhere"},
    {change_value, "its range is not that of its values"},
    {lose_value, "about what is not finite"},
    {add_value_tail, "expected 0 as padding"},
    {count_wrong, "NaN or infinite"},
};

static void test_verify(void **state) {
    (void)state;
    skip_under_thread();
    const case_zone plain = {{5, 4, 34}, PLAIN};
    const grid_case c = {"plain", 1, {plain}};
    curvilinear_zone zones[ZONES_MAX];
    make(&c, zones);
    for (size_t n = 0; n < sizeof damages / sizeof *damages; n++) {
        leaf_image i = curvilinear_file(zones, 1);
        const uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
        leaf_file *f = NULL;
        damages[n].apply(&i, i.bytes + offsets[0], i.bytes + offsets[2]);
        leaf_image_seal_payloads(&i);
        leaf_image_seal(&i);
        scratch_write("c.leaf", i.bytes, i.size);
        status st = leaf_file_open(&m, scratch_path("c.leaf"), &f);
        st = st == ST_OK ? leaf_verify(&m, f, 1, NULL) : st;
        if (st != ST_CORRUPT || !strstr(status_text(), damages[n].told))
            fail_msg("%zu: %s", n, status_text());
        leaf_file_close(f);
        free(i.bytes);
    }
    release(&c, zones);
}

/* Bits of a cell that are not those of its corners, each way. */
static void test_verify_codes(void **state) {
    (void)state;
    skip_under_thread();
    const case_zone plain = {{5, 4, 34}, PLAIN};
    const grid_case c = {"plain", 1, {plain}};
    curvilinear_zone zones[ZONES_MAX];
    make(&c, zones);
    for (unsigned code = 0; code < 3; code++) {
        leaf_image i = curvilinear_file(zones, 1);
        const uint64_t *offsets = leaf_image_section(&i, LEAF_SECTION_OFFSETS);
        uint8_t *at = (uint8_t *)i.bytes + offsets[0] + 12 * curvilinear_nodes(damaged);
        leaf_file *f = NULL;
        const bool sound = (at[1] >> 2 & 3) == code;
        at[1] = (uint8_t)((at[1] & ~0xc) | code << 2);
        leaf_image_seal_payloads(&i);
        leaf_image_seal(&i);
        scratch_write("c.leaf", i.bytes, i.size);
        assert_int_equal(leaf_file_open(&m, scratch_path("c.leaf"), &f), ST_OK);
        assert_int_equal(leaf_verify(&m, f, 1, NULL), sound ? ST_OK : ST_CORRUPT);
        leaf_file_close(f);
        free(i.bytes);
    }
    release(&c, zones);
}

/* ---- refusals and faults ---- */

static void test_refusals(void **state) {
    (void)state;
    curvilinear_zone zones[ZONES_MAX];
    curvilinear_steps s;
    curvilinear_result r;
    const grid_case nothing = {"nothing", 1, {{{3, 3, 3}, NOTHING}}};
    make(&nothing, zones);
    curvilinear_steps_init(&s, zones, 1, 1, 1);
    curvilinear_options o = options(1);
    o.refuse_empty = true;
    assert_int_equal(try_convert(&s, "d.leaf", &o, &r), ST_UNSUPPORTED);
    assert_non_null(strstr(status_text(), "nothing to draw"));
    o = options(1);
    o.memory = 1000;
    assert_int_equal(try_convert(&s, "d.leaf", &o, &r), ST_NOMEM);
    assert_non_null(strstr(status_text(), "--memory"));
    release(&nothing, zones);
    make(&cases[0], zones);
    curvilinear_steps_init(&s, zones, 1, 1, 3);
    s.fails_from = 2;
    o = options(2);
    assert_int_equal(try_convert(&s, "d.leaf", &o, &r), ST_IO);
    release(&cases[0], zones);
}

/* The plan's memory is enough, and the budget is kept. */
static void test_budget(void **state) {
    (void)state;
    for (int i = 0; i < CASES; i++) {
        curvilinear_zone zones[ZONES_MAX];
        curvilinear_steps s;
        curvilinear_plan plan;
        curvilinear_result r;
        make(&cases[i], zones);
        curvilinear_steps_init(&s, zones, cases[i].zones, 2, 2);
        s.moves = true;
        curvilinear_options o = options(2);
        assert_int_equal(curvilinear_plan_make(&m, &s.series, &s.source, &o, &plan), ST_OK);
        m.limit = o.memory = plan.memory;
        assert_int_equal(try_convert(&s, "e.leaf", &o, &r), ST_OK);
        m.limit = 0;
        s.moves = false;
        assert_int_equal(put(&s, false, LEAF_CODEC_RAW, &r), ST_OK);
        o = options(2);
        o.grows = true;
        assert_int_equal(leaf_grow_open(&m, scratch_path("grown.leaf"), &o.grow), ST_OK);
        const size_t opened = mem_used(&m);
        assert_int_equal(curvilinear_plan_make(&m, &s.series, &s.source, &o, &plan), ST_OK);
        o.memory = plan.memory;
        m.limit = o.memory + opened; /* which is opened once more in the end */
        if (curvilinear_convert(&m, &s.series, "shapes", scratch_path("grown.leaf"), &o, NULL,
                                &r) != ST_OK)
            fail_msg("%s: %s", cases[i].name, status_text());
        m.limit = 0;
        leaf_grow_close(o.grow);
        release(&cases[i], zones);
    }
}

static void test_faults(void **state) {
    (void)state;
    static const fault_kind kinds[] = {FAULT_ALLOC, FAULT_WRITE, FAULT_READ, FAULT_THREAD};
    const int every = WATCHED ? 7 : 1;
    curvilinear_zone zones[ZONES_MAX];
    curvilinear_steps s;
    curvilinear_result r;
    make(&cases[4], zones);
    curvilinear_steps_init(&s, zones, cases[4].zones, 2, 2);
    s.moves = true;
    const curvilinear_options o = options(2);
    const size_t files = scratch_count();
    for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++) {
        bool fired = true;
        for (long n = 1; fired; n += every) {
            fault_arm(kinds[k], n);
            const status st = try_convert(&s, "f.leaf", &o, &r);
            fired = fault_fired(kinds[k]);
            fault_arm(kinds[k], 0);
            if (st != ST_OK)
                assert_true(fired && scratch_count() == files);
            else
                assert_int_equal(remove(scratch_path("f.leaf")), 0);
        }
    }
    release(&cases[4], zones);
}

int main(void) {
    mem_init(&m, 0);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_nodes_and_cells), cmocka_unit_test(test_sets),
        cmocka_unit_test(test_growing),         cmocka_unit_test(test_no_further_step),
        cmocka_unit_test(test_histograms),      cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_verify),          cmocka_unit_test(test_verify_codes),
        cmocka_unit_test(test_refusals),        cmocka_unit_test(test_budget),
        cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
