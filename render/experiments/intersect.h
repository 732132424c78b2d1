/* intersect.h - the intersectors of M08 4.3.3 behind one signature, by name.
 *
 *   midpoint   the middle of the visit of every active cell: a yardstick for time
 *   linear     Algorithm 6: between the values at entry and exit
 *   neubauer   Algorithm 7: three repeated linear interpolations, trilinear look-ups
 *   schwarze   the cubic solved in closed form
 *   marmitt-3  Algorithm 8: roots isolated by the extrema, three repeated linear interpolations
 *   marmitt    the same, iterated to the last bits: cell_next_hit(), the only exact one
 *
 * All but `marmitt` are approximate: midpoint, linear and neubauer see no surface where entry and
 * exit lie on the same side, or at most one; schwarze loses digits near double roots, and its
 * cosines are libm's, so its bits may depend on the CPU. All six compute in double, about the
 * cell's entry: with M08's floats about the eye, the last three would miss most hits.
 *
 * Pictures are drawn with the approximate ones ray by ray: intersect_walk.h.
 */
#ifndef RENDER_EXPERIMENTS_INTERSECT_H
#define RENDER_EXPERIMENTS_INTERSECT_H

#include "render/grid/cell_kernel.h"
#include "render/leafcast_experimental.h"
#include "render/ray/ray.h"

/* As cell_next_hit(). */
typedef bool (*intersect_fn)(const ray *r, const cell_visit *visit, const float samples[8],
                             double iso, int32_t iso_index, uint64_t cell, const hit *after,
                             hit *found);

typedef struct intersector {
    leafcast_intersector id;
    const char *name;
    intersect_fn next_hit;
} intersector;

enum { INTERSECTOR_COUNT = 6 };

/* intersector_at() - returns an intersector by its place in the list above, from 0 to
 * INTERSECTOR_COUNT - 1. */
const intersector *intersector_at(int index);

/* intersector_find() - returns an intersector by its public constant; NULL: there is none. */
const intersector *intersector_find(leafcast_intersector id);

/* intersector_named() - returns an intersector by its name; NULL: there is none. */
const intersector *intersector_named(const char *name);

#endif
