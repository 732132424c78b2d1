/* fields.h - small test volumes by name: plain formulas and seeded random numbers.
 *
 * Each is a trap for a ray tracer: plateaus at the isovalue, missing data, values of 1e-30 or 1e30,
 * flat or distant cells.
 */
#ifndef TESTS_SUPPORT_FIELDS_H
#define TESTS_SUPPORT_FIELDS_H

#include <stdbool.h>
#include <stdint.h>

#include "tests/support/reference.h"

/* Random numbers: a counter and a mixer (splitmix64). */
typedef struct field_random {
    uint64_t state;
} field_random;
uint64_t field_random_bits(field_random *r);
double field_random_unit(field_random *r);                     /* in [0, 1) */
double field_random_in(field_random *r, double lo, double hi); /* in [lo, hi) */
long field_random_below(field_random *r, long count);          /* 0 .. count - 1 */

/* A test volume. The samples are those of its type, as floats. */
typedef struct field {
    const char *name;
    const char *type; /* "u8", "i16" or "f32"; retyped: "i8" or "u16" */
    long dims[3];
    float *samples;
    double *axis[3]; /* node coordinates of a rectilinear field, else NULL */
    double spacing[3], origin[3];
    double iso; /* a value worth looking at */
} field;

enum { FIELD_SEED = 1 };

/* field_count(), field_name() - all that there are: sphere, linear, planes, saddle, checker,
 * noise-u8, ... */
int field_count(void);
const char *field_name(int index);

/* field_make() - a field of about n nodes an axis (no two axes alike); false when the name is
 * unknown. Release it. */
bool field_make(field *f, const char *name, long n, uint64_t seed);

/* field_make_retyped() - some of them in types that no field has, by numbers below FIELD_RETYPED:
 * noise-i8 and noise-u16 (all values of the types), raised-f32 (noise on a million). */
enum { FIELD_RETYPED = 3 };
const char *field_retyped_name(int index);
void field_make_retyped(field *f, int index, long n, uint64_t seed);

void field_release(field *f);

/* field_volume() - for the reference; points into f. */
ref_volume field_volume(const field *f);

/* field_random_ray() - from a random point in a box larger than the volume by `margin` node
 * coordinates on all sides, towards one in the volume; t = 1 is there. World space; to_world
 * diagonal. */
ref_ray field_random_ray(const ref_volume *v, field_random *r, double margin);

/* field_exact_ray() - a line through whole or half grid points of a unit grid: in grid planes,
 * along edges and diagonals, through vertices. t = 64 is such a point inside. */
ref_ray field_exact_ray(const ref_volume *v, field_random *r);

/* field_aimed_ray() - from a random point through a whole or half grid point of a unit grid, as
 * nearly as rounding allows; t = 1 is there. */
ref_ray field_aimed_ray(const ref_volume *v, field_random *r, double margin);

/* field_write_raw() - the samples, little endian, in the field's type; false when the file cannot
 * be written. */
bool field_write_raw(const field *f, const char *path);

/* field_write_nrrd() - the same behind an NRRD header; axes of a rectilinear field go to path.x,
 * path.y, path.z, one coordinate a line. */
bool field_write_nrrd(const field *f, const char *path);

#endif
