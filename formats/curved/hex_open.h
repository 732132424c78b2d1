/* hex_open.h - wedges and tets without the edges and corners that are the same.
 *
 * Where a hexahedron collapses, its map has no inverse, and bounds of it (path_stretch.h) fail near
 * there. But in a wedge position and value are linear in the triangle times linear along, and so
 * they are in a hexahedron whose ends are that triangle's parallelograms. In a tet they are linear,
 * as in its parallelepiped. So is a pyramid whose base is a parallelogram, value included. The
 * parameters of these are polynomials of the cell's own. All other cells stay as they are.
 */
#ifndef FORMATS_CURVED_HEX_OPEN_H
#define FORMATS_CURVED_HEX_OPEN_H

#include "formats/curved/cell_form.h"
#include "formats/curved/hex_path.h"

typedef struct hex_opened {
    curved_map map;
    /* Which of the cell's edges were opened: along an axis, at a side of another; at a side of a
     * third, all four corners. Axis -1: none were. */
    int along, across, edge_side, apex, apex_side;
} hex_opened;

/* hex_open() - open the cell of a path. */
void hex_open(const hexahedron *h, const hex_path *path, hex_opened *out);

/* hex_open_into() - the cell's own parameters become those of the opened one.
 * hex_open_out() - the other way round, as far as they are in the cell. hex_open_parts() - the
 * parts of the path it was opened for, with parameters of the opened one. */
void hex_open_into(const hex_opened *o, double at[3]);
void hex_open_out(const hex_opened *o, double at[3]);
void hex_open_parts(const hex_opened *o, const hex_path *path, path_part out[PATH_PARTS]);

#endif
