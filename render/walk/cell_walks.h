/* cell_walks.h - walks through a treelet whose cells are records (stream/cell_resident.h). They
 * answer all questions of rays and points by a kind's functions of a single cell.
 *
 * Cells are visited by the tree over their boxes, in the order of tree_passage.h. Cells without
 * interest are skipped. Cells may overlap: then each has its own hits and pieces, and at a point
 * the cell that comes first in the file counts.
 */
#ifndef RENDER_WALK_CELL_WALKS_H
#define RENDER_WALK_CELL_WALKS_H

#include "render/walk/tree_walks.h"
#include "stream/cell_resident.h"

/* A cell of a treelet. */
typedef struct cell {
    const void *record;
    uint64_t number; /* in the whole file */
} cell;

/* A kind's functions of one cell. The line of a ray has all t, whatever the ray's [t0, t1]. If two
 * cells share a face, only one of them owns the points of the face and the rays in it. Where a ray
 * crosses the face, both find the same t, to the bit. */
typedef struct cell_kind {
    /* Offer where the line meets the cell's isosurfaces to cell_hit(): of each of tr->isos, v, that
     * the cell's range meets, min < v <= max (stream/interest.h). So a surface at a joint of two
     * cells is there once. Where a line meets the surface once at most, leave out the one that the
     * ray begins on (state->origin, origin_iso). */
    void (*hits)(const tracer *tr, const cell *c, const ray *r, trace_state *state);
    /* Returns the surface point of a hit. From there, a shadow ray ignores hits up to t = error /
     * |gradient . direction|, at most up to t = span. */
    surface_point (*surface)(const tracer *tr, const cell *c, const ray *r, const hit *h);
    /* Set the piece of the line in the cell: t0, t1, b[] of the kind's degree; and spread =
     * SEGMENT_EVEN if all of the cell has the one value b[1], exactly. False: there is none. */
    bool (*piece)(const cell *c, const ray *r, segment *out);
    /* Whether the cell holds a point. */
    bool (*holds)(const cell *c, const double point[3]);
    /* The value and the gradient at a point of the cell, or beside it by rounding. */
    double (*value)(const cell *c, const double point[3], double gradient[3]);
} cell_kind;

/* cell_hit() - take a hit of a cell if it is the best so far. Returns whether it is. entering: the
 * value rises along the ray. */
static inline bool cell_hit(trace_state *state, const ray *r, const hit *h) {
    if (h->t < r->t0 || h->t > r->t1 || !hit_less(&state->after, h) || !hit_less(h, &state->best))
        return false;
    state->best = *h;
    return true;
}

/* CELL_WALKS_ROW - the members of a kind's row that follow from its functions of one cell. The kind
 * adds: name, cell, cells, degree, describe and segments_error. segments_error must bound the error
 * for any ray and any cell with values in range[] (ray/segments.h). So records whose values are
 * steep need a least size. */
#define CELL_WALKS_ROW                                                                             \
    .check = cell_walks_check, .aim = cell_walks_aim, .walks = &tree_walks, .inside = &cell_walks, \
    .gradient = cell_walks_gradient, .cell_in = cell_walks_cell_in

extern const treelet_walks cell_walks;

status cell_walks_check(const leafcast *v, const leafcast_scene *scene);
void cell_walks_aim(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr);
void cell_walks_gradient(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                         segment_gradient *out);
void cell_walks_cell_in(const leafcast *v, const treelet *at, const double point[3],
                        leafcast_sample *out);

/* cell_walks_describe() - cells, bounds and cell_size of a volume of such cells. */
void cell_walks_describe(const leafcast *v, uint32_t step, leafcast_info *info);

#endif
