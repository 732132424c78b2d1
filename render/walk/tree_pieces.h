/* tree_pieces.h - one ray's pieces through a volume with a tree over its treelets, in order of t
 * (segments.h).
 *
 * Treelets overlap, so pieces of several are merged. A piece is given out once every treelet that
 * the ray has yet to enter begins behind its start (tree_passage.h). Until then it is kept, in
 * order, among the pieces ahead. If there is no room for one more, the last piece ahead is dropped,
 * with everything behind it. The pieces before it are given out, and the ray begins once more
 * behind them. So any room, even for one piece, gives the same pieces; but each time it runs out,
 * treelets are entered again. A ray meets some 20 to 100 tets in a treelet of the usual size, and
 * is in two or three treelets at a time.
 */
#ifndef RENDER_WALK_TREE_PIECES_H
#define RENDER_WALK_TREE_PIECES_H

#include "render/ray/segments.h"

/* tree_pieces() - kind_walks.segments. */
segments_result tree_pieces(const tracer *tr, const ray *r, segments_state *state,
                            ray_counters *counters);

/* tree_pieces_hold() - put a piece among the pieces ahead, unless it was given out before, or lies
 * where pieces were dropped. */
void tree_pieces_hold(segments_state *s, const segment *piece);

#endif
