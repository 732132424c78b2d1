/* kind.h - the kinds of geometry: one row of functions each.
 *
 * A kind knows where its cells are, and the value along a ray inside a cell. Only its own files
 * (render/grid, render/mesh; likewise in stream/ and formats/) know more. A row is a required core,
 * and capabilities that may be NULL. A kind whose treelets have boxes needs little more than
 * functions of a single cell: walk/ has all the walks. A new kind adds its own files, a number in
 * formats/leaf/leaf.h and a row to three tables: CONTRIBUTING.md.
 */
#ifndef RENDER_RAY_KIND_H
#define RENDER_RAY_KIND_H

#include "render/leafcast.h"
#include "render/ray/extremes.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/ray_kernels.h"
#include "render/ray/segments.h"

struct camera;
struct projection;

/* ---- How rays and points find cells: walk/tree_walks.h, or a kind's own ---- */

typedef struct kind_walks {
    /* Treelets overlap. Then a piece may be given out after its treelet was evicted. */
    bool overlaps;

    /* Set the corners, in world space, of a box around all cells that may be active for these
     * isovalues. If there are none, the box of the whole volume. */
    void (*active_box)(const leafcast *v, uint32_t set, const double *isovalues, int count,
                       double corners[8][3]);
    /* Where a treelet's cells begin (span[0]) and end (span[1]) along the volume's own axes; the
     * whole volume is 0 to 1. */
    void (*span)(const leafcast *v, uint32_t t, double span[2][3]);
    /* Returns about how many cells of level 0 a world-space vector crosses. */
    double (*cells_along)(const leafcast *v, const double vector[3]);
    /* Returns a treelet's rank in the order of a bundle: ranks rise along each ray of the bundle.
     */
    uint32_t (*rank)(const tracer *tr, uint32_t t, const ray_bundle *rays);

    /* Implement tracer_next(). */
    trace_result (*next)(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);
    /* Find more pieces of a ray, for segments_next(). On entry state->first = state->sure = 0, and
     * ahead[0 .. count) were found before. On SEGMENTS_SOME the next state->sure of them are final.
     */
    segments_result (*segments)(const tracer *tr, const ray *r, segments_state *state,
                                ray_counters *counters);
    /* Greatest and least values, for extreme_next(). extreme_ways(): offer all treelets on the
     * ray's way to extreme_ways_take(), by the directory alone, in any order. extreme(): offer the
     * scores inside one treelet to extreme_offer(). extreme_near(): the same, but only in some
     * cells about t. */
    void (*extreme_ways)(const tracer *tr, const ray *r, extreme_ways *ways,
                         ray_counters *counters);
    void (*extreme)(const tracer *tr, const treelet *at, const ray *r, const extreme_way *way,
                    extreme_state *s, ray_counters *counters);
    void (*extreme_near)(const tracer *tr, const treelet *at, const ray *r, double t,
                         extreme_state *s, ray_counters *counters);

    /* Returns the next treelet of a level of detail that may hold a world-space point: the first
     * one after `after`, or the first of all if `after` is LEAF_NO_TREELET. LEAF_NO_TREELET: none.
     */
    uint32_t (*treelet_at)(const leafcast *v, uint32_t level, const double point[3],
                           uint32_t after);
} kind_walks;

/* ---- Capabilities: kernels for many rays together, one for each of CPU_ISAS ---- */

/* Tiles of primary rays (frame/tile.h). */
typedef struct kind_tiles {
    uint32_t side;  /* pixels on a side, 1 to TILE_MAX, used also where rays go one by one */
    size_t scratch; /* bytes that a tile needs */
    bool colours;   /* kernels colour surfaces by value, or by their own colours */
    const tile_fn *kernels;
    /* project(): the camera's projection; not `usable` where tiles are impossible.
     * projection_bytes(): the memory it takes. */
    status (*project)(leafcast *v, const struct camera *c, struct projection *out);
    size_t (*projection_bytes)(const leaf_layout *layout);
} kind_tiles;

/* Batches of rays: their hits, pieces and extremes. Each may be NULL. */
typedef struct kind_batches {
    size_t scratch; /* bytes that any of them needs */
    const batch_fn *hits;
    const segment_batch_fn *pieces;
    const extreme_batch_fn *extremes;
} kind_batches;

/* ---- The row ---- */

typedef struct kind {
    const char *name; /* leafcast_info.kind */
    const char *cell; /* leafcast_info.cell: what one is called */
    /* Its cells are pieces of a surface, which is drawn whatever their values, as long as these are
     * finite. Isovalues do not matter: the first surface that is selected says how it looks. It has
     * no pieces, no extremes, and holds no points. */
    bool given;
    /* A surface that lies over a plane, a value to each place of it: a point has the value at its
     * own place, whether it is above or below. Where these are colours (tracer.coloured), it is
     * not drawn itself. */
    bool draped;

    /* ---- An open volume ---- */

    /* open(): make v->own: all that rays need beside treelets. close(): release as much of it as
     * there is. NULL: they need nothing. */
    status (*open)(leafcast *v);
    void (*close)(leafcast *v);
    /* Fill in what cells there are and what they can do: cells, nodes, abilities; dims, if nodes
     * form a lattice; bounds, at this step; and cell_size, which the caller has set to 1. */
    void (*describe)(const leafcast *v, uint32_t step, leafcast_info *info);

    /* ---- A frame ---- */

    /* ST_USAGE if the scene asks for something that this kind cannot do. */
    status (*check)(const leafcast *v, const leafcast_scene *scene);
    /* Set the tracer's box, the kind's own part and the levels of detail. c: see
     * volume_tracer(). */
    void (*aim)(leafcast *v, const leafcast_scene *scene, const struct camera *c, tracer *tr);

    /* ---- Rays and points ---- */

    const kind_walks *walks;
    const struct treelet_walks *inside; /* for tree_walks: what is in a treelet */
    const struct cell_kind *cells;      /* for cell_walks: what is in a cell (walk/cell_walks.h) */
    uint32_t degree;                    /* of all pieces: 1 or 3 */
    /* Implements segments_error_of(). */
    segments_error (*segments_error)(const tracer *tr, const ray *r, const double range[2]);
    /* Set *out to the gradient along a piece in this treelet. s->cell may be unset for kinds whose
     * treelets do not overlap. */
    void (*gradient)(const tracer *tr, const treelet *at, const ray *r, const segment *s,
                     segment_gradient *out);
    /* Find the cell of this treelet that holds the point. Set *out to the cell, the value at the
     * point, the value at the nearest corner (without corners: the same), and the gradient. Values
     * may be not finite. If no cell holds the point, *out stays unchanged. */
    void (*cell_in)(const leafcast *v, const treelet *at, const double point[3],
                    leafcast_sample *out);
    /* Set rgb[] to the light at a point, of values that are colours. Returns false, and leaves
     * rgb[], where cell_in() finds no value. NULL: its values are no colours at points. */
    bool (*colour_in)(const leafcast *v, const treelet *at, const double point[3], float rgb[3]);

    /* ---- Capabilities; NULL: none ---- */

    const kind_tiles *tiles;     /* NULL: primary rays go one by one */
    const kind_batches *batches; /* NULL: all rays go one by one */
    /* Choose how treelets are read, if the kind has a choice. */
    void (*loading)(const leafcast *v, loader_options *o);
    /* Set the members of a hit that depend on its cell: at, flat. */
    status (*cell_of_hit)(leafcast *v, const tracer *tr, const ray *r, const hit *h,
                          leafcast_hit *out);
    /* Implement leafcast_cell_indices(). NULL: cells have numbers alone. */
    int (*cell_indices)(const leafcast *v, uint32_t level, uint64_t cell, uint32_t index[3]);
    /* Set the corners of a cell, with their values. ST_USAGE: the level, above 0, has no such cell.
     * NULL: cells have no corners. */
    status (*cell_corners)(leafcast *v, uint32_t level, uint64_t cell, leafcast_cell *out);
    /* Describe the plane of level-0 nodes with number `node` on an axis, as a rectangle in world
     * space. origin: its corner at the first nodes of the two other axes. edges: its edges along
     * these. ST_USAGE: there is no such node. NULL: nodes do not lie in planes. */
    status (*layer)(const leafcast *v, int axis, uint32_t node, double origin[3],
                    double edges[2][3]);
} kind;

/* kind_of() - returns the row of a file's kind. */
const kind *kind_of(const leaf_file *f);

/* kind_tile_side() - pixels on a side of the tiles that a kind's primary rays are traced in. */
static inline uint32_t kind_tile_side(const kind *k) {
    return k->tiles ? k->tiles->side : TILE_MAX;
}

/* kind_batch_scratch() - bytes for any batch of a kind's rays. */
static inline size_t kind_batch_scratch(const kind *k) {
    return k->batches ? k->batches->scratch : 0;
}

#endif
