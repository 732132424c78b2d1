/* curvilinear_generate.h - an analytic field on a curvilinear grid, as a VTK file (.vts), as a
 * stream: a plane of nodes is in memory.
 *
 * The values are those of the field on a grid of as many nodes: surfaces bend with the grid.
 */
#ifndef PREP_GENERATE_CURVILINEAR_GENERATE_H
#define PREP_GENERATE_CURVILINEAR_GENERATE_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "prep/generate/field.h"

/* Where nodes are, by their share u, v, w of the way along i, j, k, from 0 to 1. */
typedef enum curvilinear_shape {
    CURVILINEAR_WARP,    /* a box of 1 x 1 x 1 whose nodes sway; no cell is folded */
    CURVILINEAR_ANNULUS, /* i goes once around the z axis, and ends where it began; j from radius
                            0.5 to 1, k along z from 0 to 1 */
    CURVILINEAR_TWISTED, /* a box that k turns about its axis, by three quarters of a turn */
    CURVILINEAR_SHAPES
} curvilinear_shape;

/* curvilinear_shape_find() - by its name: warp, annulus, twisted. False: there is none.
 * curvilinear_shape_place() - the place of a node. The same bits on every machine. */
bool curvilinear_shape_find(const char *name, curvilinear_shape *out);
void curvilinear_shape_place(curvilinear_shape shape, const double at[3], float out[3]);

typedef struct curvilinear_generate_options {
    const field_info *info;
    uint64_t seed;
    curvilinear_shape shape;
    uint32_t dims[3]; /* nodes; 2 or more each */
    int threads;
    const char *output; /* a path, or "-" */
    bool force;
    uint32_t steps; /* above 0: a time series of this many files (generate_steps.h) */
} curvilinear_generate_options;

CHECKED status curvilinear_generate(mem *m, const curvilinear_generate_options *o,
                                    const progress *p);

#endif
