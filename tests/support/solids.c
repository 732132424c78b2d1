#include "tests/support/solids.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- forms ---- */

/* A sample at node i; p: the same in [-1, 1]^3, edge: nodes to the nearest end of the volume. */
typedef double (*formula)(const long i[3], const long dims[3], const double p[3], long edge,
                          field_random *r);

static double radius(const double p[3]) {
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
}

static double ball(const long i[3], const long dims[3], const double p[3], long edge,
                   field_random *r) {
    (void)i, (void)dims, (void)edge, (void)r;
    return 0.9 - radius(p);
}

/* Sums of squares in whole numbers: between the samples each term is convex, and so is the inside.
 */
static double bowl(const long i[3], const long dims[3], const double p[3], long edge,
                   field_random *r) {
    (void)p, (void)edge, (void)r;
    double sum = 0, most = 0;
    for (int a = 0; a < 3; a++) {
        const double from_middle = (double)(2 * i[a] - (dims[a] - 1));
        const double ends = (double)(dims[a] - 1);
        sum += from_middle * from_middle;
        most = a == 0 ? ends * ends : fmin(most, ends * ends);
    }
    return most - sum - 0.5;
}

static double box(const long i[3], const long dims[3], const double p[3], long edge,
                  field_random *r) {
    (void)i, (void)dims, (void)p, (void)r;
    return edge > 0 ? 255 : 0;
}

static double gyroid(const long i[3], const long dims[3], const double p[3], long edge,
                     field_random *r) {
    const double w = 7, g = sin(w * p[0]) * cos(w * p[1]) + sin(w * p[1]) * cos(w * p[2]) +
                            sin(w * p[2]) * cos(w * p[0]);
    return fmin(0.4 - fabs(g), 3 * ball(i, dims, p, edge, r));
}

static double noise(const long i[3], const long dims[3], const double p[3], long edge,
                    field_random *r) {
    (void)i, (void)dims, (void)p;
    const double value = (double)field_random_below(r, 256);
    return edge > 0 ? value : 0;
}

static double reals(const long i[3], const long dims[3], const double p[3], long edge,
                    field_random *r) {
    (void)i, (void)dims, (void)p;
    const double value = field_random_in(r, -1, 1);
    return edge > 0 ? value : -0.7;
}

static double checker(const long i[3], const long dims[3], const double p[3], long edge,
                      field_random *r) {
    (void)dims, (void)p, (void)r;
    return edge > 0 && (i[0] + i[1] + i[2]) % 2 ? 255 : 0;
}

/* Mostly at the isovalue itself, which is inside. */
static double plateau(const long i[3], const long dims[3], const double p[3], long edge,
                      field_random *r) {
    (void)i, (void)dims, (void)p;
    const long n = field_random_below(r, 8);
    return edge == 0 ? 90 : n == 0 ? 90 : n == 1 ? 110 : 100;
}

static double needles(const long i[3], const long dims[3], const double p[3], long edge,
                      field_random *r) {
    (void)i, (void)dims, (void)p;
    return field_random_below(r, 30) == 0 && edge > 0 ? 255 : 0;
}

static double wild(const long i[3], const long dims[3], const double p[3], long edge,
                   field_random *r) {
    (void)i, (void)dims, (void)p;
    const double size = pow(10, (double)field_random_below(r, 61) - 30);
    return field_random_below(r, 2) && edge > 0 ? size : -size;
}

/* A wall one node thick. */
static double shell(const long i[3], const long dims[3], const double p[3], long edge,
                    field_random *r) {
    (void)i, (void)dims, (void)p, (void)r;
    return edge == 1 ? 255 : 0;
}

/* A thick round wall. */
static double globe(const long i[3], const long dims[3], const double p[3], long edge,
                    field_random *r) {
    (void)i, (void)dims, (void)edge, (void)r;
    return 0.25 - fabs(radius(p) - 0.65);
}

/* A wall about noise. */
static double crate(const long i[3], const long dims[3], const double p[3], long edge,
                    field_random *r) {
    return edge == 1 ? 255 : edge == 2 ? 0 : noise(i, dims, p, edge, r);
}

static const struct form {
    const char *name, *type;
    formula at;
    double iso;
    unsigned kind;
} forms[] = {
    {"ball", "f32", ball, 0, 0},
    {"bowl", "f32", bowl, 0, SOLID_CONVEX},
    {"box", "u8", box, 100, SOLID_CONVEX},
    {"gyroid", "f32", gyroid, 0, 0},
    {"noise", "u8", noise, 128, 0},
    {"reals", "f32", reals, 0.1, 0},
    {"checker", "u8", checker, 160, 0},
    {"plateau", "u8", plateau, 100, 0},
    {"needles", "u8", needles, 120, 0},
    {"wild", "f32", wild, 0, SOLID_FILAMENTS},
    {"shell", "u8", shell, 128, SOLID_HOLLOW},
    {"globe", "f32", globe, 0, SOLID_HOLLOW},
    {"crate", "u8", crate, 128, SOLID_HOLLOW},
};

/* ---- placings ---- */

static const struct placing {
    const char *name;
    double spacing[3], origin[3];
    bool uneven;
} placings[] = {
    {"unit", {1, 1, 1}, {0, 0, 0}, false},
    {"flat", {1, 1000, 1}, {0, 0, 0}, false},
    {"thin", {0.001, 1, 0.001}, {0, 0, 0}, false},
    {"mirrored", {-1, 0.7, -1.3}, {3, 5, 7}, false},
    {"far", {1, 1, 1}, {1e6, -1e6, 1e6}, false},
    {"small-far", {1e-3, 1e-3, 1e-3}, {1e3, 1e3, -1e3}, false},
    {"uneven", {1, 1, 1}, {0, 0, 0}, true},
};

#define COUNT(list) ((int)(sizeof(list) / sizeof *(list)))
#define FIND(list, name)                     \
    for (int n = 0; n < COUNT(list); n++)    \
        if (strcmp(list[n].name, name) == 0) \
            return n;                        \
    return -1;

int solid_count(void) {
    return COUNT(forms);
}

const char *solid_name(int which) {
    return forms[which].name;
}

unsigned solid_kind(int which) {
    return forms[which].kind;
}

int solid_find(const char *name) {
    FIND(forms, name)
}

int placing_count(void) {
    return COUNT(placings);
}

const char *placing_name(int placing) {
    return placings[placing].name;
}

bool placing_is_even(int placing) {
    return !placings[placing].uneven;
}

int placing_find(const char *name) {
    FIND(placings, name)
}

/* ---- volumes ---- */

static void *must_alloc(size_t bytes) {
    void *p = malloc(bytes);
    if (!p)
        abort(); /* a test without memory has nothing to say */
    return p;
}

static long edge_of(const field *f, const long i[3]) {
    long edge = i[0];
    for (int a = 0; a < 3; a++) {
        edge = i[a] < edge ? i[a] : edge;
        edge = f->dims[a] - 1 - i[a] < edge ? f->dims[a] - 1 - i[a] : edge;
    }
    return edge;
}

static void place(field *f, int placing, field_random *r) {
    const struct placing *from = &placings[placing];
    for (int a = 0; a < 3; a++) {
        f->spacing[a] = from->spacing[a];
        f->origin[a] = from->origin[a];
        f->axis[a] = NULL;
        if (!from->uneven)
            continue;
        f->axis[a] = must_alloc((size_t)f->dims[a] * sizeof *f->axis[a]);
        double at = -2;
        for (long i = 0; i < f->dims[a]; i++) {
            f->axis[a][i] = at;
            at += 0.1 + 3 * pow(field_random_unit(r), 3);
        }
    }
}

void solid_make(field *f, int which, int placing, uint64_t seed) {
    field_random r = {seed * 1000 + (uint64_t)(which * COUNT(placings) + placing)};
    const long n = 9 + field_random_below(&r, 30);
    *f = (field){.name = forms[which].name, .type = forms[which].type, .iso = forms[which].iso};
    for (int a = 0; a < 3; a++)
        f->dims[a] = n + field_random_below(&r, 3);
    place(f, placing, &r);
    f->samples = must_alloc((size_t)(f->dims[0] * f->dims[1] * f->dims[2]) * sizeof *f->samples);
    size_t at = 0;
    long i[3];
    for (i[2] = 0; i[2] < f->dims[2]; i[2]++)
        for (i[1] = 0; i[1] < f->dims[1]; i[1]++)
            for (i[0] = 0; i[0] < f->dims[0]; i[0]++) {
                double p[3];
                for (int a = 0; a < 3; a++)
                    p[a] = 2 * (double)i[a] / (double)(f->dims[a] - 1) - 1;
                f->samples[at++] = (float)forms[which].at(i, f->dims, p, edge_of(f, i), &r);
            }
}

double solid_scale(const field *f) {
    double most = 0;
    for (long i = 0; i < f->dims[0] * f->dims[1] * f->dims[2]; i++)
        most = fmax(most, fabs((double)f->samples[i] - f->iso));
    return most;
}

static double coordinate(const field *f, int a, double node) {
    const long i = (long)node < f->dims[a] - 1 ? (long)node : f->dims[a] - 2;
    if (!f->axis[a])
        return node;
    return f->axis[a][i] + (node - (double)i) * (f->axis[a][i + 1] - f->axis[a][i]);
}

bool solid_inside(const field *f, const ref_volume *v, field_random *r, bool exact, double p[3]) {
    const double least = 1e-6 * solid_scale(f);
    for (int tries = 0; tries < 1000; tries++) {
        long double at[3];
        for (int a = 0; a < 3; a++) {
            const double last = (double)(f->dims[a] - 1);
            double node = 1 + (double)field_random_below(r, f->dims[a] - 2);
            if (!exact)
                node += field_random_in(r, -1, 1) * field_random_unit(r);
            p[a] = coordinate(f, a, fmin(fmax(node, 0), last));
            at[a] = p[a];
        }
        if (ref_value(v, at, f->iso) > least)
            return true;
    }
    return false;
}

void solid_to_world(const ref_volume *v, const double p[3], double world[3]) {
    for (int a = 0; a < 3; a++)
        world[a] = v->to_world[a][a] * p[a] + v->to_world[a][3];
}
