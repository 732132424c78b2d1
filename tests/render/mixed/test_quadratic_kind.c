/* test_quadratic_kind.c - files of quadratic tets, alone and beside hexahedra, drawn: surfaces
 * against brute force in long double; pieces, points and cells; compressed; files that lie.
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
#include "tests/support/pictures.h"
#include "tests/support/quadratic_file.h"
#include "tests/support/quadratic_truth.h"
#include "tests/support/scratch.h"
#include "tests/support/watched.h"

enum { TREELET = 60, CUBES = 5, CELLS = QUADRATIC_LAB_CELLS };

static quadratic_lab lab;

static const char *convert(int hexahedra, int zstd, const char *name) {
    leafcast_convert_options o = {.size = sizeof o};
    o.whole_cells = o.replace = true;
    o.treelet_tets = TREELET;
    o.zstd_level = zstd;
    quadratic_file_write(&lab, hexahedra, scratch_path("lab.mesh"));
    if (leafcast_convert_path(scratch_path("lab.mesh"), scratch_path(name), &o) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    return scratch_path(name);
}

static leafcast *open_lab(int index, int hexahedra) {
    quadratic_lab_make(&lab, index, FIELD_SEED + 6);
    return fixture_open(convert(hexahedra, 0, "lab.leaf"), NULL);
}

/* One by one, and in a picture. */
static void test_hits(void **state) {
    enum { RAYS = SLOW ? 4 : 60, SIDE = SLOW ? 3 : 12 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        hex_tally tally = {0};
        hex_judge j;
        leafcast *v = open_lab(n, n % 2 ? CUBES : 0);
        if (v->file->header.flat) { /* what folds has no interpolant of its own */
            assert_true(lab.may_be_folded);
            leafcast_close(v);
            continue;
        }
        const leafcast_camera c = leafcast_standard_view(v, 1.1, SIDE, SIDE);
        const leafcast_surface surface = leafcast_surface_default(lab.iso);
        assert_int_equal(leafcast_describe(v).cells, CELLS + (n % 2 ? CUBES : 0));
        hex_judge_open(&j, v);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        (void)hex_judge_picture(&j, v, lab.iso, &c, &tally);
        for (int i = 0; i < RAYS; i++) {
            bool special;
            const ray along = quadratic_lab_ray(&lab, &r, &special);
            if (!special)
                (void)hex_judge_ray(&j, v, lab.iso, along.o, along.d, &tally);
        }
        hex_tally_row(stdout, lab.name, &tally);
        assert_true(tally.surfaces > RAYS / 4 && tally.doubtful <= RAYS / 10);
        assert_int_equal(hex_tally_faults(&tally), 0);
        assert_true(tally.worst < 1e-10);
        leafcast_close(v);
        hex_judge_release(&j);
    }
}

static quadratic_tet numbered(leafcast *v, uint64_t number) {
    leafcast_cell told = {.size = sizeof told};
    quadratic_tet t;
    assert_int_equal(leafcast_get_cell(v, 0, number, &told), LEAFCAST_OK);
    assert_int_equal(told.corners, QUADRATIC_NODES);
    for (int n = 0; n < QUADRATIC_NODES; n++) {
        t.value[n] = (double)told.value[n] + 0.0;
        for (int a = 0; a < 3; a++)
            t.p[n][a] = told.position[n][a] + 0.0; /* no -0 */
    }
    return t;
}

static int by_bytes(const void *a, const void *b) {
    return memcmp(a, b, sizeof(quadratic_tet));
}

/* All cells are there, each once, node by node. */
static void test_cells(void **state) {
    static quadratic_tet want[CELLS], got[CELLS];
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        leafcast *v = open_lab(n, 0);
        for (int c = 0; c < CELLS; c++) {
            want[c] = quadratic_lab_cell(&lab, c, NULL);
            for (int k = 0; k < QUADRATIC_NODES; k++) {
                want[c].value[k] += 0.0;
                for (int a = 0; a < 3; a++)
                    want[c].p[k][a] += 0.0;
            }
            got[c] = numbered(v, (uint64_t)c);
        }
        qsort(want, CELLS, sizeof *want, by_bytes);
        qsort(got, CELLS, sizeof *got, by_bytes);
        assert_memory_equal(want, got, sizeof want);
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
static long judge_pieces(leafcast *v, const ray *r, field_random *random, double near) {
    static leafcast_segment got[PIECES];
    const leafcast_scene scene = leafcast_scene_default();
    long judged = 0;
    int count = 0;
    assert_int_equal(leafcast_probe_segments(v, &scene, r->o, r->d, got, PIECES, &count),
                     LEAFCAST_OK);
    assert_in_range(count, 0, PIECES - 1);
    for (int n = 0; n < count; n++) {
        const quadratic_tet t = numbered(v, got[n].cell);
        const double inside = field_random_in(random, 0.1, 0.9);
        const double now = got[n].t0 + inside * (got[n].t1 - got[n].t0);
        double point[3];
        long double at[3] = {0.25L, 0.25L, 0.25L}, truth;
        for (int a = 0; a < 3; a++)
            point[a] = r->o[a] + now * r->d[a];
        assert_true(n == 0 || got[n].t0 >= got[n - 1].t0);
        if (!quadratic_truth_value(&t, quadratic_straight_edges(&t), r->o, r->d, now, at, &truth))
            continue;
        /* In a sliver that is flat but for rounding; or the map takes that place twice. */
        bool elsewhere =
            (got[n].t1 - got[n].t0) < 1e-9 * lab.size || at[0] + at[1] + at[2] > 1.0L + 1e-6L;
        for (int a = 0; a < 3; a++)
            elsewhere = elsewhere || at[a] < -1e-6L;
        if (elsewhere)
            continue;
        assert_true(fabs(value_of(&got[n], inside) - (double)truth) < near);
        leafcast_sample sample = {.inside = false};
        assert_int_equal(leafcast_probe_point(v, point, &sample), LEAFCAST_OK);
        assert_true(sample.inside && fabs(sample.value - (double)truth) < near);
        judged++;
    }
    return judged;
}

static void test_pieces(void **state) {
    enum { RAYS = SLOW ? 4 : 40 };
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        field_random r = {FIELD_SEED + (uint64_t)n};
        long judged = 0;
        leafcast *v = open_lab(n, 0);
        const leaf_header *h = &v->file->header;
        for (int i = 0; i < RAYS && !h->flat; i++) {
            bool special;
            const ray along = quadratic_lab_ray(&lab, &r, &special);
            if (!special)
                judged += judge_pieces(v, &along, &r, 1e-6 * (h->value_max - h->value_min));
        }
        assert_true(h->flat || judged > 3 * RAYS);
        leafcast_close(v);
    }
}

/* Values and places beyond those of the nodes: in the file's ranges and boxes, and drawn. */
static void test_between_nodes(void **state) {
    (void)state;
    quadratic_lab_make(&lab, 0, FIELD_SEED);
    for (int k = 0; k < QUADRATIC_LAB_NODES; k++)
        for (int j = 0; j < QUADRATIC_LAB_NODES; j++)
            for (int i = 0; i < QUADRATIC_LAB_NODES; i++) {
                lab.value[k][j][i] = i == 1 ? 1.0F : i == 3 ? -1.0F : 0.0F;
                if (i == 0 && (j % 2 || k % 2))
                    lab.p[k][j][i][0] = -0.02F;
            }
    /* Along x the value is 4 u (1 - u) on edges from 0 to 1 to 0; coefficients reach 2, and -2. The
     * face at x = 0 is bent outward. */
    leafcast *v = fixture_open(convert(0, 0, "lab.leaf"), NULL);
    double range[2];
    assert_int_equal(leafcast_range(v, 0, 0, range), LEAFCAST_OK);
    assert_true(range[0] == -2.0 && range[1] == 2.0);
    assert_true(leafcast_describe(v).bounds[0][0] <= -0.039);
    leafcast_surface surface = leafcast_surface_default(0.9999);
    hex_tally tally = {0};
    hex_judge j;
    hex_judge_open(&j, v);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    for (int i = 0; i < 20; i++) {
        const double o[3] = {-1.0, 0.013 + 0.045 * i, 0.9 - 0.041 * i}, d[3] = {1.0, 0.0, 0.0};
        assert_true(hex_judge_ray(&j, v, surface.isovalue, o, d, &tally));
    }
    assert_true(tally.surfaces > 10);
    hex_judge_release(&j);
    leafcast_close(v);
}

/* Where the surface has values beyond those of all nodes of its cells, and where a face bulges
 * beyond the hull of the nodes, single rays and pictures find it. */
static void test_beyond_nodes(void **state) {
    enum { SIDE = 24 };
    static const float wave[] = {0.0F, 0.9F, 1.0F, 0.9F};
    (void)state;
    for (int bulge = 0; bulge < 2; bulge++) {
        quadratic_lab_make(&lab, 0, FIELD_SEED);
        for (int k = 0; k < QUADRATIC_LAB_NODES; k++)
            for (int j = 0; j < QUADRATIC_LAB_NODES; j++)
                for (int i = 0; i < QUADRATIC_LAB_NODES; i++) {
                    lab.value[k][j][i] = bulge ? (float)j : wave[i % 4];
                    if (bulge && i == 0 && (j % 2 || k % 2))
                        lab.p[k][j][i][0] = -0.3F;
                }
        leafcast *v = fixture_open(convert(0, 0, "lab.leaf"), NULL);
        const leafcast_surface surface = leafcast_surface_default(bulge ? 1.35 : 1.03);
        leafcast_camera c = leafcast_standard_view(v, 1.1, SIDE, SIDE);
        hex_tally tally = {0};
        hex_judge j;
        if (bulge) { /* what is beyond the nodes, nothing else, from below */
            const double eye[3] = {-0.45, -2.0, 0.5}, at[3] = {-0.45, 0.0, 0.5};
            memcpy(c.eye, eye, sizeof eye);
            memcpy(c.look_at, at, sizeof at);
            c.fov = 8.0; /* the hull ends at -0.3, the face at -0.4 */
        }
        hex_judge_open(&j, v);
        assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
        assert_true(hex_judge_picture(&j, v, surface.isovalue, &c, &tally));
        hex_tally_row(stdout, bulge ? "bulge" : "wave", &tally);
        assert_true(tally.surfaces > SIDE);
        hex_judge_release(&j);
        leafcast_close(v);
    }
}

/* The same pictures from compressed files, which are smaller, and sound. */
static void test_compressed(void **state) {
    static picture p[2];
    (void)state;
    for (int n = 0; n < quadratic_lab_count(); n++) {
        uint64_t bytes[2];
        quadratic_lab_make(&lab, n, FIELD_SEED + 7);
        for (int zstd = 0; zstd < 2; zstd++) {
            const char *path = convert(CUBES, zstd, zstd ? "packed.leaf" : "lab.leaf");
            leafcast *v = fixture_open(path, NULL);
            const leafcast_surface surface = leafcast_surface_default(lab.iso);
            const leafcast_scene scene = leafcast_scene_default();
            const leafcast_camera c = leafcast_standard_view(v, 1.1, PICTURE_WIDTH, PICTURE_HEIGHT);
            assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
            pictures_draw(v, &scene, &c, &p[zstd], NULL);
            bytes[zstd] = v->file->header.file_bytes;
            leafcast_close(v);
            mem m;
            leaf_file *f = NULL;
            mem_init(&m, 0);
            assert_int_equal(leaf_file_open(&m, path, &f), ST_OK);
            if (leaf_verify(&m, f, 1, NULL) != ST_OK)
                fail_msg("%s: %s", lab.name, status_text());
            leaf_file_close(f);
        }
        assert_memory_equal(p[0].z, p[1].z, sizeof p[0].z);
        assert_memory_equal(p[0].rgba, p[1].rgba, sizeof p[0].rgba);
        assert_true(bytes[1] < bytes[0]);
    }
}

/* ---- Files that lie ---- */

typedef struct lied {
    leaf_image image;
    mixed_shape shape;
    char *topology;
} lied;

static uint16_t *row_of(const lied *x, uint32_t i) {
    return (uint16_t *)(void *)(x->topology + x->shape.rows_at) + (size_t)CELL_ROW * i;
}

/* A tet with a node twice; one that is none any more; with its corners in another order. */
static void repeat_node(const lied *x) {
    row_of(x, 1)[5] = row_of(x, 1)[4];
}
static void make_linear(const lied *x) {
    row_of(x, 1)[9] = row_of(x, 1)[8];
}
static void turn_tet(const lied *x) {
    uint16_t *row = row_of(x, 1);
    const uint16_t kept = row[2];
    row[2] = row[3];
    row[3] = kept;
}

static void test_lies(void **state) {
    static void (*const lies[])(const lied *) = {repeat_node, make_linear, turn_tet};
    (void)state;
    quadratic_lab_make(&lab, 2, FIELD_SEED + 8);
    const char *path = convert(0, 0, "lab.leaf");
    for (size_t i = 0; i < sizeof lies / sizeof *lies; i++) {
        mem m;
        leaf_file *f = NULL;
        mem_init(&m, 0);
        size_t size;
        char *bytes = scratch_read(path, &size);
        lied x = {.image = leaf_image_of(bytes, size)};
        const uint64_t *offsets = leaf_image_section(&x.image, LEAF_SECTION_OFFSETS);
        const uint32_t(*counts)[4] = leaf_image_section(&x.image, LEAF_SECTION_COUNTS);
        x.shape = mixed_shape_of(counts[0]);
        x.topology = x.image.bytes + offsets[0];
        assert_int_equal(x.shape.quadratic, x.shape.cells);
        lies[i](&x);
        leaf_image_seal_payloads(&x.image);
        leaf_image_seal(&x.image);
        const char *lie = scratch_write("lie.leaf", x.image.bytes, x.image.size);
        assert_int_equal(leaf_file_open(&m, lie, &f), ST_OK);
        assert_int_equal(leaf_verify(&m, f, 1, NULL), ST_CORRUPT);
        assert_non_null(strstr(status_text(), "treelet 0"));
        leaf_file_close(f);
        free(x.image.bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hits),         cmocka_unit_test(test_cells),
        cmocka_unit_test(test_pieces),       cmocka_unit_test(test_between_nodes),
        cmocka_unit_test(test_beyond_nodes), cmocka_unit_test(test_compressed),
        cmocka_unit_test(test_lies),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
