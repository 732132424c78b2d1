/* stand_in.h - what a preview draws in place of a grid's treelet that is absent: its finest
 * ancestor of which something is known.
 */
#ifndef RENDER_GRID_STAND_IN_H
#define RENDER_GRID_STAND_IN_H

#include "render/ray/tracer.h"
#include "stream/grid_resident.h"

typedef struct stand_in {
    const resident_grid *at; /* its pieces; or NULL, and */
    uint32_t t;              /* this treelet is taken whole; LEAF_NO_TREELET: nothing is drawn */
} stand_in;

/* stand_in_for() - where rays want pieces of treelet t. Cells of what stands in are not cut by t's
 * box. Where nothing does, t is taken whole where doubts are told of (tracer.doubts), else nothing
 * is drawn. */
stand_in stand_in_for(const tracer *tr, uint32_t t);

/* stand_in_is_bounded() - whether it is known how far what stands in for t is off everywhere. */
bool stand_in_is_bounded(const tracer *tr, uint32_t t, const stand_in *of);

#endif
