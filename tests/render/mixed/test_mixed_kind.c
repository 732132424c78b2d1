/* test_mixed_kind.c - files of mixed meshes, drawn: surfaces against brute force in long double;
 * the structured grid's, to the bit, where all cells are its hexahedra; any budget; pieces, points
 * and cells; files that lie.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/leaf/leaf_verify.h"
#include "formats/leaf/mixed_geometry.h"
#include "prep/leafcast_prep.h"
#include "render/ray/open_volume.h"
#include "tests/support/curvilinear_file.h"
#include "tests/support/fixture.h"
#include "tests/support/hex_judge.h"
#include "tests/support/hex_truth.h"
#include "tests/support/mixed_file.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { HITS = 256, TREELET = 60 };

static cell_mix mix;

static leafcast *open_mix(const cell_mix *m, const leafcast_options *o) {
    mesh_result result;
    (void)mixed_file_write(m->cell, m->count, scratch_path("mix.vtk"));
    mixed_file_convert(scratch_path("mix.vtk"), scratch_path("mix.leaf"), TREELET,
                       UINT64_C(1) << 32, &result);
    assert_int_equal(result.header.tets + result.header.repeated, m->count);
    return fixture_open(scratch_path("mix.leaf"), o);
}

/* Labs whose cells are sound: what folds has no interpolant of its own. */
static bool is_sound(int lab) {
    hex_lab s;
    hex_lab_make(&s, lab, 1);
    return !s.may_be_folded;
}

/* One by one, and in a picture. */
static void test_hits(void **state) {
    enum { RAYS = SLOW ? 4 : 60, SIDE = SLOW ? 3 : 12 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        hex_tally tally = {0};
        hex_judge j;
        if (!is_sound(n))
            continue;
        cell_mix_make(&mix, n, FIELD_SEED + 6);
        hex_judge_mix(&j, &mix);
        leafcast *v = open_mix(&mix, NULL);
        const leafcast_camera c = leafcast_standard_view(v, 1.1, SIDE, SIDE);
        const leafcast_surface surface = leafcast_surface_default(mix.lab.iso);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        (void)hex_judge_picture(&j, v, mix.lab.iso, &c, &tally);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray along = hex_lab_ray(&mix.lab, &r, &special);
            if (!special)
                (void)hex_judge_ray(&j, v, mix.lab.iso, along.o, along.d, &tally);
        }
        hex_tally_row(stdout, mix.lab.name, &tally);
        assert_true(tally.surfaces > RAYS / 4 && tally.doubtful <= RAYS / 10);
        assert_int_equal(hex_tally_faults(&tally), 0);
        assert_true(tally.worst < 1e-10);
        leafcast_close(v);
        hex_judge_release(&j);
    }
}

/* ---- A mesh of a structured grid's hexahedra ---- */

static void open_both(const hex_lab *s, leafcast *both[2]) {
    enum { NODES = HEX_LAB_NODES * HEX_LAB_NODES * HEX_LAB_NODES };
    mesh_result result;
    const curvilinear_zone zone = {{HEX_LAB_NODES, HEX_LAB_NODES, HEX_LAB_NODES},
                                   (const float(*)[3])s->p,
                                   (const float *)s->value,
                                   NULL};
    cell_mix_whole(&mix, s);
    const leaf_image image = curvilinear_file(&zone, 1);
    both[0] = fixture_open(scratch_write("grid.leaf", image.bytes, image.size), NULL);
    free(image.bytes);
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("grid.vtk"));
    mixed_file_convert(scratch_path("grid.vtk"), scratch_path("hexes.leaf"), TREELET,
                       UINT64_C(1) << 32, &result);
    both[1] = fixture_open(scratch_path("hexes.leaf"), NULL);
}

/* Hits, to the bit; in pictures the grid's are drawn in tiles, the mesh's as single rays. */
static void test_structured(void **state) {
    enum { RAYS = SLOW ? 40 : 400 };
    static leafcast_hit hits[2][HITS];
    static picture pictures[2];
    (void)state;
    const leafcast_scene scene = leafcast_scene_default();
    for (int n = 0; n < hex_lab_count(); n++) {
        hex_lab s;
        leafcast *both[2];
        field_random r = {FIELD_SEED + (uint64_t)n};
        long met = 0;
        hex_lab_make(&s, n, FIELD_SEED + 7);
        open_both(&s, both);
        const leafcast_surface surface = leafcast_surface_default(s.iso);
        const leafcast_camera c =
            leafcast_standard_view(both[0], 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
        for (int i = 0; i < 2; i++) {
            assert_int_equal(leafcast_select(both[i], &surface, 1), LEAFCAST_OK);
            pictures_draw(both[i], &scene, &c, &pictures[i], NULL);
        }
        assert_memory_equal(pictures[0].z, pictures[1].z, sizeof pictures[0].z);
        assert_memory_equal(pictures[0].rgba, pictures[1].rgba, sizeof pictures[0].rgba);
        for (int k = 0; k < RAYS; k++) {
            bool special;
            const ray along = hex_lab_ray(&s, &r, &special);
            int count[2];
            for (int i = 0; i < 2; i++)
                assert_int_equal(
                    leafcast_probe_ray(both[i], &scene, along.o, along.d, hits[i], HITS, &count[i]),
                    LEAFCAST_OK);
            assert_int_equal(count[0], count[1]);
            for (int h = 0; h < count[0]; h++, met++)
                assert_memory_equal(&hits[0][h].t, &hits[1][h].t, sizeof hits[0][h].t);
        }
        assert_true(met > RAYS / 4);
        for (int i = 0; i < 2; i++)
            leafcast_close(both[i]);
    }
}

/* The same picture, to the bit, with room for a treelet or two, by any number of threads. */
static void test_budgets(void **state) {
    static picture whole, p;
    (void)state;
    cell_mix_make(&mix, 0, FIELD_SEED + 8);
    leafcast_scene scene = leafcast_scene_default();
    scene.shadows = true;
    for (int n = 0; n < 2; n++) {
        const leafcast_options o = {.size = sizeof o,
                                    .threads = 1 + n,
                                    .experiments = EXPERIMENTS(.treelet_limit = n ? 2 : 0)};
        leafcast *v = open_mix(&mix, &o);
        const leafcast_surface surface = leafcast_surface_default(mix.lab.iso);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
        pictures_draw(v, &scene, &c, n ? &p : &whole, NULL);
        leafcast_close(v);
    }
    assert_memory_equal(p.z, whole.z, sizeof p.z);
    assert_memory_equal(p.rgba, whole.rgba, sizeof p.rgba);
}

/* ---- Values ---- */

static hexahedron numbered(leafcast *v, uint64_t number) {
    leafcast_cell told = {.size = sizeof told};
    hexahedron h;
    assert_int_equal(leafcast_get_cell(v, 0, number, &told), LEAFCAST_OK);
    assert_int_equal(told.corners, HEX_CORNERS);
    for (int c = 0; c < HEX_CORNERS; c++) {
        h.value[c] = (double)told.value[c];
        for (int a = 0; a < 3; a++)
            h.p[c][a] = told.position[c][a];
    }
    return h;
}

/* 0 in the place of -0. */
static hexahedron plain(hexahedron h) {
    for (int c = 0; c < HEX_CORNERS; c++) {
        h.value[c] += 0.0;
        for (int a = 0; a < 3; a++)
            h.p[c][a] += 0.0;
    }
    return h;
}

static int by_cell(const void *a, const void *b) {
    return memcmp(a, b, sizeof(hexahedron));
}

/* All cells are there, each once. */
static void test_cells(void **state) {
    static hexahedron want[CELL_MIX_CELLS], got[CELL_MIX_CELLS];
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        cell_mix_make(&mix, n, FIELD_SEED + 9);
        leafcast *v = open_mix(&mix, NULL);
        assert_string_equal(leafcast_describe(v).kind, "mixed mesh");
        size_t count = 0;
        for (int c = 0; c < mix.count; c++)
            if (mixed_file_keeps(&mix.cell[c])) {
                want[count] = plain(cell_mix_hexahedron(&mix.cell[c], 0));
                got[count] = plain(numbered(v, count));
                count++;
            }
        assert_int_equal(leafcast_describe(v).cells, count);
        qsort(want, count, sizeof *want, by_cell);
        qsort(got, count, sizeof *got, by_cell);
        assert_memory_equal(want, got, count * sizeof *want);
        leafcast_close(v);
    }
}

static double value_of(const leafcast_segment *s, double at) {
    const double *b = s->control, rest = 1.0 - at;
    return rest * rest * rest * b[0] + 3.0 * rest * rest * at * b[1] + 3.0 * rest * at * at * b[2] +
           at * at * at * b[3];
}

enum { PIECES = 2048 };

/* Pieces have the cells' own values, by brute force, and follow one another; so does the value at a
 * point on the way. */
static void judge_ray(leafcast *v, const ray *r, field_random *random, double near, long *judged) {
    static leafcast_segment got[PIECES];
    const leafcast_scene scene = leafcast_scene_default();
    int count = 0;
    assert_int_equal(leafcast_probe_segments(v, &scene, r->o, r->d, got, PIECES, &count),
                     LEAFCAST_OK);
    assert_in_range(count, 0, PIECES - 1);
    for (int n = 0; n < count; n++) {
        const hexahedron h = numbered(v, got[n].cell);
        const double inside = field_random_in(random, 0.1, 0.9);
        const double t = got[n].t0 + inside * (got[n].t1 - got[n].t0);
        double point[3];
        long double at[3] = {0.4L, 0.4L, 0.4L}, truth;
        for (int a = 0; a < 3; a++)
            point[a] = r->o[a] + t * r->d[a];
        assert_true(n == 0 || got[n].t0 >= got[n - 1].t0);
        if (!hex_truth_value(h.p, h.value, r->o, r->d, t, at, &truth))
            continue;
        /* In a sliver that is flat but for rounding; or the map takes that place twice. */
        bool elsewhere = (got[n].t1 - got[n].t0) < 1e-9 * mix.lab.size;
        for (int a = 0; a < 3; a++)
            elsewhere = elsewhere || !(fabsl(at[a] - 0.5L) < 0.5L + 1e-6L);
        if (elsewhere)
            continue;
        assert_true(fabs(value_of(&got[n], inside) - (double)truth) < near);
        leafcast_sample sample = {.inside = false};
        assert_int_equal(leafcast_probe_point(v, point, &sample), LEAFCAST_OK);
        assert_true(sample.inside && fabs(sample.value - (double)truth) < near);
        ++*judged;
    }
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 4 : 40 };
    (void)state;
    for (int n = 0; n < hex_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        long judged = 0;
        if (!is_sound(n))
            continue;
        cell_mix_make(&mix, n, FIELD_SEED + 10);
        leafcast *v = open_mix(&mix, NULL);
        const leaf_header *h = &v->file->header;
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray along = hex_lab_ray(&mix.lab, &r, &special);
            if (!special)
                judge_ray(v, &along, &r, 1e-6 * (h->value_max - h->value_min), &judged);
        }
        assert_true(judged > 3 * RAYS);
        leafcast_close(v);
    }
}

/* ---- Files that lie ---- */

/* What is changed in the payloads of the first treelet. */
typedef struct lied {
    leaf_image image;
    mixed_shape shape;
    char *topology, *values;
} lied;

typedef void lie(const lied *x);

static void turn_cell(const lied *x) {
    x->topology[x->shape.codes_at] ^= 3;
}

static void add_code(const lied *x) {
    x->topology[x->shape.codes_at + (x->shape.cells + 3) / 4] = 1;
}

static void lose_corner(const lied *x) {
    uint16_t *corner = (uint16_t *)(void *)(x->topology + x->shape.rows_at);
    corner[HEX_CORNERS] = (uint16_t)x->shape.nodes;
}

/* Of all cells that have the last node, the one before takes its place. */
static void leave_node(const lied *x) {
    uint16_t *corner = (uint16_t *)(void *)(x->topology + x->shape.rows_at);
    for (uint32_t i = 0; i < HEX_CORNERS * x->shape.cells; i++)
        corner[i] = (uint16_t)(corner[i] - (corner[i] + 1U == x->shape.nodes));
}

static void swap_nodes(const lied *x) {
    uint16_t(*corners)[HEX_CORNERS] =
        (uint16_t(*)[HEX_CORNERS])(void *)(x->topology + x->shape.rows_at);
    const uint16_t first = corners[0][0];
    corners[0][0] = corners[0][1];
    corners[0][1] = first;
}

static void add_corner(const lied *x) {
    x->topology[x->shape.topology_bytes - 1] = 1;
}

static void move_node(const lied *x) {
    ((float *)(void *)x->topology)[0] -= 100.0f;
}

static void change_value(const lied *x) {
    ((float *)(void *)x->values)[3] = 100.0f;
}

static void lose_value(const lied *x) {
    ((float *)(void *)x->values)[3] = NAN;
}

static void count_cells(const lied *x) {
    uint32_t(*counts)[4] = leaf_image_section(&x->image, LEAF_SECTION_COUNTS);
    counts[0][0] = TREELET + 1;
}

static void count_nodes(const lied *x) {
    uint32_t(*counts)[4] = leaf_image_section(&x->image, LEAF_SECTION_COUNTS);
    counts[0][1] = 3;
}

static void count_more(const lied *x) {
    uint32_t(*counts)[4] = leaf_image_section(&x->image, LEAF_SECTION_COUNTS);
    counts[0][3] = 1;
}

static void count_quadratic(const lied *x) {
    uint32_t(*counts)[4] = leaf_image_section(&x->image, LEAF_SECTION_COUNTS);
    counts[0][2] = counts[0][0] + 1;
}

static void claim_cells(const lied *x) {
    x->image.header->tets++;
}

static void claim_folds(const lied *x) {
    x->image.header->flat = x->image.header->tets + 1;
}

static void claim_leaves(const lied *x) {
    x->image.header->leaf_tets = 4;
}

static void claim_codec(const lied *x) {
    x->image.header->codec = LEAF_CODEC_ZSTD + 1;
}

static void claim_zones(const lied *x) {
    x->image.header->zones = 1;
}

/* What verify says; and whether a file is drawn all the same: what rays would go astray by is found
 * when a treelet is loaded. */
static const struct {
    lie *tell;
    const char *told;
    bool drawn;
} lies[] = {
    {turn_cell, "bits are not those of its nodes", true},
    {add_code, "expected 0 as padding", true},
    {lose_corner, "a cell is at no node", false},
    {leave_node, "a node is at no cell", true},
    {swap_nodes, "nodes are not in the order of their first use", true},
    {add_corner, "expected 0 as padding", true},
    {move_node, "its box is not that of its nodes", false},
    {change_value, "its range is not that of its values", false},
    {lose_value, "about what is not finite", false},
    {count_cells, "cannot have so many cells", false},
    {count_nodes, "cannot have so many nodes", false},
    {count_more, "cannot have more than cells and nodes", false},
    {count_quadratic, "cannot have so many quadratic tets", false},
    {claim_cells, "expected the treelets'", false},
    {claim_folds, "of them folded", false},
    {claim_leaves, "leaf_tets", false},
    {claim_codec, "codec", false},
    {claim_zones, "expected 0 in a reserved place", false},
};

static lied lie_about(lie *tell) {
    size_t size;
    char *bytes = scratch_read(scratch_path("mix.leaf"), &size);
    lied x = {.image = leaf_image_of(bytes, size)};
    const uint64_t *offsets = leaf_image_section(&x.image, LEAF_SECTION_OFFSETS);
    const uint32_t(*counts)[4] = leaf_image_section(&x.image, LEAF_SECTION_COUNTS);
    x.shape = mixed_shape_of(counts[0]);
    x.topology = x.image.bytes + offsets[0];
    x.values = x.image.bytes + offsets[x.image.header->treelets];
    tell(&x);
    leaf_image_seal_payloads(&x.image);
    leaf_image_seal(&x.image);
    return x;
}

static bool is_drawn(const char *path) {
    leafcast *v = NULL;
    if (leafcast_open(path, NULL, &v) != LEAFCAST_OK)
        return false;
    static double rgba[4 * PICTURE_PIXELS];
    const leafcast_surface surface = leafcast_surface_default(mix.lab.iso);
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof image, .rgba = rgba};
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_status st = leafcast_trace(v, &scene, &c, &image, NULL, NULL, NULL);
    leafcast_close(v);
    assert_true(st == LEAFCAST_OK || st == LEAFCAST_CORRUPT);
    return st == LEAFCAST_OK;
}

static void test_lies(void **state) {
    mem m;
    (void)state;
    mem_init(&m, 0);
    cell_mix_make(&mix, 0, FIELD_SEED + 11);
    leafcast_close(open_mix(&mix, NULL));
    for (size_t n = 0; n < sizeof lies / sizeof *lies; n++) {
        lied x = lie_about(lies[n].tell);
        const char *path = scratch_write("lie.leaf", x.image.bytes, x.image.size);
        leaf_file *f = NULL;
        status st = leaf_file_open(&m, path, &f);
        st = st == ST_OK ? leaf_verify(&m, f, 1, NULL) : st;
        if (st == ST_OK || !strstr(status_text(), lies[n].told))
            fail_msg("%zu: %s", n, status_text());
        leaf_file_close(f);
        free(x.image.bytes);
        if (is_drawn(path) != lies[n].drawn)
            fail_msg("%zu: %s", n, lies[n].drawn ? "is not drawn" : "is drawn");
    }
}

/* ---- By the library ---- */

static void test_library(void **state) {
    (void)state;
    static const leafcast_convert_options plain = {.size = sizeof plain, .replace = true};
    cell_mix_make(&mix, 0, FIELD_SEED + 12);
    (void)mixed_file_write(mix.cell, mix.count, scratch_path("mix.vtk"));
    for (int i = 0; i < 4; i++) {
        const bool whole = i & 1;
        leafcast_convert_options o = plain;
        o.whole_cells = whole;
        o.zstd_level = i / 2;
        o.treelet_tets = TREELET;
        assert_int_equal(
            leafcast_convert_path(scratch_path("mix.vtk"), scratch_path("mix.leaf"), &o),
            LEAFCAST_OK);
        leafcast *v = fixture_open(scratch_path("mix.leaf"), NULL);
        const leafcast_info info = leafcast_describe(v);
        assert_string_equal(info.kind, whole ? "mixed mesh" : "mesh");
        assert_true(whole ? info.cells == (uint64_t)mix.count : info.cells > (uint64_t)mix.count);
        leafcast_close(v);
        mem m;
        leaf_file *f = NULL;
        mem_init(&m, 0);
        assert_int_equal(leaf_file_open(&m, scratch_path("mix.leaf"), &f), ST_OK);
        assert_int_equal(f->header.codec, i / 2 ? LEAF_CODEC_ZSTD : LEAF_CODEC_RAW);
        assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_OK);
        leaf_file_close(f);
    }
    leafcast_convert_options without[] = {plain, plain, plain};
    without[0].gradients = true;
    without[1].leaf_tets = 12;
    without[2].treelet_tets = MIXED_QUADRATIC_MAX + 1;
    for (size_t i = 0; i < sizeof without / sizeof *without; i++) {
        without[i].whole_cells = true;
        assert_int_equal(
            leafcast_convert_path(scratch_path("mix.vtk"), scratch_path("no.leaf"), &without[i]),
            LEAFCAST_USAGE);
        assert_non_null(strstr(leafcast_error_text(), "whole_cells"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hits),    cmocka_unit_test(test_structured),
        cmocka_unit_test(test_budgets), cmocka_unit_test(test_cells),
        cmocka_unit_test(test_pieces),  cmocka_unit_test(test_lies),
        cmocka_unit_test(test_library),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
