/* tracer.h - one ray through a whole volume, treelet by treelet, resumable.
 *
 * A ray suspends when it meets an active treelet that is not resident. Its state says where to
 * resume, and its result so far. Treelets come in order, and a hit is final only when nothing
 * unresolved can come before it. So the answer does not depend on what was resident when. The order
 * and the content of treelets belong to the volume's kind: grid/grid_tracer.h, mesh/mesh_tracer.h.
 */
#ifndef RENDER_RAY_TRACER_H
#define RENDER_RAY_TRACER_H

#include <stdatomic.h>

#include "render/ray/affine.h"
#include "render/ray/counters.h"
#include "render/ray/isovalue_list.h"
#include "render/ray/placement.h"
#include "render/ray/ray.h"
#include "render/ray/ray_bundle.h"
#include "render/ray/surface_point.h"
#include "stream/loader.h"

enum { TRACER_ROOM = 128 };

/* A volume at a place, prepared for the rays of a frame. Not to be moved: `own` may point into it.
 */
typedef struct tracer {
    const struct kind *kind;
    const struct ray_kernels *kernels; /* for many rays together (ray_kernels.h) */
    const struct walk_choice *choice;  /* how rays walk, if an experiment chooses; else NULL */
    const void *own;                   /* the kind's part */
    loader *treelets;
    int twin; /* the first object of the frame with the same loader, perhaps this one */
    const leaf_layout *layout;
    uint32_t set; /* the set of values that is drawn */
    isovalue_list isos;
    affine space;     /* of the volume's own world */
    placement place;  /* of that world in the scene's; kinds need not know */
    double box[2][3]; /* of the volume, grid space */
    bool boxed;       /* cut rays to the box; for coarse levels, which reach past it */
    bool preview;     /* draw what is resident instead of suspending */
    bool lenient;     /* go on without treelets that are lost (loader_tolerate()), in no preview */
    bool doubts;      /* and mark what is absent by doubts among the pieces (segments.h) */
    bool coloured;    /* surfaces have colours of their own (surface_point.own) */
    bool coarse;      /* the picture may be coarser than the data even where no treelet is absent */
    double above;     /* subtracted from the values of pieces (segments.h) */
    uint32_t target_level; /* the level that is drawn; */
    const uint8_t *stop;   /* also draw treelets whose entry is 1; may be NULL */
    atomic_uchar *touched; /* per treelet: set when a ray walked it */
    int clip_count;
    double clip[32][4];                 /* half-spaces n . p + d >= 0 of the scene's world */
    _Alignas(8) char room[TRACER_ROOM]; /* for `own`, where objects of one volume differ in it */
} tracer;

typedef enum trace_result { TRACE_HIT, TRACE_MISS, TRACE_BLOCKED } trace_result;

/* A ray's search for its next hit. */
typedef struct trace_state {
    hit after;          /* only hits strictly behind this one count */
    uint64_t origin;    /* the ray begins on this cell's surface of isovalue */
    int32_t origin_iso; /* origin_iso, which it skips where that is flat; below 0: begins on none */
    hit best;           /* the nearest found so far; none: hit_none() */
    surface_point point; /* of best */
    double t_from;       /* where to resume; */
    uint32_t blocked;    /* at this treelet; LEAF_NO_TREELET: from the start */
    bool provisional;    /* preview: something was drawn coarser than wanted, or not yet at all */
    bool any;            /* any hit will do as best; its point is not needed */
} trace_state;

/* tracer_ray() - make a ray from one of the scene's world for t in [t0, t1], cut by the clip
 * planes. Returns false when nothing of it is left. */
bool tracer_ray(const tracer *tr, const double origin[3], const double direction[3], double t0,
                double t1, ray *out);

/* tracer_ray_at() - the same of a volume whose own world lies at `place` instead of tr->place. */
bool tracer_ray_at(const tracer *tr, const placement *place, const double origin[3],
                   const double direction[3], double t0, double t1, ray *out);

/* tracer_enters_by() - returns the number of the clip plane through which a world-space ray, from
 * t = 0 on, enters the part that no plane cuts off. Sets *t to the t of that point. Returns -1 if
 * the ray begins inside that part, or misses it. */
int tracer_enters_by(const tracer *tr, const double origin[3], const double direction[3],
                     double *t);

/* tracer_direction(), tracer_ray_along() - tracer_ray() in two steps, for many rays of one
 * direction: first convert the direction to grid space, then make each ray. out->d must hold that
 * direction. */
void tracer_direction(const tracer *tr, const double direction[3], double in_grid[3]);
bool tracer_ray_along(const tracer *tr, const double origin[3], const double direction[3],
                      double t0, double t1, ray *out);

/* trace_begin() - returns a search for the first hit strictly behind `after`. trace_begin_at() -
 * set *s to the same, without the copy: for short rays a copy costs some per cent of the time. */
static inline void trace_begin_at(trace_state *s, const hit *after) {
    s->after = *after;
    s->origin = UINT64_MAX;
    s->origin_iso = -1;
    s->best = hit_none();
    s->t_from = -INFINITY;
    s->blocked = LEAF_NO_TREELET;
    s->provisional = s->any = false;
}
static inline trace_state trace_begin(const hit *after) {
    trace_state s = {0};
    trace_begin_at(&s, after);
    return s;
}

/* tracer_next() - search until the next hit is certain (state->best, state->point), nothing is
 * left, or the treelet state->blocked is needed. */
trace_result tracer_next(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);

/* tracer_find() - the same, but the point stays in the volume's own world. tracer_take_back() -
 * take it to the scene's, once the search has ended: for batches, which do this for all rays
 * together. */
trace_result tracer_find(const tracer *tr, const ray *r, trace_state *state,
                         ray_counters *counters);
void tracer_take_back(const tracer *tr, const ray *r, trace_result result, trace_state *state);

/* tracer_take_back_from() - take a point at t on a ray from the volume's own world to the scene's,
 * in which it lies at `place`. */
void tracer_take_back_from(const tracer *tr, const placement *place, const ray *r, double t,
                           surface_point *point);

/* tracer_bundle() - a bundle of the scene's rays, as the volume's own world has it. */
ray_bundle tracer_bundle(const tracer *tr, const ray_bundle *rays);

/* tracer_gradient() - kind.gradient(), in the scene's world. */
struct segment;
struct segment_gradient;
void tracer_gradient(const tracer *tr, const treelet *at, const ray *r, const struct segment *s,
                     struct segment_gradient *out);

/* tracer_corners() - the corners of the volume's box, in the scene's world. */
void tracer_corners(const tracer *tr, double corners[8][3]);

/* ---- For kinds ---- */

/* tracer_box() - cut [t0, t1] to the volume's closed box. Returns false when nothing is left. */
bool tracer_box(const tracer *tr, const ray *r, double *t0, double *t1);

/* tracer_stand_in() - t, or what stands in for it if it is lost. */
uint32_t tracer_stand_in(const tracer *tr, uint32_t t);

/* tracer_range() - the least and the greatest value in treelet t, by the directory. */
static inline const float *tracer_range(const tracer *tr, uint32_t t) {
    return tr->treelets->file->own[leaf_layout_samples(tr->layout, tr->set, t)];
}

/* tracer_touch() - mark treelet t as walked by a ray. */
static inline void tracer_touch(const tracer *tr, uint32_t t) {
    if (!atomic_load_explicit(&tr->touched[t], memory_order_relaxed))
        atomic_store_explicit(&tr->touched[t], 1, memory_order_relaxed);
}

/* tracer_resumes() - whether a ray that was blocked resumes at treelet t. */
static inline bool tracer_resumes(const tracer *tr, uint32_t t, uint32_t blocked) {
    return t == blocked || (tr->lenient && tracer_stand_in(tr, t) == tracer_stand_in(tr, blocked));
}

/* tracer_enter() - returns the active treelet t, which the ray enters at t_in; of a lenient tracer,
 * the coarser one that stands in for it, if it is lost. NULL: it is absent. *blocked is
 * LEAF_NO_TREELET if the ray goes on without it, as a preview does, and a lenient ray if nothing
 * stands in. Else the ray must stop; *blocked and *t_from then say where to resume. *provisional:
 * set if another treelet than t, or none, is drawn. The three pointers are members of the ray's
 * state, a trace_state or segments_state. tracer_enter_lenient() - the part of lenient tracers. */
const treelet *tracer_enter_lenient(const tracer *tr, uint32_t t, uint32_t *blocked,
                                    bool *provisional);
static inline const treelet *tracer_enter(const tracer *tr, uint32_t t, double t_in, double *t_from,
                                          uint32_t *blocked, bool *provisional) {
    const treelet *at = loader_lookup(tr->treelets, t);
    if (at) {
        tracer_touch(tr, t);
        return at;
    }
    *blocked = t;
    if (tr->preview) {
        *blocked = LEAF_NO_TREELET;
        *provisional = true;
    } else if (tr->lenient) {
        at = tracer_enter_lenient(tr, t, blocked, provisional);
    }
    if (*blocked != LEAF_NO_TREELET)
        *t_from = t_in;
    return at;
}

#endif
