/* solids.h - closed surfaces: volumes whose outermost samples all lie outside the isosurface.
 *
 * A form (ball, gyroid, noise, ...) in a placing: cells that are cubes, 1000:1, mirrored, uneven, a
 * million cells from the origin. Nothing can see the inside from the outside but through the
 * surface.
 */
#ifndef TESTS_SUPPORT_SOLIDS_H
#define TESTS_SUPPORT_SOLIDS_H

#include "tests/support/fields.h"

/* What is known of a form. */
enum {
    SOLID_CONVEX = 1,    /* its inside is convex, exactly, in every placing but uneven ones */
    SOLID_FILAMENTS = 4, /* about edges and nodes, thinner than rounding: no band covers a ray that
                            passes one, so nothing is said about how many it met */
    SOLID_HOLLOW = 2 /* a closed wall about the volume's middle, in which nothing reaches the light
                        from outside */
};

int solid_count(void);
const char *solid_name(int which);
unsigned solid_kind(int which);
int solid_find(const char *name); /* -1: unknown */

int placing_count(void);
const char *placing_name(int placing);
bool placing_is_even(int placing);
int placing_find(const char *name);

/* solid_make() - 9 to 40 nodes an axis, by the seed. Release it as a field. */
void solid_make(field *f, int which, int placing, uint64_t seed);

/* solid_scale() - the largest difference of a finite sample to the isovalue. */
double solid_scale(const field *f);

/* solid_inside() - a point (node coordinates of the volume: axis values, or indices) where f is
 * above the isovalue by more than a millionth of the scale; on a node where `exact`. False: none
 * found. */
bool solid_inside(const field *f, const ref_volume *v, field_random *r, bool exact, double p[3]);

/* solid_to_world() - of such coordinates. */
void solid_to_world(const ref_volume *v, const double p[3], double world[3]);

#endif
