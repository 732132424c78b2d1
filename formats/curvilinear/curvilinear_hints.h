/* curvilinear_hints.h - what the command line says of a curvilinear grid. Zero/NULL = not given. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_HINTS_H
#define FORMATS_CURVILINEAR_CURVILINEAR_HINTS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/path_pattern.h"
#include "formats/input/input_trust.h"

typedef struct curvilinear_hints {
    const char *field;    /* the field's name; NULL: the default. Of a vector also "velocity_x" */
    int component;        /* component of a vector: 1, 2, ..; 0: its magnitude */
    const char *name;     /* name of the data set, in place of the grid's own */
    uint32_t step;        /* of several time steps, counted from 0 */
    bool cells_to_points; /* take a field of the cells, averaged to the nodes */
    input_trust trust;
    /* PLOT3D: the files that go with the grid, one a time step, or one for all of them; and how all
     * files are written: words split by commas, see plot3d_layout.h. Any of these makes any regular
     * file a PLOT3D grid. */
    path_list solutions, functions;
    const char *layout;
    /* netCDF: where its nodes go: "cartesian" or "sphere"; NULL: it is a grid of its own. Heights
     * are taken times exaggerate; 0: as they are. */
    const char *to;
    double exaggerate;
} curvilinear_hints;

#endif
