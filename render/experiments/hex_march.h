/* hex_march.h - rays from cell to cell through a curvilinear grid in memory (M08 6.4), one by one,
 * by either method of hex_exit.h; what is drawn of the values where they cross faces.
 *
 * A ray begins outside of the grid. It enters by the first boundary face (hex_boundary.h), goes on
 * from neighbour to neighbour until it leaves, and enters again where there is a further boundary
 * face. Zones that lie in each other are marched through one after the other. A lost ray ends.
 */
#ifndef RENDER_EXPERIMENTS_HEX_MARCH_H
#define RENDER_EXPERIMENTS_HEX_MARCH_H

#include <stdbool.h>
#include <stdint.h>

#include "render/experiments/hex_boundary.h"
#include "render/experiments/hex_lattice.h"

typedef enum hex_way { HEX_PLUECKER, HEX_HYBRID, HEX_WAYS } hex_way;

/* Where a ray crosses a face. */
typedef struct hex_crossing {
    hex_point point;
    double value;
    uint32_t node[4]; /* the face's corners */
} hex_crossing;

/* Looks at the part of a ray in a cell. False: that is enough. */
typedef bool hex_look(void *ctx, uint32_t cell, const hex_crossing *from, const hex_crossing *to);

/* What rays did; added up. */
typedef struct hex_tally {
    uint64_t cells, entries; /* marched through; times that a ray entered the grid */
    uint64_t tests, patches; /* Pluecker tests, and intersections of patches, in the march */
    uint64_t lost;           /* rays */
} hex_tally;

typedef struct hex_marcher {
    const hex_lattice *lattice;
    const hex_boundary *boundary;
    hex_way way;
} hex_marcher;

/* hex_march() - the ray o + t d for t above 0. look NULL: nothing is computed of faces but which
 * ones they are, and by Pluecker tests not where. Ends after a number of cells in any case. */
void hex_march(const hex_marcher *m, const double o[3], const double d[3], hex_look *look,
               void *ctx, hex_tally *tally);

/* ---- What is drawn: contexts of hex_march(), each with its look ---- */

/* The first point of an isosurface, and its normal: linear between the ends (M08 6.4.3, 6.4.4).
 * found: false at first. */
typedef struct hex_surface {
    const hex_lattice *lattice;
    double isovalue;
    bool found;
    uint32_t cell;
    double t;
    double normal[3]; /* unit, or 0 */
} hex_surface;
bool hex_surface_look(void *surface, uint32_t cell, const hex_crossing *from,
                      const hex_crossing *to);

/* Values at faces, front to back until all is opaque (M08 2.2.5.1): the colour at a face rises from
 * 0 at low with `rise`, and its opacity with `opacity`; distances do not count. */
typedef struct hex_fog {
    double low, rise, opacity;
    double colour, alpha; /* 0 at first */
} hex_fog;
bool hex_fog_look(void *fog, uint32_t cell, const hex_crossing *from, const hex_crossing *to);

/* The greatest value at faces. */
typedef struct hex_maximum {
    double value; /* -INFINITY at first */
} hex_maximum;
bool hex_maximum_look(void *maximum, uint32_t cell, const hex_crossing *from,
                      const hex_crossing *to);

#endif
