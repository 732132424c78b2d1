/* leaf_place.h - where nodes of a grid and points of a mesh may lie, for who writes and who reads.
 *
 * Rendering multiplies up to three steps between nodes, and divides by their product. From steps of
 * 2^340 on the product is no double, and pictures are empty; from 2^-340 down media are. Within the
 * bounds here every product and square is normal, and pictures are the same for all powers of two
 * (tests/cli/places.sh). Coordinates have 53 bits: far from the origin pictures lose the bits of
 * whatever is behind the point.
 */
#ifndef FORMATS_LEAF_LEAF_PLACE_H
#define FORMATS_LEAF_LEAF_PLACE_H

#include <stdbool.h>
#include <stdint.h>

/* Of a grid: lengths of steps; nodes' distance from the origin, in world units and in steps. Of a
 * mesh: the longest edge of its box. */
#define LEAF_STEP_MIN   0x1p-200
#define LEAF_STEP_MAX   0x1p200
#define LEAF_FAR_MAX    0x1p220
#define LEAF_FAR_STEPS  0x1p44
#define LEAF_EXTENT_MIN 0x1p-120
#define LEAF_SPREAD_MIN 1e-9 /* of the box of three steps, each scaled to 1 */

enum { LEAF_PLACE_TEXT = 200 };

/* All three: true, or false with why, the end of a sentence that begins with the file.
 * leaf_place_grid() - of a row-major map of 3 x 4. leaf_place_axis() - of a rectilinear grid: what
 * the coordinates of axis a, ascending, make of its step. leaf_place_mesh() - lo x, y, z, hi x, y,
 * z; a mesh all of whose points are in one place is sound. */
bool leaf_place_grid(const double *to_world, char why[LEAF_PLACE_TEXT]);
bool leaf_place_axis(const double *to_world, int a, const double *x, uint32_t count,
                     char why[LEAF_PLACE_TEXT]);
bool leaf_place_mesh(const float bounds[6], char why[LEAF_PLACE_TEXT]);

#endif
