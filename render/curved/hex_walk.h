/* hex_walk.h - a ray, or a point, in a treelet whose cells are hexahedra, or other curved cells:
 * what is the same for all kinds of such treelets.
 *
 * A kind says which cells a ray may cross, one after another (hex_way); of these, the exact cell
 * decides.
 */
#ifndef RENDER_CURVED_HEX_WALK_H
#define RENDER_CURVED_HEX_WALK_H

#include "formats/curved/curved_cell.h"
#include "render/curved/hex_roots.h"
#include "render/leafcast.h"
#include "render/ray/extremes.h"
#include "render/ray/segments.h"

/* A ray's cells in a treelet. */
typedef struct hex_way hex_way;
struct hex_way {
    const ray *ray;
    sheared_ray sheared;
    ray_counters *counters;
    /* Go on to the next cell that the ray may cross, among those that it enters at `limit` or
     * before; any order. False: there is none. */
    bool (*next)(hex_way *w, double limit, curved_cell *out);
};

/* hex_walk_hits() - treelet_walks.hits: lower state->best to the first root of an isovalue that
 * counts, and set state->point to it; if any will do, to some root, without the point. Returns
 * whether state->best changed.
 *
 * counts   added to: what could not be proven is among it; may be NULL */
bool hex_walk_hits(hex_way *w, const isovalue_list *isos, trace_state *state, path_counts *counts);

/* hex_walk_surface() - the surface point of a hit at parameters at[] of its cell. */
surface_point hex_walk_surface(const curved_cell *c, const double at[3], const ray *r, double t);

/* hex_walk_pieces() - the pieces of the ray, cut to its [t0, t1]; in each cell in order of t.
 *
 * above       subtracted from all values
 * tolerance   what a piece's cubic may be off (hex_pieces())
 * take        is given each piece; its treelet is not set */
typedef void hex_taker(void *ctx, const segment *piece);
void hex_walk_pieces(hex_way *w, double above, double tolerance, double limit, hex_taker *take,
                     void *ctx, path_counts *counts);

/* hex_walk_hold() - the same for treelet_walks.segments of a treelet: all pieces are held. id: the
 * treelet's. hex_walk_extremes() - for treelet_walks.extremes: the pieces up to `limit` are
 * offered. */
void hex_walk_hold(hex_way *w, uint32_t id, double above, double tolerance, segments_state *state);
void hex_walk_extremes(hex_way *w, uint32_t id, double tolerance, double limit,
                       extreme_state *state);

/* hex_walk_sample() - what is at a point, if the cell holds it; returns whether it does. Sets all
 * but the treelet. */
bool hex_walk_sample(const curved_cell *c, const double point[3], leafcast_sample *out);

/* hex_walk_gradient() - kind.gradient along a piece in the cell. */
void hex_walk_gradient(const curved_cell *c, const ray *r, const segment *s, segment_gradient *out);

/* hex_walk_at() - kind.cell_of_hit. hex_walk_corners() - kind.cell_corners. */
void hex_walk_at(const curved_cell *c, const ray *r, double t, leafcast_hit *out);
void hex_walk_corners(const curved_cell *c, leafcast_cell *out);

/* hex_walk_error() - kind.segments_error of pieces in the box: values err by the tolerance and the
 * roundings of the trilinear form, t by those of the way to the cell; a face that is seen at less
 * than 2^-20 of a right angle is not bounded. */
segments_error hex_walk_error(const double box[2][3], double tolerance, const ray *r,
                              const double range[2]);

/* hex_walk_tolerance() - what pieces may be off in a volume with values in a range: a picture shows
 * steps of 2^-8. Of nothing but one value, or none, all pieces are exact. */
double hex_walk_tolerance(double least, double most);

#endif
