#include "tests/support/triangle_lab.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/triangle_geometry.h"
#include "prep/mesh/triangle_treelet.h"

static uint32_t add_point(triangle_lab *s, double x, double y, double z, double value) {
    const double p[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        s->xyz[s->points][a] = (float)p[a];
    s->value[s->points] = (float)value;
    return s->points++;
}

static void add_triangle(triangle_lab *s, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t v[3] = {a, b, c};
    assert_true(s->triangles < TRIANGLE_LAB_MAX);
    memcpy(s->corner[s->triangles++], v, sizeof v);
}

/* ---- Surfaces ---- */

/* A ball of rings and sectors. */
static void make_ball(triangle_lab *s, int rings, int sectors, const double radius[3],
                      const double at[3]) {
    const double pi = 3.14159265358979323846;
    const uint32_t first = s->points;
    for (int i = 1; i < rings; i++)
        for (int k = 0; k < sectors; k++) {
            const double u = pi * i / rings, v = 2.0 * pi * k / sectors;
            add_point(s, at[0] + radius[0] * sin(u) * cos(v), at[1] + radius[1] * sin(u) * sin(v),
                      at[2] + radius[2] * cos(u), sin(3.0 * u) + cos(2.0 * v));
        }
    const uint32_t top = add_point(s, at[0], at[1], at[2] + radius[2], 1.0),
                   bottom = add_point(s, at[0], at[1], at[2] - radius[2], -1.0);
    for (int k = 0; k < sectors; k++) {
        const uint32_t next = (uint32_t)((k + 1) % sectors), here = (uint32_t)k;
        add_triangle(s, top, first + here, first + next);
        for (int i = 0; i + 2 < rings; i++) {
            const uint32_t row = first + (uint32_t)(i * sectors), below = row + (uint32_t)sectors;
            add_triangle(s, row + here, below + here, below + next);
            add_triangle(s, row + here, below + next, row + next);
        }
        const uint32_t last = first + (uint32_t)((rings - 2) * sectors);
        add_triangle(s, bottom, last + next, last + here);
    }
    s->closed = true;
}

static void ball(triangle_lab *s, field_random *r) {
    (void)r;
    make_ball(s, 18, 24, (const double[3]){1.0, 1.0, 1.0}, (const double[3]){0.0, 0.0, 0.0});
}

/* Slivers, a thousand times as long as they are wide. */
static void needles(triangle_lab *s, field_random *r) {
    (void)r;
    make_ball(s, 4, 500, (const double[3]){0.3, 0.3, 60.0}, (const double[3]){5.0, -3.0, 1.0});
}

static void far_away(triangle_lab *s, field_random *r) {
    (void)r;
    make_ball(s, 16, 20, (const double[3]){40.0, 30.0, 20.0}, (const double[3]){4e6, -3e6, 1e6});
}

static void tiny(triangle_lab *s, field_random *r) {
    (void)r;
    make_ball(s, 12, 16, (const double[3]){1e-12, 2e-12, 1e-12}, (const double[3]){0.0, 0.0, 0.0});
}

/* A plane and a step in it, all coordinates whole numbers. */
static void tiles(triangle_lab *s, field_random *r) {
    enum { SIDE = 24 };
    for (int y = 0; y <= SIDE; y++)
        for (int x = 0; x <= SIDE; x++)
            add_point(s, x, y, x > SIDE / 2 ? 3.0 : 0.0, x + y);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            const uint32_t a = y * (SIDE + 1) + x, b = a + 1, c = a + SIDE + 1, d = c + 1;
            const bool turn = field_random_in(r, 0.0, 1.0) < 0.5;
            add_triangle(s, a, b, turn ? d : c);
            add_triangle(s, turn ? a : b, d, c);
        }
}

/* Triangles that share nothing, and cross each other. */
static void soup(triangle_lab *s, field_random *r) {
    for (int i = 0; i < 800; i++) {
        double at[3];
        for (int a = 0; a < 3; a++)
            at[a] = field_random_in(r, -1.0, 1.0);
        const double size = pow(10.0, field_random_in(r, -3.0, -0.3));
        const uint32_t first = s->points;
        for (int k = 0; k < 3; k++)
            add_point(s, at[0] + size * field_random_in(r, -1.0, 1.0),
                      at[1] + size * field_random_in(r, -1.0, 1.0),
                      at[2] + size * field_random_in(r, -1.0, 1.0), field_random_in(r, -2.0, 2.0));
        add_triangle(s, first, first + 1, first + 2);
    }
}

/* As STL has them: each triangle has points of its own. Some are there twice, some have no area. */
static void loose(triangle_lab *s, field_random *r) {
    static triangle_lab whole;
    memset(&whole, 0, sizeof whole);
    make_ball(&whole, 14, 18, (const double[3]){1.0, 0.7, 1.3}, (const double[3]){0.1, 0.2, 0.3});
    for (uint32_t i = 0; i < whole.triangles; i++) {
        const int times = field_random_in(r, 0.0, 1.0) < 0.1 ? 2 : 1;
        for (int n = 0; n < times; n++) {
            const uint32_t first = s->points;
            for (int k = 0; k < 3; k++) {
                const float *p = whole.xyz[whole.corner[i][k]];
                add_point(s, (double)p[0], (double)p[1], (double)p[2],
                          (double)whole.value[whole.corner[i][k]]);
            }
            add_triangle(s, first, first + 1, first + 2);
        }
    }
    const uint32_t a = add_point(s, 0.0, 0.0, 0.0, 0.0), b = add_point(s, 1.0, 1.0, 1.0, 0.0),
                   c = add_point(s, 0.5, 0.5, 0.5, 0.0), d = add_point(s, 1.0, 1.0, 1.0, 0.0);
    add_triangle(s, a, b, c);
    add_triangle(s, a, b, d);
}

/* Hundreds of triangles about one corner. */
static void fan(triangle_lab *s, field_random *r) {
    enum { BLADES = 700 };
    (void)r;
    const uint32_t hub = add_point(s, 0.125, 0.25, 0.5, 0.0);
    for (int k = 0; k < BLADES; k++) {
        const double v = 2.0 * 3.14159265358979323846 * k / BLADES;
        add_point(s, cos(v), sin(v), 0.3 * sin(5.0 * v), v);
    }
    for (uint32_t k = 0; k < BLADES; k++)
        add_triangle(s, hub, hub + 1 + k, hub + 1 + (k + 1) % BLADES);
}

static const struct {
    const char *name;
    void (*make)(triangle_lab *s, field_random *r);
} rows[] = {{"ball", ball},   {"needles", needles}, {"far away", far_away}, {"tiny", tiny},
            {"tiles", tiles}, {"soup", soup},       {"loose", loose},       {"fan", fan}};

int triangle_lab_count(void) {
    return sizeof rows / sizeof *rows;
}

static double distance(const float *p, const float *q) {
    double square = 0.0;
    for (int a = 0; a < 3; a++)
        square += ((double)p[a] - (double)q[a]) * ((double)p[a] - (double)q[a]);
    return sqrt(square);
}

void triangle_lab_measure(triangle_lab *s) {
    double lo[3], hi[3];
    s->size = s->edge = 0.0;
    memset(s->about, 0, sizeof s->about);
    for (int a = 0; a < 3; a++) {
        lo[a] = hi[a] = (double)s->xyz[0][a];
        for (uint32_t i = 1; i < s->points; i++) {
            lo[a] = fmin(lo[a], (double)s->xyz[i][a]);
            hi[a] = fmax(hi[a], (double)s->xyz[i][a]);
        }
        s->middle[a] = 0.5 * (lo[a] + hi[a]);
        s->size = fmax(s->size, hi[a] - lo[a]);
    }
    for (uint32_t i = 0; i < s->triangles; i++)
        for (int k = 0; k < 3; k++)
            s->edge += distance(s->xyz[s->corner[i][k]], s->xyz[s->corner[i][(k + 1) % 3]]);
    s->edge /= 3.0 * s->triangles;
    for (uint32_t i = 0; i < s->triangles; i++) {
        float middle[3];
        for (int a = 0; a < 3; a++) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++)
                sum += (double)s->xyz[s->corner[i][k]][a];
            middle[a] = (float)(sum / 3.0);
            s->about[i][a] = (double)middle[a];
        }
        for (int k = 0; k < 3; k++)
            s->about[i][3] = fmax(s->about[i][3], distance(middle, s->xyz[s->corner[i][k]]));
    }
}

void triangle_lab_make(triangle_lab *s, int n, uint64_t seed) {
    field_random r = {seed + (uint64_t)n};
    memset(s, 0, sizeof *s);
    s->name = rows[n].name;
    rows[n].make(s, &r);
    triangle_lab_measure(s);
}

/* ---- Rays ---- */

static void aim(double to[3], const double o[3], double d[3]) {
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        d[a] = to[a] - o[a];
        square += d[a] * d[a];
    }
    for (int a = 0; a < 3; a++)
        d[a] /= sqrt(square);
}

/* A point of a triangle: a corner, the middle of an edge, or anywhere. */
static void draw_target(const triangle_lab *s, field_random *r, double to[3]) {
    const uint32_t *v = s->corner[(uint32_t)field_random_in(r, 0.0, s->triangles)];
    double share[3] = {0.0, 0.0, 0.0};
    const double how = field_random_in(r, 0.0, 1.0);
    if (how < 0.2) {
        share[0] = 1.0;
    } else if (how < 0.4) {
        share[0] = share[1] = 0.5;
    } else {
        share[1] = field_random_in(r, 0.0, 1.0);
        share[2] = field_random_in(r, 0.0, 1.0 - share[1]);
        share[0] = 1.0 - share[1] - share[2];
    }
    for (int a = 0; a < 3; a++)
        to[a] = share[0] * (double)s->xyz[v[0]][a] + share[1] * (double)s->xyz[v[1]][a] +
                share[2] * (double)s->xyz[v[2]][a];
}

void triangle_lab_ray(const triangle_lab *s, field_random *r, double o[3], double d[3]) {
    const double how = field_random_in(r, 0.0, 1.0);
    double to[3];
    draw_target(s, r, to);
    if (how < 0.15) { /* along an axis */
        const int axis = (int)field_random_in(r, 0.0, 3.0);
        const double sign = field_random_in(r, -1.0, 1.0) < 0.0 ? -1.0 : 1.0;
        for (int a = 0; a < 3; a++) {
            d[a] = a == axis ? sign : 0.0;
            o[a] = to[a] - (a == axis ? sign * ldexp(1.0, ilogb(2.0 * s->size)) : 0.0);
        }
        return;
    }
    if (how < 0.25) { /* all but along some triangle */
        draw_target(s, r, o);
        double away[3];
        aim(to, o, away);
        if (isfinite(away[0])) {
            for (int a = 0; a < 3; a++)
                o[a] -= 2.0 * s->size * away[a];
            aim(to, o, d);
            return;
        }
    }
    do
        for (int a = 0; a < 3; a++)
            o[a] = s->middle[a] + s->size * field_random_in(r, -1.5, 1.5);
    while (o[0] == to[0] && o[1] == to[1] && o[2] == to[2]);
    aim(to, o, d);
}

/* ---- Files ---- */

void triangle_lab_convert(const triangle_lab *s, const char *path, uint32_t treelet,
                          const char *name, bool compressed, mesh_result *result) {
    mem m;
    mesh_gather g;
    mesh_options o = mesh_options_default();
    o.cells = &triangle_treelets;
    o.force = true;
    o.treelet_tets = treelet;
    o.threads = 2;
    o.memory = UINT64_C(1) << 30;
    if (compressed) {
        o.file.codec = LEAF_CODEC_ZSTD;
        o.file.zstd_level = 1;
    }
    mem_init(&m, o.memory);
    mesh_gather_init(&g, &m, path, 0, NULL);
    mesh_gather_cells(&g, TRIANGLE_CORNERS);
    *result = (mesh_result){0};
    strcpy(result->report.field, name);
    const mesh_sink sink = mesh_gather_sink(&g);
    assert_int_equal(sink.points(sink.ctx, 0, s->points, (const float(*)[3])s->xyz), ST_OK);
    assert_int_equal(sink.values(sink.ctx, 0, s->points, s->value), ST_OK);
    assert_int_equal(sink.triangles(sink.ctx, s->triangles, (const uint32_t(*)[3])s->corner),
                     ST_OK);
    assert_int_equal(mesh_gather_done(&g), ST_OK);
    assert_int_equal(mesh_convert_gathered(&m, &g, "lab", path, &o, NULL, result), ST_OK);
    assert_int_equal(mem_used(&m), 0);
}
