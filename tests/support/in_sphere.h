/* in_sphere.h - whether a point lies in a sphere through four others, and on which side of a plane:
 * exact, in whole numbers of 128 bits.
 *
 * Coordinates are whole numbers of at most IN_SPHERE_MAX, as doubles or floats.
 */
#ifndef TESTS_SUPPORT_IN_SPHERE_H
#define TESTS_SUPPORT_IN_SPHERE_H

enum { IN_SPHERE_MAX = 1 << 20 };

/* in_sphere_volume() - six times the volume of a tet: above 0 where d sees a, b, c clockwise. */
__int128 in_sphere_volume(const float *a, const float *b, const float *c, const float *d);

/* in_sphere() - above 0 when e is inside the sphere through a, b, c, d, 0 when on it; for any
 * orientation of the tet, which must have a volume. */
int in_sphere(const float *a, const float *b, const float *c, const float *d, const float *e);

#endif
