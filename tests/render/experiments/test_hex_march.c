/* test_hex_march.c - rays from hexahedron to hexahedron, by both methods: what follows from a
 * linear field, the exact surface in a warped grid, every ray's cells in order of t, ways back into
 * a grid that is concave or closed around an axis, blanked cells; and the boundary's kd-tree
 * against all triangles. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "render/experiments/hex_march.h"
#include "tests/support/curvilinear_file.h"
#include "tests/support/fields.h"
#include "tests/support/fixture.h"

enum { SIDE = 9, LAYERS = 5, NODES = SIDE * SIDE * LAYERS, RAYS = 4000 };

/* ---- grids ---- */

/* A node's place by its parameters, each in [0, 1]; its value follows from the place. */
typedef void shape(const double at[3], double p[3]);

static void box(const double at[3], double p[3]) {
    for (int a = 0; a < 3; a++)
        p[a] = 2.0 * at[a] - 1.0;
}

/* A left-handed one. */
static void mirrored(const double at[3], double p[3]) {
    box(at, p);
    p[0] = -p[0];
}

static void warped(const double at[3], double p[3]) {
    box(at, p);
    const double x = p[0], y = p[1];
    p[0] += 0.06 * sin(3.0 * y + p[2]);
    p[1] += 0.06 * sin(3.0 * p[2] + x);
    p[2] += 0.06 * sin(3.0 * x + y);
}

/* Closed: its first and last cells along i touch. */
static void ring(const double at[3], double p[3]) {
    const double turn = 6.283185307179586 * (at[0] < 1.0 ? at[0] : 0.0), r = 0.5 + 0.5 * at[1];
    p[0] = r * cos(turn);
    p[1] = r * sin(turn);
    p[2] = at[2] - 0.5;
}

static double linear(const double p[3]) {
    return p[0] + 0.5 * p[1] - 0.25 * p[2];
}
static double bent(const double p[3]) {
    return vec3_dot(p, p);
}

typedef struct stage {
    mem m;
    hex_lattice lattice;
    hex_boundary boundary;
} stage;

/* hole: along i, the middle third of the cells is not there. */
static void set_stage(stage *s, shape *where, double (*value)(const double *), bool hole) {
    const uint32_t nodes[1][3] = {{SIDE, SIDE, LAYERS}};
    mem_init(&s->m, 0);
    assert_int_equal(hex_lattice_make(&s->lattice, &s->m, nodes, 1), ST_OK);
    const hex_zone *z = &s->lattice.zone[0];
    for (uint32_t i = 0; i < s->lattice.nodes; i++) {
        const uint32_t n[3] = {i % SIDE, i / SIDE % SIDE, i / (SIDE * SIDE)};
        double at[3], p[3];
        for (int a = 0; a < 3; a++)
            at[a] = (double)n[a] / (z->nodes[a] - 1);
        where(at, p);
        for (int a = 0; a < 3; a++)
            p[a] = s->lattice.node[i][a] = (float)p[a];
        s->lattice.node[i][3] = (float)value(p);
    }
    for (uint32_t i = 0; i < s->lattice.cells; i++)
        s->lattice.there[i] = !hole || (i % (SIDE - 1)) / 3 != 1;
    hex_lattice_finish(&s->lattice);
    hex_lattice_normals(&s->lattice, HEX_NORMALS_COLUMNS);
    assert_int_equal(hex_boundary_make(&s->boundary, &s->m, &s->lattice), ST_OK);
}

static void strike_stage(stage *s) {
    hex_boundary_free(&s->boundary);
    hex_lattice_free(&s->lattice);
    assert_int_equal(mem_used(&s->m), 0);
}

/* From a sphere around the grid to a point of a box inside of it. */
static void make_ray(field_random *r, double o[3], double d[3]) {
    double from[3], length = 0.0;
    while (!(length > 0.1 && length < 1.0)) {
        for (int a = 0; a < 3; a++)
            from[a] = 2.0 * field_random_unit(r) - 1.0;
        length = vec3_length(from);
    }
    for (int a = 0; a < 3; a++) {
        o[a] = 4.0 * from[a] / length;
        d[a] = 0.8 * (2.0 * field_random_unit(r) - 1.0) - o[a];
    }
}

/* ---- what rays do ---- */

typedef struct trail {
    double t, inside; /* where the ray is; how long it was in cells */
} trail;

static bool follow(void *ctx, uint32_t cell, const hex_crossing *from, const hex_crossing *to) {
    trail *t = ctx;
    (void)cell;
    assert_true(from->point.t >= t->t - 1e-3); /* zones: a patch and a triangle of the same face */
    assert_true(to->point.t >= from->point.t - 1e-9);
    t->inside += to->point.t - from->point.t;
    t->t = to->point.t;
    return true;
}

/* How long all rays together are in the grid. */
static hex_tally follow_rays(const stage *s, hex_way way, double *inside) {
    field_random r = {1};
    hex_tally tally = {0};
    const hex_marcher m = {&s->lattice, &s->boundary, way};
    *inside = 0.0;
    for (int i = 0; i < RAYS; i++) {
        double o[3], d[3];
        trail t = {0};
        make_ray(&r, o, d);
        hex_march(&m, o, d, follow, &t, &tally);
        *inside += t.inside * vec3_length(d);
    }
    return tally;
}

static hex_surface find(const stage *s, hex_way way, const double o[3], const double d[3],
                        double isovalue, hex_tally *tally) {
    const hex_marcher m = {&s->lattice, &s->boundary, way};
    hex_surface found = {.lattice = &s->lattice, .isovalue = isovalue};
    hex_march(&m, o, d, hex_surface_look, &found, tally);
    return found;
}

/* ---- tests ---- */

/* A plane in a box of cubes: where it is, and which way it faces, by arithmetic. */
static void judge_plane(shape *where) {
    stage s;
    double normal[3] = {-1.0, -0.5, 0.25};
    (void)vec3_unit(normal, normal);
    set_stage(&s, where, linear, false);
    hex_lattice_normals(&s.lattice, HEX_NORMALS_INVERSE); /* cells are no cubes along k */
    for (int way = 0; way < HEX_WAYS; way++) {
        field_random r = {2};
        hex_tally tally = {0};
        int met = 0;
        for (int i = 0; i < RAYS; i++) {
            double o[3], d[3];
            make_ray(&r, o, d);
            const double t = (0.2 - linear(o)) / linear(d);
            bool inside = t > 0.0, near = false;
            for (int a = 0; a < 3; a++) {
                inside = inside && fabs(o[a] + t * d[a]) < 1.0;
                near = near || fabs(fabs(o[a] + t * d[a]) - 1.0) < 1e-6;
            }
            const hex_surface f = find(&s, (hex_way)way, o, d, 0.2, &tally);
            assert_true(near || f.found == inside);
            if (!f.found || near)
                continue;
            met++;
            assert_true(fabs(f.t - t) < 1e-9); /* nodes and values are floats without rounding */
            assert_true(vec3_dot(f.normal, normal) > 1.0 - 1e-6);
        }
        assert_true(met > RAYS / 4);
        assert_int_equal(tally.lost, 0);
    }
    strike_stage(&s);
}

static void test_plane(void **state) {
    (void)state;
    judge_plane(box);
    judge_plane(mirrored);
}

/* All of the space between entry and exit is in cells, whichever way they are found. A few rays are
 * lost: where a face is seen from its edge, and in the ring, whose cells are wide wedges, where the
 * face opposite of the entry is turned away (hex_exit.h). None in a box. */
static void test_all_is_passed(void **state) {
    (void)state;
    static const struct {
        shape *where;
        unsigned lost[HEX_WAYS]; /* at most, of RAYS */
        double apart;
    } cases[] = {{box, {0, 0}, 1e-9},
                 {mirrored, {0, 0}, 1e-9},
                 {ring, {4, 4}, 1e-6},
                 {warped, {RAYS / 200, RAYS / 1000}, 5e-3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        stage s;
        double inside[HEX_WAYS];
        hex_tally n[HEX_WAYS];
        set_stage(&s, cases[i].where, linear, false);
        for (int way = 0; way < HEX_WAYS; way++) {
            n[way] = follow_rays(&s, (hex_way)way, &inside[way]);
            assert_true(n[way].lost <= cases[i].lost[way]);
        }
        assert_true(fabs(inside[0] - inside[1]) <= cases[i].apart * inside[0]);
        assert_true(n[HEX_HYBRID].cells > 4 * RAYS);
        strike_stage(&s);
    }
}

/* Lengths in a ring and in a box with a gap, by arithmetic; pieces as there are. */
static void test_again(void **state) {
    (void)state;
    stage s;
    set_stage(&s, ring, linear, false);
    for (int way = 0; way < HEX_WAYS; way++) {
        const hex_marcher m = {&s.lattice, &s.boundary, (hex_way)way};
        /* Along x, beside the seam and across the hole, then along the seam's normal. */
        const double o[2][3] = {{-3.0, 0.01, 0.02}, {0.75, -3.0, 0.02}};
        const double d[2][3] = {{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}};
        for (int i = 0; i < 2; i++) {
            hex_tally n = {0};
            trail t = {0};
            hex_march(&m, o[i], d[i], follow, &t, &n);
            assert_int_equal(n.entries, 2);
            assert_int_equal(n.lost, 0);
            if (i == 0) /* two walls of half a unit */
                assert_true(fabs(t.inside - 1.0) < 1e-6);
        }
    }
    strike_stage(&s);
    set_stage(&s, box, linear, true);
    for (int way = 0; way < HEX_WAYS; way++) {
        const hex_marcher m = {&s.lattice, &s.boundary, (hex_way)way};
        hex_tally n = {0};
        trail t = {0};
        hex_march(&m, (double[3]){-3.0, 0.03, 0.04}, (double[3]){1.0, 0.0, 0.0}, follow, &t, &n);
        assert_int_equal(n.entries, 2);
        assert_int_equal(n.cells, 5); /* of eight, three are not there */
        assert_true(fabs(t.inside - 1.25) < 1e-6);
    }
    strike_stage(&s);
}

/* The surface of the same grid by the product. Its file is made of the same floats. */
static void test_exact(void **state) {
    (void)state;
    stage s;
    set_stage(&s, warped, bent, false);
    static float p[NODES][3], values[NODES];
    for (uint32_t i = 0; i < s.lattice.nodes; i++) {
        memcpy(p[i], s.lattice.node[i], sizeof p[i]);
        values[i] = s.lattice.node[i][3];
    }
    const curvilinear_zone zone = {{SIDE, SIDE, LAYERS}, (const float(*)[3])p, values, NULL};
    leaf_image image = curvilinear_file(&zone, 1);
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    const leafcast_surface surface = leafcast_surface_default(0.5);
    const leafcast_scene scene = leafcast_scene_default();
    leafcast *v = NULL;
    assert_int_equal(leafcast_open_memory(image.bytes, image.size, &options, &v), LEAFCAST_OK);
    assert_int_equal(leafcast_select(v, &surface, 1), LEAFCAST_OK);
    field_random r = {3};
    hex_tally n[HEX_WAYS] = {{0}};
    int hits = 0, differ[HEX_WAYS] = {0};
    double sum[HEX_WAYS] = {0.0};
    for (int i = 0; i < RAYS; i++) {
        leafcast_ray ray = {.t1 = INFINITY};
        leafcast_ray_hit hit;
        make_ray(&r, ray.origin, ray.direction);
        assert_int_equal(leafcast_trace_rays(v, &scene, &ray, 1, &hit), LEAFCAST_OK);
        hits += isfinite(hit.t);
        for (int way = 0; way < HEX_WAYS; way++) {
            const hex_surface f = find(&s, (hex_way)way, ray.origin, ray.direction, 0.5, &n[way]);
            differ[way] += f.found != isfinite(hit.t);
            if (f.found && isfinite(hit.t))
                sum[way] += fabs(f.t - hit.t) * vec3_length(ray.direction);
        }
    }
    assert_true(hits > RAYS / 4);
    assert_int_equal(n[HEX_HYBRID].lost, 0);
    assert_true(differ[HEX_HYBRID] < hits / 50 && differ[HEX_PLUECKER] < hits / 50);
    /* Cells are 1/4 wide. Triangles are further off than patches. */
    assert_true(sum[HEX_HYBRID] / hits < 0.01 && sum[HEX_HYBRID] < sum[HEX_PLUECKER]);
    leafcast_close(v);
    free(image.bytes);
    strike_stage(&s);
}

/* ---- the boundary ---- */

/* The first entry behind t by all faces in turn. */
static double nearest_entry(const stage *s, const sheared_ray *r, double t) {
    double nearest = INFINITY;
    for (size_t f = 0; f < s->boundary.faces; f++) {
        const hex_boundary_face *face = &s->boundary.face[f];
        double place[4][3];
        const double *q[4] = {place[0], place[1], place[2], place[3]};
        int unused[4];
        hex_point p;
        for (int c = 0; c < 4; c++) {
            const float *x = s->lattice.node[face->node[c]];
            sheared_ray_place(r, (double[3]){x[0], x[1], x[2]}, place[c]);
        }
        const int out = hexahedron_face(face->face, unused) * s->lattice.zone[0].sense * r->sense;
        const double twice = (place[3][0] - place[0][0]) * (place[2][1] - place[1][1]) -
                             (place[3][1] - place[0][1]) * (place[2][0] - place[1][0]);
        if (out * twice < 0.0 && hex_exit_triangles(q, -out, &p) && p.t > t && p.t < nearest)
            nearest = p.t;
    }
    return nearest;
}

static void test_boundary(void **state) {
    (void)state;
    stage s;
    set_stage(&s, warped, linear, true);
    field_random r = {4};
    int met = 0;
    for (int i = 0; i < 300; i++) {
        double o[3], d[3];
        make_ray(&r, o, d);
        const double after = i % 2 ? 0.0 : 0.9;
        const sheared_ray ray = sheared_ray_of(o, d);
        const double nearest = nearest_entry(&s, &ray, after);
        hex_entry e;
        const bool found = hex_boundary_next(&s.boundary, &ray, o, d, after, &e);
        assert_int_equal(found, nearest < INFINITY);
        met += found;
        assert_true(!found || fabs(e.point.t - nearest) < 1e-12);
    }
    assert_true(met > 200);
    strike_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plane),         cmocka_unit_test(test_boundary),
        cmocka_unit_test(test_all_is_passed), cmocka_unit_test(test_again),
        cmocka_unit_test(test_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
