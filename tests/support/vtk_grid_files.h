/* vtk_grid_files.h - VTK files of grids, legacy and XML, in every coding, with the samples of
 * volumes.h.
 *
 * Arrays, of points or of cells: "s", the test volume; "v", of three components 3 n, 4 n, 12 n for
 * sample n; "rgb", bytes n, n, n; with `both` the points of a grid whose cells have these have "p".
 */
#ifndef TESTS_SUPPORT_VTK_GRID_FILES_H
#define TESTS_SUPPORT_VTK_GRID_FILES_H

#include <stdbool.h>

#include "tests/support/vtk_writer.h"

typedef struct vtk_grid_style {
    vtk_xml_style xml;
    const char *type;       /* of "s"; NULL: Float32 */
    const char *attributes; /* of the grid's element, more than its extent; NULL: none */
    bool rectilinear;
    bool of_cells, both; /* 4 x 3 x 2 cells have the samples, not nodes */
    int lo[3];           /* the first node */
    unsigned cuts;       /* into pieces: 1: across x, 2: y, 4: z, and sums of these */
    int ghosts;          /* layers that pieces have beyond what they share */
} vtk_grid_style;

/* Files of the scratch folder; their paths. vtk_grid_files_parallel() - the pieces in files of
 * their own. */
const char *vtk_grid_files_xml(const char *name, const vtk_grid_style *g);
const char *vtk_grid_files_parallel(const char *name, const vtk_grid_style *g);
const char *vtk_grid_files_legacy(const char *name, const vtk_grid_style *g, int major, int minor);

/* vtk_grid_files_coordinate() - of node i along axis a of a rectilinear grid. */
double vtk_grid_files_coordinate(int a, int i);

#endif
