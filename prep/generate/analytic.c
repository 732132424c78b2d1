#include "prep/generate/analytic.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"

/* Column c of an axis' table. */
static const double *column(const analytic *a, int axis, int c) {
    return a->table[axis] + (size_t)c * a->dims[axis];
}

/* Value of column c at the strip's place on the y or z axis; values of the strip along the x
 * axis. */
static double at_y(const analytic *a, const analytic_strip *s, int c) {
    return column(a, 1, c)[s->j];
}

static double at_z(const analytic *a, const analytic_strip *s, int c) {
    return column(a, 2, c)[s->k];
}

static const double *along_x(const analytic *a, const analytic_strip *s, int c) {
    return column(a, 0, c) + s->i;
}

static void tabulate_square(const double *parameters, int axis, double x, double *out,
                            size_t stride) {
    (void)parameters;
    (void)axis;
    (void)stride;
    *out = x * x;
}

/* ---- Marschner and Lobb 1994: (1 - sin(pi z / 2) + alpha (1 + rho(r))) / (2 (1 + alpha)), rho(r)
 * = cos(2 pi fM cos(pi r / 2)) ---- */

#define ML_ALPHA     0.25
#define ML_FREQUENCY 6.0

static void tabulate_marschner_lobb(const double *parameters, int axis, double x, double *out,
                                    size_t stride) {
    (void)parameters;
    (void)stride;
    *out = axis == 2 ? 1 - portable_sin(x / 4) : x * x;
}

static void prepare_marschner_lobb(const analytic *a, const analytic_strip *s, double *shared) {
    const double *x2 = along_x(a, s, 0);
    double y2 = at_y(a, s, 0);
    for (uint32_t n = 0; n < s->width; n++) {
        double r = sqrt(x2[n] + y2);
        shared[n] = ML_ALPHA * (1 + portable_cos(ML_FREQUENCY * portable_cos(r / 4)));
    }
}

static void evaluate_marschner_lobb(const analytic *a, const analytic_strip *s,
                                    const double *shared, double *out) {
    double along_z = at_z(a, s, 0);
    for (uint32_t n = 0; n < s->width; n++)
        out[n] = (along_z + shared[n]) / (2 * (1 + ML_ALPHA));
}

/* ---- sphere: 1 - r / 2 ---- */

static void evaluate_sphere(const analytic *a, const analytic_strip *s, const double *shared,
                            double *out) {
    (void)shared;
    const double *x2 = along_x(a, s, 0);
    double yz2 = at_y(a, s, 0) + at_z(a, s, 0);
    for (uint32_t n = 0; n < s->width; n++)
        out[n] = 1 - 0.5 * sqrt(x2[n] + yz2);
}

/* ---- gyroid: sin X cos Y + sin Y cos Z + sin Z cos X, two periods per unit ---- */

static void tabulate_gyroid(const double *parameters, int axis, double x, double *out,
                            size_t stride) {
    (void)parameters;
    (void)axis;
    portable_sincos(2 * x, &out[0], &out[stride]);
}

static void evaluate_gyroid(const analytic *a, const analytic_strip *s, const double *shared,
                            double *out) {
    (void)shared;
    const double *sx = along_x(a, s, 0), *cx = along_x(a, s, 1);
    double sy = at_y(a, s, 0), cy = at_y(a, s, 1), sz = at_z(a, s, 0), cz = at_z(a, s, 1);
    for (uint32_t n = 0; n < s->width; n++)
        out[n] = sx[n] * cy + sy * cz + sz * cx[n];
}

/* ---- sums of Gaussians, at x, y, z of each in the parameters ---- */

enum { GAUSSIANS = 60 };
#define GAUSSIAN_SIGMA 0.11

static void tabulate_gaussians(const double *parameters, int axis, double x, double *out,
                               size_t stride) {
    for (int n = 0; n < GAUSSIANS; n++) {
        double d = x - parameters[3 * n + axis];
        out[(size_t)n * stride] = portable_exp(-d * d / (2 * GAUSSIAN_SIGMA * GAUSSIAN_SIGMA));
    }
}

static void evaluate_gaussians(const analytic *a, const analytic_strip *s, const double *shared,
                               double *out) {
    (void)shared;
    memset(out, 0, s->width * sizeof *out);
    for (int g = 0; g < GAUSSIANS; g++) {
        double weight = at_y(a, s, g) * at_z(a, s, g);
        /* Skip those that are too far from this row to change a float near an interesting value. */
        if (weight < 1e-12)
            continue;
        const double *x = along_x(a, s, g);
        for (uint32_t n = 0; n < s->width; n++)
            out[n] += weight * x[n];
    }
}

/* ---- buckyball: Gaussians at the 60 corners of a truncated icosahedron ---- */

#define BUCKY_RADIUS 0.75

/* Add the even permutations of (+-x, +-y, +-z), zeros once. */
static int add_corners(double (*atom)[3], int count, double x, double y, double z) {
    const double from[3] = {x, y, z};
    for (int signs = 0; signs < 8; signs++) {
        if ((x == 0 && signs & 1) || (y == 0 && signs & 2) || (z == 0 && signs & 4))
            continue;
        for (int turn = 0; turn < 3; turn++, count++)
            for (int c = 0; c < 3; c++)
                atom[count][(c + turn) % 3] = signs >> c & 1 ? -from[c] : from[c];
    }
    return count;
}

static void set_up_buckyball(double *parameters, uint64_t seed, double time) {
    (void)seed;
    (void)time;
    double(*atom)[3] = (double(*)[3])parameters;
    double phi = (1 + sqrt(5)) / 2;
    int count = add_corners(atom, 0, 0, 1, 3 * phi);
    count = add_corners(atom, count, 1, 2 + phi, 2 * phi);
    count = add_corners(atom, count, phi, 2, 2 * phi + 1);
    double scale = BUCKY_RADIUS / sqrt(9 * phi + 10);
    for (int n = 0; n < 3 * count; n++)
        parameters[n] *= scale;
}

/* ---- orbital: hydrogen's 4d(z^2), |(3 z^2 - r^2) (1 - r / 12) e^(-r / 4)|^2, scaled to a maximum
 * of 1 ---- */

#define ORBITAL_EXTENT 28.0 /* Bohr radii per unit */

static void set_up_orbital(double *parameters, uint64_t seed, double time) {
    (void)seed;
    (void)time;
    /* The amplitude is largest on the z axis, at z = 4 (3 - sqrt 3). */
    double u = 3 - sqrt(3);
    parameters[0] = 1 / (32 * u * u * (1 - u / 3) * portable_exp(-u));
}

static void tabulate_orbital(const double *parameters, int axis, double x, double *out,
                             size_t stride) {
    (void)parameters;
    (void)axis;
    (void)stride;
    *out = x * x * (ORBITAL_EXTENT * ORBITAL_EXTENT);
}

static void evaluate_orbital(const analytic *a, const analytic_strip *s, const double *shared,
                             double *out) {
    (void)shared;
    const double *x2 = along_x(a, s, 0);
    double y2 = at_y(a, s, 0), z2 = at_z(a, s, 0);
    for (uint32_t n = 0; n < s->width; n++) {
        double r2 = x2[n] + y2 + z2;
        double r = sqrt(r2);
        double amplitude =
            (3 * z2 - r2) * (1 - r / 12) * portable_exp(r * -0.25) * a->parameters[0];
        out[n] = amplitude * amplitude;
    }
}

/* ---- noise: plane waves of seeded directions and phases with 3 to 6 periods over the longest edge
 * ---- */

enum { WAVES = 32 };
#define NOISE_LOW  1.5 /* periods per unit; the edge is two units long */
#define NOISE_HIGH 3.0

/* Steele, Lea and Flood's SplitMix64: the next number of a sequence, as a double in [0, 1). */
static double next_random(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* Per wave: the wave vector, uniform in the shell between the two frequencies, and the phase in
 * turns. */
static void set_up_noise(double *parameters, uint64_t seed, double time) {
    (void)time;
    for (int wave = 0; wave < WAVES;) {
        double *k = parameters + (size_t)wave * 4;
        for (int c = 0; c < 3; c++)
            k[c] = NOISE_HIGH * (2 * next_random(&seed) - 1);
        k[3] = next_random(&seed);
        double k2 = k[0] * k[0] + k[1] * k[1] + k[2] * k[2];
        wave += k2 >= NOISE_LOW * NOISE_LOW && k2 <= NOISE_HIGH * NOISE_HIGH;
    }
}

static void tabulate_noise(const double *parameters, int axis, double x, double *out,
                           size_t stride) {
    for (int wave = 0; wave < WAVES; wave++) {
        const double *k = parameters + (size_t)wave * 4;
        double turns = k[axis] * x + (axis == 2 ? k[3] : 0);
        double *to = out + 2 * (size_t)wave * stride;
        portable_sincos(turns, &to[stride], &to[0]);
    }
}

/* The sum of cos(X + Y + Z), from cosines and sines per axis, scaled to a standard deviation of 1.
 */
static void evaluate_noise(const analytic *a, const analytic_strip *s, const double *shared,
                           double *out) {
    (void)shared;
    memset(out, 0, s->width * sizeof *out);
    for (int wave = 0; wave < WAVES; wave++) {
        double cy = at_y(a, s, 2 * wave), sy = at_y(a, s, 2 * wave + 1);
        double cz = at_z(a, s, 2 * wave), sz = at_z(a, s, 2 * wave + 1);
        double c = (cy * cz - sy * sz) * 0.25, d = (sy * cz + cy * sz) * 0.25;
        const double *cx = along_x(a, s, 2 * wave), *sx = along_x(a, s, 2 * wave + 1);
        for (uint32_t n = 0; n < s->width; n++)
            out[n] += c * cx[n] - d * sx[n];
    }
}

/* ---- vortex: Gaussians in three arms of a spiral, which turn as one about the z axis ---- */

enum { ARMS = 3 };
#define VORTEX_WIND 0.5  /* turns of an arm, per unit from the axis */
#define VORTEX_TURN 0.25 /* turns of all from time 0 to time 1 */

static void set_up_vortex(double *parameters, uint64_t seed, double time) {
    for (int n = 0; n < GAUSSIANS; n++) {
        double *at = parameters + (size_t)n * 3, sine, cosine;
        double radius = 0.1 + 0.7 * next_random(&seed);
        double turns = n % ARMS / (double)ARMS + VORTEX_WIND * radius + 0.15 * next_random(&seed);
        portable_sincos(turns + VORTEX_TURN * time, &sine, &cosine);
        at[0] = radius * cosine;
        at[1] = radius * sine;
        at[2] = 1.6 * next_random(&seed) - 0.8;
    }
}

/* ---- jets: five of them that rise along z, widen and sway, in a weak noise whose waves run at
 * paces of their own ---- */

enum {
    JETS = 5,
    JET_PLACE = 2 * WAVES,      /* column of the x and y axes: the coordinate */
    JET_COLUMNS = 3,            /* of the z axis, each jet: its centre, 1 / (2 sigma^2) */
    JET_PARAMETERS = 4 * WAVES, /* x and y of a jet's foot, phases of its swaying along both */
    JET_TIME = JET_PARAMETERS + 4 * JETS
};
#define JET_NOISE 0.1 /* deviation of the noise */
#define JET_RING  0.5 /* radius of the circle of their feet */
#define JET_SWAY  0.2 /* at the top of the longest axis; */
#define JET_WIDTH 0.1 /* standard deviation there is twice this */
#define JET_RISE  2.2 /* turns of swaying from time 0 to time 1 */

static void set_up_jets(double *parameters, uint64_t seed, double time) {
    set_up_noise(parameters, seed, time);
    for (int wave = 0; wave < WAVES; wave++)
        parameters[4 * wave + 3] += time * (0.3 + 0.45 * (wave % 4));
    seed = ~seed;
    for (int jet = 0; jet < JETS; jet++) {
        double *p = parameters + JET_PARAMETERS + (size_t)jet * 4;
        portable_sincos((jet + 0.4 * next_random(&seed)) / JETS, &p[1], &p[0]);
        p[0] *= JET_RING;
        p[1] *= JET_RING;
        p[2] = next_random(&seed);
        p[3] = next_random(&seed);
    }
    parameters[JET_TIME] = time;
}

static void tabulate_jets(const double *parameters, int axis, double x, double *out,
                          size_t stride) {
    tabulate_noise(parameters, axis, x, out, stride);
    for (int c = 0; c < JET_COLUMNS * JETS; c++)
        out[(size_t)(JET_PLACE + c) * stride] = x;
    double up = 0.5 * (x + 1), sigma = JET_WIDTH * (1 + up);
    for (int jet = 0; jet < JETS && axis == 2; jet++) {
        const double *p = parameters + JET_PARAMETERS + (size_t)jet * 4;
        double *to = out + (size_t)(JET_PLACE + JET_COLUMNS * jet) * stride;
        double turns = up - JET_RISE * parameters[JET_TIME];
        to[0] = p[0] + JET_SWAY * up * portable_cos(turns + p[2]);
        to[stride] = p[1] + JET_SWAY * up * portable_cos(turns + p[3]);
        to[2 * stride] = 0.5 / (sigma * sigma);
    }
}

static void evaluate_jets(const analytic *a, const analytic_strip *s, const double *shared,
                          double *out) {
    evaluate_noise(a, s, shared, out);
    for (uint32_t n = 0; n < s->width; n++)
        out[n] *= JET_NOISE;
    const double *x = along_x(a, s, JET_PLACE);
    for (int jet = 0; jet < JETS; jet++) {
        const int c = JET_PLACE + JET_COLUMNS * jet;
        double centre = at_z(a, s, c), narrow = at_z(a, s, c + 2);
        double dy = at_y(a, s, JET_PLACE) - at_z(a, s, c + 1), dy2 = dy * dy;
        /* As Gaussians: too far to change a float. */
        if (dy2 * narrow > 28)
            continue;
        for (uint32_t n = 0; n < s->width; n++) {
            double dx = x[n] - centre;
            out[n] += portable_exp(-(dx * dx + dy2) * narrow);
        }
    }
}

/* ---- drop: a ball that falls into a pool, which answers with a ring; 1 inside, 0 outside, linear
 * between. What neither ball nor ring comes near has the same bits at any time ---- */

enum { DROP_X, DROP_Y, DROP_Z, DROP_CREST, DROP_HEIGHT }; /* parameters */
#define DROP_TOP    0.7                                   /* of its centre, at time 0 */
#define DROP_FALL   4.0                                   /* units per square of time */
#define DROP_RADIUS 0.22
#define DROP_POOL   -0.35 /* level at rest */
#define DROP_SLOPE  4.0   /* of values, per unit */
#define DROP_SPEED  1.2   /* of the ring's crest */
#define DROP_RING   0.2   /* from crest to foot */
#define DROP_RISE   0.4   /* of the crest at first, per unit of time */

static void set_up_drop(double *parameters, uint64_t seed, double time) {
    double since = time - sqrt((DROP_TOP - DROP_RADIUS - DROP_POOL) / DROP_FALL);
    since = since > 0 ? since : 0;
    parameters[DROP_X] = 0.6 * next_random(&seed) - 0.3;
    parameters[DROP_Y] = 0.6 * next_random(&seed) - 0.3;
    parameters[DROP_Z] = DROP_TOP - DROP_FALL * time * time;
    parameters[DROP_CREST] = DROP_SPEED * since;
    parameters[DROP_HEIGHT] = DROP_RISE * since * (1 - since);
}

/* Its square distance along an axis, from where the drop falls; along z, z itself. */
static void tabulate_drop(const double *parameters, int axis, double x, double *out,
                          size_t stride) {
    (void)stride;
    double d = x - parameters[axis];
    *out = axis == 2 ? x : d * d;
}

/* The pool's level. */
static void prepare_drop(const analytic *a, const analytic_strip *s, double *shared) {
    const double *x2 = along_x(a, s, 0), *p = a->parameters;
    double y2 = at_y(a, s, 0);
    for (uint32_t n = 0; n < s->width; n++) {
        double u = (sqrt(x2[n] + y2) - p[DROP_CREST]) / DROP_RING, w = 1 - u * u;
        shared[n] = DROP_POOL + (w > 0 ? p[DROP_HEIGHT] * w * w : 0);
    }
}

static void evaluate_drop(const analytic *a, const analytic_strip *s, const double *shared,
                          double *out) {
    const double *x2 = along_x(a, s, 0);
    double z = at_z(a, s, 0), dz = z - a->parameters[DROP_Z], yz2 = at_y(a, s, 0) + dz * dz;
    for (uint32_t n = 0; n < s->width; n++) {
        double ball = DROP_RADIUS - sqrt(x2[n] + yz2), depth = shared[n] - z;
        double v = 0.5 + DROP_SLOPE * (ball > depth ? ball : depth);
        v = v > 0 ? v : 0;
        out[n] = v < 1 ? v : 1;
    }
}

/* ---- all of them ---- */

static const analytic_kind kinds[] = {
    {.info = {"marschner-lobb",
              "the test signal of Marschner and Lobb (alpha 0.25, fM 6) in [0, 1]; u8 maps that to "
              "0..255; try 0.5 (u8 127.5)",
              0, 1, false, false},
     .columns = 1,
     .tabulate = tabulate_marschner_lobb,
     .prepare = prepare_marschner_lobb,
     .evaluate = evaluate_marschner_lobb},
    {.info = {"sphere",
              "1 - r/2, r the distance from the centre; u8 maps [0, 1] to 0..255; 0.6 (u8 153) is "
              "a sphere of radius 0.8",
              0, 1, false, false},
     .columns = 1,
     .tabulate = tabulate_square,
     .evaluate = evaluate_sphere},
    {.info = {"gyroid",
              "sin X cos Y + sin Y cos Z + sin Z cos X, four periods along the longest edge; u8 "
              "maps [-1.5, 1.5] to 0..255; try 0 (u8 127.5)",
              -1.5, 1.5, false, false},
     .columns = 2,
     .tabulate = tabulate_gyroid,
     .evaluate = evaluate_gyroid},
    {.info = {"buckyball",
              "Gaussians at the 60 atoms of C60; u8 maps [0, 1.25] to 0..255; try 0.5 (u8 102)", 0,
              1.25, false, false},
     .columns = GAUSSIANS,
     .set_up = set_up_buckyball,
     .tabulate = tabulate_gaussians,
     .evaluate = evaluate_gaussians},
    {.info = {"orbital",
              "the density of a hydrogen 4d electron, its maximum 1; u8 maps [0, 1] to 0..255; try "
              "0.04 (u8 10.2) and 0.4 (u8 102)",
              0, 1, false, false},
     .columns = 1,
     .set_up = set_up_orbital,
     .tabulate = tabulate_orbital,
     .evaluate = evaluate_orbital},
    {.info = {"noise",
              "32 seeded plane waves of 3 to 6 periods along the longest edge, mean 0, deviation "
              "1; u8 maps [-4, 4] to 0..255; try 0 (u8 127.5) and 1.5 (u8 175.3)",
              -4, 4, true, false},
     .columns = 2 * WAVES,
     .set_up = set_up_noise,
     .tabulate = tabulate_noise,
     .evaluate = evaluate_noise},
    {.info = {"drop",
              "in time, a drop falls into a pool (1 inside, 0 outside), seeded where; little "
              "changes from step to step; u8 maps [0, 1] to 0..255; try 0.5 (u8 127.5)",
              0, 1, true, true},
     .columns = 1,
     .set_up = set_up_drop,
     .tabulate = tabulate_drop,
     .prepare = prepare_drop,
     .evaluate = evaluate_drop},
    {.info = {"jets",
              "in time, five seeded jets sway in a weak noise; all changes from step to step; u8 "
              "maps [-0.5, 1.25] to 0..255; try 0.6 (u8 160.3)",
              -0.5, 1.25, true, true},
     .columns = JET_PLACE + JET_COLUMNS * JETS,
     .set_up = set_up_jets,
     .tabulate = tabulate_jets,
     .evaluate = evaluate_jets},
    {.info = {"vortex",
              "in time, 60 seeded Gaussians in three arms of a spiral make a quarter of a turn, as "
              "one; u8 maps [0, 1.5] to 0..255; try 0.5 (u8 85)",
              0, 1.5, true, true},
     .columns = GAUSSIANS,
     .set_up = set_up_vortex,
     .tabulate = tabulate_gaussians,
     .evaluate = evaluate_gaussians},
};

const analytic_kind *analytic_kinds(size_t *count) {
    *count = sizeof kinds / sizeof kinds[0];
    return kinds;
}

static double coordinate(const uint32_t dims[3], int axis, uint32_t i) {
    uint32_t most = dims[0] > dims[1] ? dims[0] : dims[1];
    most = most > dims[2] ? most : dims[2];
    return (2.0 * i - (dims[axis] - 1.0)) / (most - 1.0);
}

status analytic_init(analytic *a, mem *m, const analytic_kind *kind, const uint32_t dims[3],
                     uint64_t seed, double time) {
    memset(a, 0, sizeof *a);
    a->kind = kind;
    memcpy(a->dims, dims, sizeof a->dims);
    if (kind->set_up)
        kind->set_up(a->parameters, seed, time);
    for (int axis = 0; axis < 3; axis++) {
        size_t stride = dims[axis];
        a->table[axis] = mem_array(m, stride * (size_t)kind->columns, sizeof(double));
        if (!a->table[axis])
            return ST_NOMEM;
        for (uint32_t i = 0; i < dims[axis]; i++)
            kind->tabulate(a->parameters, axis, coordinate(dims, axis, i), a->table[axis] + i,
                           stride);
    }
    return ST_OK;
}

void analytic_release(analytic *a, mem *m) {
    for (int axis = 0; axis < 3; axis++)
        mem_free(m, a->table[axis]);
}
