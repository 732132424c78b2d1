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

/* ---- buckyball: Gaussians at the 60 corners of a truncated icosahedron ---- */

enum { ATOMS = 60 };
#define BUCKY_RADIUS 0.75
#define BUCKY_SIGMA  0.11

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

static void set_up_buckyball(double *parameters, uint64_t seed) {
    (void)seed;
    double(*atom)[3] = (double(*)[3])parameters;
    double phi = (1 + sqrt(5)) / 2;
    int count = add_corners(atom, 0, 0, 1, 3 * phi);
    count = add_corners(atom, count, 1, 2 + phi, 2 * phi);
    count = add_corners(atom, count, phi, 2, 2 * phi + 1);
    double scale = BUCKY_RADIUS / sqrt(9 * phi + 10);
    for (int n = 0; n < 3 * count; n++)
        parameters[n] *= scale;
}

static void tabulate_buckyball(const double *parameters, int axis, double x, double *out,
                               size_t stride) {
    for (int n = 0; n < ATOMS; n++) {
        double d = x - parameters[3 * n + axis];
        out[(size_t)n * stride] = portable_exp(-d * d / (2 * BUCKY_SIGMA * BUCKY_SIGMA));
    }
}

static void evaluate_buckyball(const analytic *a, const analytic_strip *s, const double *shared,
                               double *out) {
    (void)shared;
    memset(out, 0, s->width * sizeof *out);
    for (int atom = 0; atom < ATOMS; atom++) {
        double weight = at_y(a, s, atom) * at_z(a, s, atom);
        /* Skip atoms that are too far from this row to change a float near an interesting value. */
        if (weight < 1e-12)
            continue;
        const double *x = along_x(a, s, atom);
        for (uint32_t n = 0; n < s->width; n++)
            out[n] += weight * x[n];
    }
}

/* ---- orbital: hydrogen's 4d(z^2), |(3 z^2 - r^2) (1 - r / 12) e^(-r / 4)|^2, scaled to a maximum
 * of 1 ---- */

#define ORBITAL_EXTENT 28.0 /* Bohr radii per unit */

static void set_up_orbital(double *parameters, uint64_t seed) {
    (void)seed;
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
static void set_up_noise(double *parameters, uint64_t seed) {
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

/* ---- all of them ---- */

static const analytic_kind kinds[] = {
    {.info = {"marschner-lobb",
              "the test signal of Marschner and Lobb (alpha 0.25, fM 6) in [0, 1]; u8 maps that to "
              "0..255; try 0.5 (u8 127.5)",
              0, 1, false},
     .columns = 1,
     .tabulate = tabulate_marschner_lobb,
     .prepare = prepare_marschner_lobb,
     .evaluate = evaluate_marschner_lobb},
    {.info = {"sphere",
              "1 - r/2, r the distance from the centre; u8 maps [0, 1] to 0..255; 0.6 (u8 153) is "
              "a sphere of radius 0.8",
              0, 1, false},
     .columns = 1,
     .tabulate = tabulate_square,
     .evaluate = evaluate_sphere},
    {.info = {"gyroid",
              "sin X cos Y + sin Y cos Z + sin Z cos X, four periods along the longest edge; u8 "
              "maps [-1.5, 1.5] to 0..255; try 0 (u8 127.5)",
              -1.5, 1.5, false},
     .columns = 2,
     .tabulate = tabulate_gyroid,
     .evaluate = evaluate_gyroid},
    {.info = {"buckyball",
              "Gaussians at the 60 atoms of C60; u8 maps [0, 1.25] to 0..255; try 0.5 (u8 102)", 0,
              1.25, false},
     .columns = ATOMS,
     .set_up = set_up_buckyball,
     .tabulate = tabulate_buckyball,
     .evaluate = evaluate_buckyball},
    {.info = {"orbital",
              "the density of a hydrogen 4d electron, its maximum 1; u8 maps [0, 1] to 0..255; try "
              "0.04 (u8 10.2) and 0.4 (u8 102)",
              0, 1, false},
     .columns = 1,
     .set_up = set_up_orbital,
     .tabulate = tabulate_orbital,
     .evaluate = evaluate_orbital},
    {.info = {"noise",
              "32 seeded plane waves of 3 to 6 periods along the longest edge, mean 0, deviation "
              "1; u8 maps [-4, 4] to 0..255; try 0 (u8 127.5) and 1.5 (u8 175.3)",
              -4, 4, true},
     .columns = 2 * WAVES,
     .set_up = set_up_noise,
     .tabulate = tabulate_noise,
     .evaluate = evaluate_noise},
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
                     uint64_t seed) {
    memset(a, 0, sizeof *a);
    a->kind = kind;
    memcpy(a->dims, dims, sizeof a->dims);
    if (kind->set_up)
        kind->set_up(a->parameters, seed);
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
