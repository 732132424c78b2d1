#include "tests/support/fields.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- random numbers ---- */

uint64_t field_random_bits(field_random *r) {
    uint64_t x = r->state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

double field_random_unit(field_random *r) {
    return (double)(field_random_bits(r) >> 11) * 0x1p-53;
}

double field_random_in(field_random *r, double lo, double hi) {
    return lo + (hi - lo) * field_random_unit(r);
}

long field_random_below(field_random *r, long count) {
    return (long)(field_random_bits(r) % (uint64_t)count);
}

/* ---- formulas ---- */

/* A sample of field f at node (i, j, k); p: the same in [-1, 1]^3. */
typedef double (*formula)(const field *f, const long i[3], const double p[3], field_random *r);

static double sphere(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)r;
    return 1 - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static double sphere_u8(const field *f, const long i[3], const double p[3], field_random *r) {
    return fmax(0, floor(200 * sphere(f, i, p, r)));
}

static double linear(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)p, (void)r;
    return (double)(2 * i[0] + 3 * i[1] - i[2]);
}

/* Slabs one and two cells thick, across each axis in turn. */
static double planes(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)p, (void)r;
    return i[0] % 7 == 3 || i[1] % 9 == 4 || i[2] % 11 / 2 == 2 ? 200 : 50;
}

static double saddle(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)r;
    return p[0] * p[1] - p[1] * p[2] + p[0] * p[1] * p[2];
}

/* Every other node high: each cell has surfaces at its corners, often two on a ray (M08,
 * figure 4.9). */
static double checker(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)p, (void)r;
    return (i[0] + i[1] + i[2]) % 2 ? 255 : 0;
}

static double noise_u8(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)p;
    return (double)field_random_below(r, 256);
}

static double noise_i16(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)p;
    return (double)field_random_below(r, 65536) - 32768;
}

static double noise_f32(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)p;
    return (float)field_random_in(r, -1, 1);
}

/* Noise of three values: below, at and above the isovalue, mostly at. */
static double plateau(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)i, (void)p;
    long n = field_random_below(r, 8);
    return n == 0 ? f->iso - 10 : n == 1 ? f->iso + 10 : f->iso;
}

/* Terraces: constant over blocks of three nodes, one of the levels the isovalue itself. */
static double terraces(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)p, (void)r;
    return f->iso + 20 * (double)((i[0] / 3 + 2 * (i[1] / 3) + i[2] / 3) % 3 - 1);
}

static double missing(const field *f, const long i[3], const double p[3], field_random *r) {
    long n = field_random_below(r, 40);
    if (n < 3)
        return n == 0 ? (double)NAN : n == 1 ? (double)INFINITY : -(double)INFINITY;
    return sphere(f, i, p, r) + field_random_in(r, -0.1, 0.1);
}

static double tiny(const field *f, const long i[3], const double p[3], field_random *r) {
    return 1e-30 * noise_f32(f, i, p, r);
}

static double huge(const field *f, const long i[3], const double p[3], field_random *r) {
    return 1e30 * noise_f32(f, i, p, r);
}

/* Neighbours from 1e-30 to 1e30, either sign. */
static double wild(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)p;
    double magnitude = pow(10, (double)field_random_below(r, 61) - 30);
    return field_random_below(r, 2) ? magnitude : -magnitude;
}

static double constant(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)i, (void)p, (void)r;
    return f->iso;
}

/* A smooth sum of waves: surfaces of every slope. */
static double waves(const field *f, const long i[3], const double p[3], field_random *r) {
    (void)f, (void)i, (void)r;
    return sin(7 * p[0] + 2 * p[1]) + sin(5 * p[1] - 3 * p[2] + 1) + sin(6 * p[2] + p[0] * p[1]);
}

/* ---- the list ---- */

typedef struct recipe {
    const char *name, *type;
    formula at;
    double iso;
    double spacing[3], origin[3];
    bool rectilinear;
} recipe;

#define UNIT {1, 1, 1}, {0, 0, 0}, false
static const recipe recipes[] = {
    {"sphere", "f32", sphere, 0.25, UNIT},
    {"sphere-u8", "u8", sphere_u8, 60, UNIT},
    {"linear", "f32", linear, 11, UNIT},
    {"planes", "u8", planes, 128, UNIT},
    {"saddle", "f32", saddle, 0, UNIT},
    {"checker", "u8", checker, 160, UNIT},
    {"noise-u8", "u8", noise_u8, 128, UNIT},
    {"noise-i16", "i16", noise_i16, 100, UNIT},
    {"noise-f32", "f32", noise_f32, 0.1, UNIT},
    {"plateau", "u8", plateau, 100, UNIT},
    {"terraces", "u8", terraces, 100, UNIT},
    {"missing", "f32", missing, 0.3, UNIT},
    {"tiny", "f32", tiny, 1e-31, UNIT},
    {"huge", "f32", huge, 1e29, UNIT},
    {"wild", "f32", wild, 1, UNIT},
    {"constant", "u8", constant, 77, UNIT},
    {"waves", "f32", waves, 0.2, UNIT},
    {"flat-cells", "f32", waves, 0.2, {1, 1000, 1}, {0, 0, 0}, false},
    {"thin-cells", "f32", noise_f32, 0.1, {0.001, 1, 0.001}, {0, 0, 0}, false},
    {"far", "f32", waves, 0.2, {1, 1, 1}, {1e6, -1e6, 1e6}, false},
    {"mirrored", "f32", waves, 0.2, {-1, 0.7, -1.3}, {3, 5, 7}, false},
    {"rectilinear", "f32", waves, 0.2, {1, 1, 1}, {0, 0, 0}, true},
};
#undef UNIT

int field_count(void) {
    return (int)(sizeof recipes / sizeof recipes[0]);
}

const char *field_name(int index) {
    return recipes[index].name;
}

static void *must_alloc(size_t bytes) {
    void *p = malloc(bytes);
    if (!p)
        abort(); /* a test without memory has nothing to say */
    return p;
}

/* Widths that vary up to 1:30 from cell to cell. */
static double *uneven_axis(long count, field_random *r) {
    double *axis = must_alloc((size_t)count * sizeof axis[0]), at = -2;
    for (long i = 0; i < count; i++) {
        axis[i] = at;
        at += 0.1 + 3 * pow(field_random_unit(r), 3);
    }
    return axis;
}

static void fill(field *f, formula at, field_random *r) {
    size_t n = 0;
    long i[3];
    for (i[2] = 0; i[2] < f->dims[2]; i[2]++)
        for (i[1] = 0; i[1] < f->dims[1]; i[1]++)
            for (i[0] = 0; i[0] < f->dims[0]; i[0]++) {
                double p[3];
                for (int a = 0; a < 3; a++)
                    p[a] = 2 * (double)i[a] / (double)(f->dims[a] - 1) - 1;
                f->samples[n++] = (float)at(f, i, p, r);
            }
}

bool field_make(field *f, const char *name, long n, uint64_t seed) {
    const recipe *from = NULL;
    for (int i = 0; i < field_count(); i++)
        if (strcmp(recipes[i].name, name) == 0)
            from = &recipes[i];
    if (!from)
        return false;
    field_random r = {seed};
    *f = (field){.name = from->name, .type = from->type, .iso = from->iso};
    for (int a = 0; a < 3; a++) {
        f->dims[a] = n + a > 2 ? n + a : 2;
        f->spacing[a] = from->spacing[a];
        f->origin[a] = from->origin[a];
        f->axis[a] = from->rectilinear ? uneven_axis(f->dims[a], &r) : NULL;
    }
    f->samples = must_alloc((size_t)(f->dims[0] * f->dims[1] * f->dims[2]) * sizeof f->samples[0]);
    fill(f, from->at, &r);
    return true;
}

static const struct {
    const char *name, *field, *type;
    float below;
} retyped[FIELD_RETYPED] = {{"noise-i8", "noise-u8", "i8", 128.0F},
                            {"noise-u16", "noise-i16", "u16", -32768.0F},
                            {"raised-f32", "noise-f32", "f32", -1e6F}};

const char *field_retyped_name(int index) {
    return retyped[index].name;
}

void field_make_retyped(field *f, int index, long n, uint64_t seed) {
    (void)field_make(f, retyped[index].field, n, seed);
    f->name = retyped[index].name;
    f->type = retyped[index].type;
    for (long i = 0; i < f->dims[0] * f->dims[1] * f->dims[2]; i++)
        f->samples[i] -= retyped[index].below;
}

void field_release(field *f) {
    free(f->samples);
    for (int a = 0; a < 3; a++)
        free(f->axis[a]);
    *f = (field){0};
}

ref_volume field_volume(const field *f) {
    ref_volume v = ref_volume_regular(f->dims, f->samples, f->spacing, f->origin);
    for (int a = 0; a < 3; a++)
        v.axis[a] = f->axis[a];
    return v;
}

ref_ray field_random_ray(const ref_volume *v, field_random *r, double margin) {
    ref_ray ray;
    for (int a = 0; a < 3; a++) {
        long nodes = v->dims[a];
        double first = v->axis[a] ? v->axis[a][0] : 0;
        double last = v->axis[a] ? v->axis[a][nodes - 1] : (double)(nodes - 1);
        double from = field_random_in(r, first - margin, last + margin);
        double to = field_random_in(r, first, last);
        ray.o[a] = v->to_world[a][a] * from + v->to_world[a][3];
        ray.d[a] = v->to_world[a][a] * (to - from);
    }
    return ray;
}

ref_ray field_exact_ray(const ref_volume *v, field_random *r) {
    ref_ray ray = {{0}, {0}};
    while (ray.d[0] == 0 && ray.d[1] == 0 && ray.d[2] == 0)
        for (int a = 0; a < 3; a++) {
            long span = 2 * (v->dims[a] - 1);
            ray.d[a] = field_random_below(r, 3) ? (double)(field_random_below(r, 5) - 2) : 0;
            ray.o[a] = 0.5 * (double)field_random_below(r, span + 1) - 64 * ray.d[a];
        }
    return ray;
}

ref_ray field_aimed_ray(const ref_volume *v, field_random *r, double margin) {
    ref_ray ray = field_random_ray(v, r, margin);
    for (int a = 0; a < 3; a++)
        ray.d[a] = 0.5 * (double)field_random_below(r, 2 * v->dims[a] - 1) - ray.o[a];
    return ray;
}

/* ---- files ---- */

static void put_sample(FILE *out, const char *type, float value) {
    uint32_t bits = 0;
    int bytes = 4;
    if (type[0] == 'f') {
        memcpy(&bits, &value, 4);
    } else {
        bits = (uint32_t)(int32_t)value;
        bytes = strcmp(type + 1, "16") == 0 ? 2 : 1;
    }
    for (int b = 0; b < bytes; b++)
        putc((int)(bits >> (8 * b) & 0xff), out);
}

static void put_samples(FILE *out, const field *f) {
    size_t count = (size_t)(f->dims[0] * f->dims[1] * f->dims[2]);
    for (size_t i = 0; i < count; i++)
        put_sample(out, f->type, f->samples[i]);
}

static bool finish(FILE *out) {
    bool good = !ferror(out);
    return fclose(out) == 0 && good;
}

bool field_write_raw(const field *f, const char *path) {
    FILE *out = fopen(path, "wb");
    if (!out)
        return false;
    put_samples(out, f);
    return finish(out);
}

static bool write_axis(const field *f, const char *path, int a) {
    char name[4096];
    snprintf(name, sizeof name, "%s.%c", path, 'x' + a);
    FILE *out = fopen(name, "w");
    if (!out)
        return false;
    for (long i = 0; i < f->dims[a]; i++)
        fprintf(out, "%.17g\n", f->axis[a][i]);
    return finish(out);
}

bool field_write_nrrd(const field *f, const char *path) {
    const char *type = f->type[0] == 'f'             ? "float"
                       : strcmp(f->type, "i16") == 0 ? "int16"
                       : strcmp(f->type, "u16") == 0 ? "uint16"
                       : strcmp(f->type, "i8") == 0  ? "int8"
                                                     : "uint8";
    const double *s = f->spacing, *o = f->origin;
    FILE *out = fopen(path, "wb");
    if (!out)
        return false;
    fprintf(out, "NRRD0004\ntype: %s\ndimension: 3\nsizes: %ld %ld %ld\n", type, f->dims[0],
            f->dims[1], f->dims[2]);
    fprintf(out, "encoding: raw\nendian: little\nspace dimension: 3\n");
    fprintf(out, "space directions: (%.17g,0,0) (0,%.17g,0) (0,0,%.17g)\n", s[0], s[1], s[2]);
    fprintf(out, "space origin: (%.17g,%.17g,%.17g)\n\n", o[0], o[1], o[2]);
    put_samples(out, f);
    bool good = finish(out);
    for (int a = 0; a < 3 && f->axis[0]; a++)
        good = write_axis(f, path, a) && good;
    return good;
}
