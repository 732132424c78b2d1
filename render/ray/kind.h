/* kind.h - the kinds of geometry: a row of a table each, with all that is asked of a kind.
 *
 * A kind knows where its cells are and what the value does along a ray inside one. Only its own
 * files (render/grid, render/mesh; likewise in stream/ and formats/) know more of it. Adding one
 * adds such files, a number in formats/leaf/leaf.h and a row to three tables: CONTRIBUTING.md.
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

    /* Check the options, make what rays need beside treelets: v->own. close() releases what there
     * is of it. */
    status (*open)(leafcast *v);
    void (*close)(leafcast *v);
    /* How treelets are to be read, where there are choices; NULL: as it is. */
    void (*loading)(const leafcast *v, loader_options *o);
    /* Extent: dims, tets, vertices, bounds; cell_size, which is 1 to begin with. */
    void (*describe)(const leafcast *v, leafcast_info *info);
    /* The box of what may be active for these isovalues, of everything where nothing is: its
     * corners in world space. */
    void (*active_box)(const leafcast *v, uint32_t set, const double *isovalues, int count,
                       double corners[8][3]);
    /* Where a treelet's cells are, along the volume's own axes: span[0] its begin, span[1] its end,
     * the volume's being 0 and 1. */
    void (*span)(const leafcast *v, uint32_t t, double span[2][3]);

    /* ---- A frame ---- */

    /* What the scene asks of this kind in vain: ST_USAGE. */
    status (*check)(const leafcast *v, const leafcast_scene *scene);
    /* The tracer's box, its kind's part and its levels of detail. c: see volume_tracer(). */
    void (*aim)(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr);
    /* Tiles of primary rays: pixels on a side, 1 to TILE_MAX, also where rays go one by one; bytes
     * that one needs; the kernels, CPU_ISAS of them. Where there are none, all may be NULL, like
     * project(). */
    uint32_t tile_side;
    size_t tile_scratch;
    const tile_fn *tile;
    /* The camera's; not usable where tiles are not possible. Memory that it takes. */
    status (*project)(leafcast *v, const struct camera *c, struct projection *out);
    size_t (*projection_bytes)(const leaf_layout *layout);

    /* ---- The order of treelets ---- */

    /* Where a treelet stands in the order of a bundle of rays: along each of them ranks rise. */
    uint32_t (*rank)(const tracer *tr, uint32_t t, const ray_bundle *rays);

    /* ---- A ray ---- */

    /* tracer_next(), tracer_surface(). */
    trace_result (*next)(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);
    surface_point (*surface)(const tracer *tr, const treelet *at, const ray *r, const hit *h);
    /* Many rays together: bytes that this, and their pieces, need; the kernels, CPU_ISAS of them.
     * Where there are none, the row may leave both out. */
    size_t batch_scratch;
    const batch_fn *batch;

    /* The pieces of a ray: what segments_next() is made of. state->first = state->sure = 0, so that
     * ahead[0 .. count) were found before. Result SEGMENTS_SOME: state->sure of them come next.
     * NULL, like cell_of_segment(): cells of this kind overlap, or values are no polynomials. */
    segments_result (*segments)(const tracer *tr, const ray *r, segments_state *state,
                                ray_counters *counters);

    /* Those of many rays together: the kernels, CPU_ISAS of them. Their scratch is that of batches.
     * The row may leave them out. */
    const segment_batch_fn *segment_batch;
    /* segments_error_of(). */
    segments_error (*segments_error)(const tracer *tr, const ray *r, const double range[2]);

    /* The gradient along a piece in this treelet; s->cell need not be set where treelets do not
     * overlap. NULL: media of this kind are not shaded. */
    void (*gradient)(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                     segment_gradient *out);
    /* Treelets overlap: a piece may be given out when its own is gone. */
    bool overlaps;

    /* Greatest and least values, which extreme_next() is made of; both or neither. All treelets on
     * the ray's way that it does not skip, by the directory alone, in any order. What there is in
     * one of them: extreme_offer(). */
    void (*extreme_ways)(const tracer *tr, const ray *r, extreme_ways *ways,
                         ray_counters *counters);
    void (*extreme)(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                    extreme_state *s, ray_counters *counters);
    /* The same in some cells about t, whatever is in the others; NULL: none. */
    void (*extreme_near)(const tracer *tr, const treelet *at, const ray *r, double t,
                         extreme_state *s, ray_counters *counters);
    /* Those of many rays together: the kernels, CPU_ISAS of them. Their scratch is that of batches.
     * The row may leave them out. */
    const extreme_batch_fn *extreme_batch;

    /* ---- A cell ---- */

    /* The cell of a hit, as leafcast_hit tells of it. */
    status (*cell_of_hit)(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                          leafcast_hit *out);
    /* The cell of a piece, as leafcast_segment tells of it. */
    void (*cell_of_segment)(const tracer *tr, const segment *s, leafcast_segment *out);
    /* ---- A point ---- */

    /* The treelets of a level of detail that may hold a point of world space, in the order in which
     * they are asked: the first one behind `after`, or of all (LEAF_NO_TREELET); LEAF_NO_TREELET
     * where there is none. */
    uint32_t (*treelet_at)(const leafcast *v, uint32_t level, const double point[3],
                           uint32_t after);
    /* The cell at a point that is in this one of them, its value there and the gradient; *out stays
     * where there is none. */
    void (*cell_in)(const leafcast *v, const treelet *at, const double point[3],
                    leafcast_sample *out);
    /* The value of a sample's nearest node, whatever it is. */
    double (*nearest)(const leafcast_sample *s, const double point[3]);
    /* Cells of level 0 that a vector of world space passes, about. */
    double (*cells_along)(const leafcast *v, const double vector[3]);
    /* The nodes of a plane of level 0 across an axis, as a rectangle: its corner at the first
     * nodes of the two other axes, and its edges along these, in world space. ST_USAGE where there
     * are no such nodes. */
    status (*layer)(const leafcast *v, int axis, uint32_t node, double origin[3],
                    double edges[2][3]);
} kind;

/* kind_of() - the row of a file's geometry. */
const kind *kind_of(const leaf_file *f);

#endif
