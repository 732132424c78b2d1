/* leaf_place.h - where nodes of a grid and points of a mesh may lie; for writers and readers.
 *
 * Rendering multiplies up to three steps between nodes, and divides by their product. From steps of
 * 2^340 on the product overflows a double, and pictures are empty; from 2^-340 down pictures of
 * media are. Within the bounds here every product and square is a normal double, and pictures are
 * the same for all powers of two (tests/cli/places.sh). Coordinates have 53 bits: far from the
 * origin pictures lose the bits after the point.
 */
#ifndef FORMATS_LEAF_LEAF_PLACE_H
#define FORMATS_LEAF_LEAF_PLACE_H

#include <stdbool.h>
#include <stdint.h>

/* STEP: length of a grid's steps. FAR: distance of its nodes from the origin, in world units and in
 * steps. EXTENT: the longest edge of a mesh's box. */
#define LEAF_STEP_MIN   0x1p-200
#define LEAF_STEP_MAX   0x1p200
#define LEAF_FAR_MAX    0x1p220
#define LEAF_FAR_STEPS  0x1p44
#define LEAF_EXTENT_MIN 0x1p-120
#define LEAF_SPREAD_MIN 1e-9 /* volume of the box of three steps, each scaled to 1 */

enum { LEAF_PLACE_TEXT = 200 };

/* All three return true, or false with the reason: the end of a sentence that begins with the file.
 * leaf_place_grid() - check a row-major map of 3 x 4.
 * leaf_place_axis() - for a rectilinear grid: check the steps that the ascending coordinates of
 * axis a give.
 * leaf_place_mesh() - check a box: lo x, y, z, hi x, y, z. A mesh with all points in one place is
 * sound. */
bool leaf_place_grid(const double *to_world, char why[LEAF_PLACE_TEXT]);
bool leaf_place_axis(const double *to_world, int a, const double *x, uint32_t count,
                     char why[LEAF_PLACE_TEXT]);
bool leaf_place_mesh(const float bounds[6], char why[LEAF_PLACE_TEXT]);

#endif
