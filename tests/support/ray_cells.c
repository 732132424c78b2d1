#include "tests/support/ray_cells.h"

#include <math.h>
#include <string.h>

#include "tests/support/fields.h"

/* ---- pieces ---- */

static double sign(field_random *r) {
    return field_random_below(r, 2) ? 1 : -1;
}

/* 10 to a power in [lo, hi], as a power of two or not. */
static double magnitude(field_random *r, double lo, double hi) {
    return exp2(field_random_in(r, lo, hi) * 3.321928094887362);
}

static void unit_cell_at(ray_cell *c, double x, double y, double z) {
    const double lo[3] = {x, y, z};
    for (int a = 0; a < 3; a++) {
        c->lo[a] = lo[a];
        c->hi[a] = lo[a] + 1;
    }
}

static void random_samples(ray_cell *c, field_random *r) {
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)field_random_in(r, -1, 1);
    c->iso = field_random_in(r, -0.5, 0.5);
}

/* A ray through two random points of the cell, from `back` cells before the first one. */
static void random_ray(ray_cell *c, field_random *r, double back) {
    for (int a = 0; a < 3; a++) {
        double width = c->hi[a] - c->lo[a], p = c->lo[a] + width * field_random_unit(r);
        c->d[a] = width * field_random_in(r, -1, 1);
        c->o[a] = p - back * c->d[a];
    }
}

static void anywhere(ray_cell *c, field_random *r) {
    unit_cell_at(c, (double)field_random_below(r, 500), (double)field_random_below(r, 500),
                 (double)field_random_below(r, 500));
    random_samples(c, r);
    random_ray(c, r, field_random_in(r, 2, 50));
}

static double value_at(const ray_cell *c, double t) {
    double p[3], f = 0;
    for (int a = 0; a < 3; a++)
        p[a] = (c->o[a] + t * c->d[a] - c->lo[a]) / (c->hi[a] - c->lo[a]);
    for (int n = 0; n < 8; n++)
        f += (n & 1 ? p[0] : 1 - p[0]) * (n & 2 ? p[1] : 1 - p[1]) * (n & 4 ? p[2] : 1 - p[2]) *
             (double)c->samples[n];
    return f;
}

/* The t interval of the ray in the cell; empty when it passes by. */
static void interval(const ray_cell *c, double *t0, double *t1) {
    *t0 = 0;
    *t1 = INFINITY;
    for (int a = 0; a < 3; a++) {
        if (c->d[a] == 0)
            continue;
        double p = (c->lo[a] - c->o[a]) / c->d[a], q = (c->hi[a] - c->o[a]) / c->d[a];
        *t0 = fmax(*t0, fmin(p, q));
        *t1 = fmin(*t1, fmax(p, q));
    }
}

/* Where f has an extremum along the ray inside the cell; NaN when none is seen. */
static double find_extremum(const ray_cell *c) {
    double t0, t1;
    interval(c, &t0, &t1);
    enum { STEPS = 24 };
    double h = (t1 - t0) / STEPS;
    for (int i = 1; i < STEPS; i++) {
        double t = t0 + i * h, before = value_at(c, t) - value_at(c, t - h),
               after = value_at(c, t + h) - value_at(c, t);
        if (!(before * after < 0))
            continue;
        double a = t - h, b = t + h, up = before > 0 ? 1 : -1;
        for (int n = 0; n < 100; n++) {
            double p = a + (b - a) / 3, q = b - (b - a) / 3;
            if (up * value_at(c, p) < up * value_at(c, q))
                a = p;
            else
                b = q;
        }
        return (a + b) / 2;
    }
    return NAN;
}

/* A random cell whose f has an extremum along the ray. */
static double with_extremum(ray_cell *c, field_random *r) {
    double t = NAN;
    for (int tries = 0; tries < 1000 && isnan(t); tries++) {
        anywhere(c, r);
        t = find_extremum(c);
    }
    return t;
}

/* Samples that make f (x - a)(x - b)(x - c) on the main diagonal: the cubic's blossom. */
static void blossom_samples(ray_cell *c, const double root[3], double scale) {
    double e1 = root[0] + root[1] + root[2], e3 = root[0] * root[1] * root[2];
    double e2 = root[0] * root[1] + root[1] * root[2] + root[2] * root[0];
    for (int n = 0; n < 8; n++) {
        double x = n & 1, y = n >> 1 & 1, z = n >> 2;
        double f = x * y * z - e1 * (x * y + y * z + z * x) / 3 + e2 * (x + y + z) / 3 - e3;
        c->samples[n] = (float)(scale * f);
    }
    c->iso = 0;
}

static void main_diagonal(ray_cell *c, field_random *r) {
    double back = (double)(1 + field_random_below(r, 8)), way = sign(r);
    for (int a = 0; a < 3; a++) {
        c->d[a] = way;
        c->o[a] = (way > 0 ? c->lo[a] : c->hi[a]) - back * way;
    }
}

/* ---- cases: roots ---- */

static void any(ray_cell *c, field_random *r) {
    anywhere(c, r);
}

/* The isovalue is the extremum of f along the ray, or next to it by 1e-17 to 1e-2. */
static void double_root(ray_cell *c, field_random *r) {
    double t = with_extremum(c, r);
    c->iso = value_at(c, t);
    if (field_random_below(r, 4))
        c->iso += sign(r) * magnitude(r, -17, -2);
}

/* The ray is moved sideways until it just touches, and a little on. */
static void near_tangent(ray_cell *c, field_random *r) {
    double t = with_extremum(c, r), f = value_at(c, t), h = 1e-4;
    c->iso = f + sign(r) * magnitude(r, -9, -3);
    int a = (int)field_random_below(r, 3);
    c->o[a] += h;
    double slope = (value_at(c, t) - f) / h;
    c->o[a] +=
        (c->iso - f) / slope - h + (field_random_below(r, 2) ? sign(r) * magnitude(r, -9, -4) : 0);
    if (!(fabs(slope) > 1e-3))
        anywhere(c, r);
}

static void triple_root(ray_cell *c, field_random *r) {
    unit_cell_at(c, (double)field_random_below(r, 50), (double)field_random_below(r, 50), 3);
    double middle = field_random_in(r, 0.1, 0.9), apart = magnitude(r, -6, -1), root[3];
    for (int i = 0; i < 3; i++)
        root[i] = middle + (field_random_below(r, 3) ? apart * (i - 1) : 0);
    blossom_samples(c, root, sign(r) * magnitude(r, -3, 3));
    main_diagonal(c, r);
    if (field_random_below(r, 2))
        c->o[field_random_below(r, 3)] += sign(r) * magnitude(r, -12, -3);
}

static void three_surfaces(ray_cell *c, field_random *r) {
    unit_cell_at(c, 7, (double)field_random_below(r, 50), 3);
    double root[3];
    for (int i = 0; i < 3; i++)
        root[i] = field_random_in(r, i / 3.0, (i + 1) / 3.0);
    blossom_samples(c, root, sign(r));
    main_diagonal(c, r);
    for (int a = 0; a < 3; a++)
        c->d[a] *= 1 + field_random_in(r, -0.01, 0.01);
}

/* M08, figure 4.9: both ends on one side, the middle on the other. */
static void two_surfaces(ray_cell *c, field_random *r) {
    unit_cell_at(c, 2, 3, (double)field_random_below(r, 50));
    for (int n = 0; n < 8; n++) {
        int x = n & 1, y = n >> 1 & 1;
        c->samples[n] = (float)((x != y ? 1 : 0) + field_random_in(r, -0.02, 0.02));
    }
    c->iso = field_random_in(r, 0.1, 0.45);
    for (int a = 0; a < 3; a++) {
        c->d[a] = (a < 2 ? 1 : 0.1) * field_random_in(r, 0.9, 1.1);
        c->o[a] = c->lo[a] + (a < 2 ? 0 : 0.5) + field_random_in(r, -0.02, 0.02) - 3 * c->d[a];
    }
}

/* A saddle whose middle is at the isovalue: no gradient there. */
static void zero_gradient(ray_cell *c, field_random *r) {
    anywhere(c, r);
    double scale = magnitude(r, -2, 2), noise = field_random_below(r, 2) ? 0 : magnitude(r, -9, -2);
    for (int n = 0; n < 8; n++) {
        double x = (n & 1) - 0.5, y = (n >> 1 & 1) - 0.5, z = (n >> 2) - 0.5;
        c->samples[n] = (float)(scale * (x * y + y * z + noise * field_random_in(r, -1, 1)));
    }
    c->iso = 0;
    for (int a = 0; a < 3; a++) {
        double offset = field_random_below(r, 2) ? 0 : sign(r) * magnitude(r, -10, -1);
        c->o[a] = c->lo[a] + 0.5 + offset - 4 * c->d[a];
    }
}

/* Only one corner on the other side, and the ray near it. */
static void one_corner(ray_cell *c, field_random *r) {
    anywhere(c, r);
    int corner = (int)field_random_below(r, 8);
    double way = sign(r), depth = magnitude(r, -6, 0);
    for (int n = 0; n < 8; n++)
        c->samples[n] =
            (float)(c->iso + way * (n == corner ? -depth : field_random_in(r, 0.01, 1)));
    for (int a = 0; a < 3; a++) {
        double near = depth * field_random_in(r, 0, 0.7), p = corner >> a & 1 ? 1 - near : near;
        c->o[a] = c->lo[a] + p - 3 * c->d[a];
    }
}

/* ---- cases: values ---- */

static void scaled(ray_cell *c, field_random *r, double scale) {
    anywhere(c, r);
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)(scale * (double)c->samples[n]);
    c->iso *= scale;
}

static void tiny(ray_cell *c, field_random *r) {
    scaled(c, r, 1e-30);
}

static void huge(ray_cell *c, field_random *r) {
    scaled(c, r, field_random_below(r, 2) ? 1e30 : 3e38);
}

/* Differences that are denormal floats, about 0 or a small number. */
static void denormal(ray_cell *c, field_random *r) {
    anywhere(c, r);
    float base = field_random_below(r, 2) ? 0 : 0x1p-126f;
    for (int n = 0; n < 8; n++)
        c->samples[n] = base + (float)field_random_below(r, 100) * 0x1p-149f;
    c->iso = (double)base + 0x1p-149 * field_random_in(r, 0, 100);
}

static void wild(ray_cell *c, field_random *r) {
    anywhere(c, r);
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)(sign(r) * magnitude(r, -30, 30));
    c->iso = field_random_below(r, 2) ? 0 : sign(r) * magnitude(r, -30, 30);
}

/* Small differences on a large common value. */
static void large_base(ray_cell *c, field_random *r) {
    anywhere(c, r);
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)(1000 + 0.01 * (double)c->samples[n]);
    c->iso = 1000 + 0.01 * c->iso;
}

static void constant(ray_cell *c, field_random *r) {
    anywhere(c, r);
    for (int n = 1; n < 8; n++)
        c->samples[n] = c->samples[0];
    double iso = (double)c->samples[0];
    c->iso = field_random_below(r, 2) ? iso : nextafter(iso, iso + sign(r));
}

/* Most samples at the isovalue. */
static void plateau(ray_cell *c, field_random *r) {
    anywhere(c, r);
    c->iso = (double)(float)c->iso;
    for (int n = 0; n < 8; n++) {
        long what = field_random_below(r, 6);
        c->samples[n] = (float)(c->iso + (what == 0 ? -0.5 : what == 1 ? 0.5 : 0));
    }
}

/* Bytes, the isovalue one of them. */
static void bytes(ray_cell *c, field_random *r) {
    anywhere(c, r);
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)(100 + field_random_below(r, 5));
    c->iso = (double)(100 + field_random_below(r, 6));
}

/* ---- cases: places ---- */

static void far(ray_cell *c, field_random *r) {
    unit_cell_at(c, 1e6 + (double)field_random_below(r, 100), 1e6 - 1,
                 (double)field_random_below(r, 1000000));
    random_samples(c, r);
    random_ray(c, r,
               field_random_below(r, 2) ? field_random_in(r, 1, 10) : field_random_in(r, 1e5, 1e6));
}

/* Ten million to a thousand million cells from the origin, the ray's start beside it. */
static void farther(ray_cell *c, field_random *r) {
    const double scale = magnitude(r, 7, 9);
    unit_cell_at(c, floor(scale * field_random_in(r, -1, 1)),
                 floor(scale * field_random_in(r, -1, 1)), floor(scale));
    random_samples(c, r);
    random_ray(c, r, field_random_in(r, 1, 10));
}

static void aspect(ray_cell *c, field_random *r) {
    for (int a = 0; a < 3; a++) {
        c->lo[a] = field_random_in(r, -100, 100);
        c->hi[a] = c->lo[a] + magnitude(r, -1.5, 1.5);
    }
    random_samples(c, r);
    random_ray(c, r, field_random_in(r, 2, 50));
}

static void inside(ray_cell *c, field_random *r) {
    anywhere(c, r);
    random_ray(c, r, 0);
}

/* ---- cases: exact lines ---- */

/* A whole, half or quarter point of the cell, `exact` axes of it on planes. */
static void exact_point(const ray_cell *c, field_random *r, int on_planes, double p[3]) {
    int first = (int)field_random_below(r, 3);
    for (int n = 0; n < 3; n++) {
        int a = (first + n) % 3;
        double width = c->hi[a] - c->lo[a];
        p[a] = c->lo[a] + width * (n < on_planes ? (double)field_random_below(r, 2)
                                                 : (double)(1 + field_random_below(r, 3)) / 4);
    }
}

/* A ray through an exact point in an exact direction; still: how many axes do not move. */
static void exact_line(ray_cell *c, field_random *r, int on_planes, int still) {
    anywhere(c, r);
    for (int n = 0; n < 8; n++)
        c->samples[n] = (float)(field_random_below(r, 17) - 8);
    c->iso = (double)(field_random_below(r, 9) - 4) + (field_random_below(r, 2) ? 0 : 0.3);
    double p[3];
    exact_point(c, r, on_planes, p);
    int first = (int)field_random_below(r, 3);
    for (int n = 0; n < 3; n++) {
        int a = (first + n) % 3;
        c->d[a] = n < still ? (field_random_below(r, 2) ? 0.0 : -0.0)
                            : sign(r) * exp2((double)field_random_below(r, 3));
        c->o[a] = p[a] - 4 * c->d[a];
    }
}

static void in_plane(ray_cell *c, field_random *r) {
    exact_line(c, r, 1, 1);
}

static void along_edge(ray_cell *c, field_random *r) {
    exact_line(c, r, 2, 2);
}

static void through_vertex(ray_cell *c, field_random *r) {
    exact_line(c, r, 3, 0);
}

static void diagonal(ray_cell *c, field_random *r) {
    exact_line(c, r, 3, (int)field_random_below(r, 2));
    for (int a = 0; a < 3; a++) {
        double step = c->d[a] == 0 ? 0 : sign(r);
        c->o[a] += 4 * c->d[a] - 4 * step;
        c->d[a] = step;
    }
}

/* Starting on a face, an edge or a vertex. */
static void start_on_grid(ray_cell *c, field_random *r) {
    exact_line(c, r, 1 + (int)field_random_below(r, 3), (int)field_random_below(r, 3));
    for (int a = 0; a < 3; a++)
        c->o[a] += 4 * c->d[a];
}

/* Starting on the surface, or within 1e-16 to 1e-3 of it. */
static void start_on_surface(ray_cell *c, field_random *r) {
    anywhere(c, r);
    double t0, t1;
    interval(c, &t0, &t1);
    double t = field_random_in(r, t0, t1);
    c->iso = value_at(c, t);
    if (field_random_below(r, 2))
        t += sign(r) * magnitude(r, -16, -3);
    for (int a = 0; a < 3; a++)
        c->o[a] += t * c->d[a];
}

/* ---- the list ---- */

static const struct {
    const char *name;
    void (*make)(ray_cell *c, field_random *r);
} cases[] = {
    {"random", any},
    {"double-root", double_root},
    {"near-tangent", near_tangent},
    {"triple-root", triple_root},
    {"three-surfaces", three_surfaces},
    {"two-surfaces", two_surfaces},
    {"zero-gradient", zero_gradient},
    {"one-corner", one_corner},
    {"tiny", tiny},
    {"huge", huge},
    {"denormal", denormal},
    {"wild", wild},
    {"large-base", large_base},
    {"constant", constant},
    {"plateau", plateau},
    {"bytes", bytes},
    {"far", far},
    {"farther", farther},
    {"aspect", aspect},
    {"inside", inside},
    {"in-plane", in_plane},
    {"along-edge", along_edge},
    {"through-vertex", through_vertex},
    {"diagonal", diagonal},
    {"start-on-grid", start_on_grid},
    {"start-on-surface", start_on_surface},
};

int ray_cell_case_count(void) {
    return (int)(sizeof cases / sizeof cases[0]);
}

const char *ray_cell_case_name(int which) {
    return cases[which].name;
}

int ray_cell_case(const char *name) {
    for (int i = 0; i < ray_cell_case_count(); i++)
        if (strcmp(cases[i].name, name) == 0)
            return i;
    return -1;
}

void ray_cell_make(int which, uint64_t seed, uint64_t index, ray_cell *out) {
    field_random mix = {seed * 0x9e3779b97f4a7c15u + index};
    field_random r = {field_random_bits(&mix) ^ (uint64_t)which << 56};
    *out = (ray_cell){{0}, {0}, {0}, {0}, {0}, 0};
    cases[which].make(out, &r);
}
