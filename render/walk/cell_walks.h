/* cell_walks.h - what is in a treelet whose cells are records (stream/cell_resident.h): all that
 * rays and points ask, by what a kind says of one cell.
 *
 * Cells are visited by the tree over their boxes, in the order of tree_passage.h. Those without
 * interest are skipped. Where cells overlap they do not know of each other: each has its hits and
 * pieces, and at a point the first one in the file's order counts.
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

/* What a kind says of a cell. The line of a ray: all t, whatever its [t0, t1]. Of cells that share
 * a face, one has the points of the face and the rays in it, and both find the same bits of t where
 * a ray passes it. */
typedef struct cell_kind {
    /* Offer where the line meets the cell's isosurfaces to cell_hit(): of each of tr->isos, v, that
     * the cell's range meets, min < v <= max (stream/interest.h). So a surface at a joint of two
     * cells is there once. Where a line meets the surface once at most, leave out the one that the
     * ray begins on (state->origin, origin_iso). */
    void (*hits)(const tracer *tr, const cell *c, const ray *r, trace_state *state);
    /* The surface point of a hit. A shadow ray goes error / |gradient . direction| before a hit
     * counts, span at most. */
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

/* CELL_WALKS_ROW - the part of a kind's row that follows from its cells. The row has, besides:
 * name, cell, cells, degree, describe; segments_error: a bound for any ray and any cell with values
 * in range[] (ray/segments.h), so a record needs a least size if its values are steep. */
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
void cell_walks_describe(const leafcast *v, leafcast_info *info);

#endif
