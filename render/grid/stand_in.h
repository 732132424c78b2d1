/* stand_in.h - what a preview draws in place of an absent treelet of a grid: its finest ancestor of
 * which something is known.
 */
#ifndef RENDER_GRID_STAND_IN_H
#define RENDER_GRID_STAND_IN_H

#include "render/ray/tracer.h"
#include "stream/grid_resident.h"

typedef struct stand_in {
    const resident_grid *at; /* resident: give its pieces; NULL: see t */
    uint32_t t; /* the treelet that stands in, taken whole if `at` is NULL; LEAF_NO_TREELET: draw
                   nothing */
} stand_in;

/* stand_in_for() - finds an ancestor that stands in for absent treelet t, for rays that want
 * pieces. The ancestor's cells are not cut by t's box. If there is none, t itself is taken whole if
 * tracer.doubts is set, else nothing is drawn. */
stand_in stand_in_for(const tracer *tr, uint32_t t);

/* stand_in_is_bounded() - returns whether a deviation bounds the error of *of everywhere in t.
 * of->at is not NULL. */
bool stand_in_is_bounded(const tracer *tr, uint32_t t, const stand_in *of);

#endif
