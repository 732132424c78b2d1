/* kind.h - the kinds of geometry: one row of functions each.
 *
 * A kind knows where its cells are and how the value runs along a ray inside one. Only its own
 * files (render/grid, render/mesh; likewise in stream/ and formats/) know more. A new kind adds its
 * own files, a number in formats/leaf/leaf.h and a row to three tables: CONTRIBUTING.md.
 */
#ifndef RENDER_RAY_KIND_H
#define RENDER_RAY_KIND_H

#include "render/leafcast.h"
#include "render/ray/extremes.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/ray_kernels.h"

struct camera;
struct projection;

typedef struct kind {
    const char *name; /* leafcast_info.kind */

    /* ---- An open volume ---- */

    /* open(): check the options, and make v->own: all that rays need beside treelets. close():
     * release as much of it as there is. */
    status (*open)(leafcast *v);
    void (*close)(leafcast *v);
    /* Set how treelets are read, where the kind has a choice. NULL: no choice. */
    void (*loading)(const leafcast *v, loader_options *o);
    /* Fill in what cells are and can do: cell, cells, nodes, abilities; dims, if nodes form a
     * lattice; bounds; and cell_size, which the caller has set to 1. */
    void (*describe)(const leafcast *v, leafcast_info *info);
    /* Corners, in world space, of a box around all that may be active for these isovalues; of the
     * whole volume if nothing may be. */
    void (*active_box)(const leafcast *v, uint32_t set, const double *isovalues, int count,
                       double corners[8][3]);
    /* Where a treelet's cells begin (span[0]) and end (span[1]) along the volume's own axes; the
     * whole volume is 0 to 1. */
    void (*span)(const leafcast *v, uint32_t t, double span[2][3]);

    /* ---- A frame ---- */

    /* ST_USAGE if the scene asks for something that this kind cannot do. */
    status (*check)(const leafcast *v, const leafcast_scene *scene);
    /* Set the tracer's box, the kind's own part and the levels of detail. c: see
     * volume_tracer(). */
    void (*aim)(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr);
    /* Tiles of primary rays. tile_side: pixels on a side, 1 to TILE_MAX, used also where rays go
     * one by one. tile_scratch: bytes that a tile needs. tile: kernels, one for each of CPU_ISAS.
     * Without kernels all may be NULL, like project(). */
    uint32_t tile_side;
    size_t tile_scratch;
    const tile_fn *tile;
    /* project(): the camera's projection; not `usable` where tiles are impossible.
     * projection_bytes(): the memory it takes. */
    status (*project)(leafcast *v, const struct camera *c, struct projection *out);
    size_t (*projection_bytes)(const leaf_layout *layout);

    /* ---- The order of treelets ---- */

    /* A treelet's rank in the order of a bundle. Ranks rise along each of its rays. */
    uint32_t (*rank)(const tracer *tr, uint32_t t, const ray_bundle *rays);

    /* ---- A ray ---- */

    /* Implement tracer_next(). */
    trace_result (*next)(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);
    /* Batches of rays. batch_scratch: bytes that a batch needs, here and for pieces. batch:
     * kernels, one for each of CPU_ISAS. A row without kernels may leave both out. */
    size_t batch_scratch;
    const batch_fn *batch;

    /* Find more pieces of a ray, for segments_next(). On entry state->first = state->sure = 0, and
     * ahead[0 .. count) were found before. On SEGMENTS_SOME the next state->sure of them are final.
     * NULL: cells of this kind overlap, or values are no polynomials. */
    segments_result (*segments)(const tracer *tr, const ray *r, segments_state *state,
                                ray_counters *counters);

    /* Kernels for the pieces of many rays, one for each of CPU_ISAS. They use batch_scratch. The
     * row may leave them out. */
    const segment_batch_fn *segment_batch;
    /* Implements segments_error_of(). */
    segments_error (*segments_error)(const tracer *tr, const ray *r, const double range[2]);

    /* The gradient along a piece in this treelet. s->cell may be unset where treelets do not
     * overlap. NULL: media of this kind are not shaded. */
    void (*gradient)(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                     segment_gradient *out);
    /* Treelets overlap. Then a piece may be given out after its treelet was evicted. */
    bool overlaps;

    /* Greatest and least values, for extreme_next(); both or neither. extreme_ways(): offer all
     * treelets on the ray's way to extreme_ways_take(), by the directory alone, in any order.
     * extreme(): offer the scores inside one treelet to extreme_offer(). */
    void (*extreme_ways)(const tracer *tr, const ray *r, extreme_ways *ways,
                         ray_counters *counters);
    void (*extreme)(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                    extreme_state *s, ray_counters *counters);
    /* Like extreme(), but only in some cells about t. NULL: not available. */
    void (*extreme_near)(const tracer *tr, const treelet *at, const ray *r, double t,
                         extreme_state *s, ray_counters *counters);
    /* Kernels for the extremes of many rays, one for each of CPU_ISAS. They use batch_scratch. The
     * row may leave them out. */
    const extreme_batch_fn *extreme_batch;

    /* ---- A cell ---- */

    /* Add what depends on the hit's cell: at, flat. NULL: nothing does. */
    status (*cell_of_hit)(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                          leafcast_hit *out);
    /* Implement leafcast_cell_indices(). NULL: cells have numbers alone. */
    int (*cell_indices)(const leafcast *v, uint32_t level, uint64_t cell, uint32_t index[3]);
    /* Set the corners of a cell, with their values. ST_USAGE: the level, above 0, has no such cell.
     * NULL: cells have no corners. */
    status (*cell_corners)(leafcast *v, uint32_t level, uint64_t cell, leafcast_cell *out);

    /* ---- A point ---- */

    /* The next treelet of a level of detail that may hold a point of world space: the first one
     * after `after`, or of all if that is LEAF_NO_TREELET. Returns LEAF_NO_TREELET at the end. */
    uint32_t (*treelet_at)(const leafcast *v, uint32_t level, const double point[3],
                           uint32_t after);
    /* Set *out to the cell of this treelet that holds the point, the values there and at the
     * nearest node, finite or not, and the gradient. *out stays unchanged where no cell does. */
    void (*cell_in)(const leafcast *v, const treelet *at, const double point[3],
                    leafcast_sample *out);
    /* About how many cells of level 0 a vector of world space passes. */
    double (*cells_along)(const leafcast *v, const double vector[3]);
    /* The plane of nodes number `node` across an axis, level 0, as a rectangle in world space.
     * origin: its corner at the first nodes of the two other axes. edges: along these. ST_USAGE
     * where there are no nodes of that number. */
    status (*layer)(const leafcast *v, int axis, uint32_t node, double origin[3],
                    double edges[2][3]);
} kind;

/* kind_of() - the row of a file's geometry. */
const kind *kind_of(const leaf_file *f);

#endif
