/* marching_cell.h - the isosurface in a cell whose values are trilinear: which case of
 * marching_table.h it is, and where centres lie. f: values at the corners
 * (formats/base/hexahedron.h) minus the isovalue. u: the cell's parameters.
 */
#ifndef PREP_EXPORT_MARCHING_CELL_H
#define PREP_EXPORT_MARCHING_CELL_H

#include "formats/base/hexahedron.h"
#include "prep/export/marching_table.h"

/* marching_cell_case() - by the corners inside (one bit each) and, on faces that these leave
 * undecided, whether the bilinear form joins them. Cells that share a face get the same answer. */
const marching_case *marching_cell_case(const marching_table *t, int mask,
                                        const double f[HEX_CORNERS]);

/* marching_cell_centre() - centre n of a case: by bisection from the middle of its loop, on the
 * surface. marching_cell_value() - the form at u, and its derivatives by the parameters. */
void marching_cell_centre(const marching_table *t, const marching_case *m, int n,
                          const double f[HEX_CORNERS], double u[3]);
double marching_cell_value(const double f[HEX_CORNERS], const double u[3], double gradient[3]);

#endif
