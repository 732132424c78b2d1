/* curvilinear_walk.h - a ray, or a point, in one treelet of a curvilinear grid
 * (stream/curvilinear_lattice.h).
 *
 * Blocks come from the tree over them, in the order of tree_passage.h. In a block all nodes are
 * placed in the ray's space at once, which leaves the few cells that the ray may cross
 * (hex_block.h); of these, the exact cell decides (render/curved/). Cells without interest are
 * skipped.
 */
#ifndef RENDER_CURVILINEAR_CURVILINEAR_WALK_H
#define RENDER_CURVILINEAR_CURVILINEAR_WALK_H

#include "render/curved/hex_block.h"
#include "render/curved/hex_walk.h"
#include "stream/curvilinear_lattice.h"

/* curvilinear_walk_hits() - treelet_walks.hits: lower state->best to the first root of an isovalue
 * in the treelet that counts, and set state->point to it; if any will do, to some root, without the
 * point. Returns whether state->best changed.
 *
 * cells    of hex_block_cells
 * counts   added to: what could not be proven is among it */
bool curvilinear_walk_hits(const curvilinear_lattice *l, hex_block_fn cells,
                           const isovalue_list *isos, const ray *r, trace_state *state,
                           ray_counters *counters, path_counts *counts);

/* curvilinear_walk_pieces(), curvilinear_walk_hold(), curvilinear_walk_extremes() - hex_walk.h's,
 * of the blocks that the ray enters up to the limit, and leaves behind `after`, or behind part->t0.
 */
void curvilinear_walk_pieces(const curvilinear_lattice *l, hex_block_fn cells, double above,
                             double tolerance, const ray *r, const hit *after, double limit,
                             hex_taker *take, void *ctx, ray_counters *counters,
                             path_counts *counts);
void curvilinear_walk_hold(const curvilinear_lattice *l, hex_block_fn cells, uint32_t id,
                           double above, double tolerance, const ray *r, const hit *after,
                           segments_state *state, ray_counters *counters);
void curvilinear_walk_extremes(const curvilinear_lattice *l, hex_block_fn cells, uint32_t id,
                               double tolerance, const ray *r, const ray *part,
                               extreme_state *state, ray_counters *counters);

/* curvilinear_walk_point() - kind.cell_in: find the cell that holds a point. Set *out to it; if
 * none does, *out stays unchanged. Returns whether one does. Of active cells and others. */
bool curvilinear_walk_point(const curvilinear_lattice *l, const double point[3],
                            leafcast_sample *out);

/* curvilinear_walk_cell() - a cell of the treelet, by its number there. curvilinear_walk_sense() -
 * its hexahedron_sense(), as the file says. curvilinear_walk_hexahedron() - both. */
hexahedron curvilinear_walk_cell(const curvilinear_lattice *l, uint32_t index);
int curvilinear_walk_sense(const curvilinear_lattice *l, uint32_t index);
curved_cell curvilinear_walk_hexahedron(const curvilinear_lattice *l, uint32_t index);

#endif
