#include "render/ray_integrator.h"

#include <math.h>
#include <string.h>

#include "render/kind.h"
#include "render/surface_search.h"

typedef struct own_ray {
    ray_record head;
    surface_search search;
} own_ray;

static own_ray *own_ray_of(ray_record *r) {
    return (own_ray *)r;
}

static const ray_look *look_of(const frame *f) {
    return f->look;
}

static void own_begin(const frame *f, uint32_t pixel, ray_record *r) {
    own_ray *p = own_ray_of(r);
    *p = (own_ray){.head = {.pixel = pixel}, .search = surface_search_first()};
    p->search.any = !look_of(f)->hits;
}

/* How far t may be off. */
static double error_of(const surface_point *point, const double direction[3]) {
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += point->gradient[a] * direction[a];
    return slope != 0.0 ? point->error / fabs(slope) : INFINITY;
}

static leafcast_ray_hit no_hit(void) {
    return (leafcast_ray_hit){.t = INFINITY, .volume = -1, .surface = -1};
}

/* Hit h with volume v, and its point, on a ray. */
static leafcast_ray_hit hit_of(const frame *f, const leafcast_ray *from, int v, const hit *h,
                               const surface_point *point) {
    leafcast_ray_hit out = {.t = h->t,
                            .volume = v,
                            .surface = look_of(f)->first_id[v] + h->iso,
                            .isovalue = f->tracer[v].isos.isovalues[h->iso],
                            .cell = h->cell,
                            .entering = h->entering,
                            .error_bound = error_of(point, from->direction)};
    memcpy(out.normal, point->normal, sizeof out.normal);
    return out;
}

static leafcast_ray_hit found_by(const frame *f, const leafcast_ray *from,
                                 const surface_search *s) {
    return hit_exists(&s->found) ? hit_of(f, from, s->found_volume, &s->found, &s->point)
                                 : no_hit();
}

static bool own_advance(const frame *f, ray_record *r, ray_counters *counters) {
    const ray_look *look = look_of(f);
    own_ray *p = own_ray_of(r);
    const size_t i = p->head.pixel;
    if (i >= look->count)
        return true;
    const leafcast_ray *own = &look->rays[i];
    world_ray w = {.t0 = own->t0, .t1 = own->t1};
    memcpy(w.origin, own->origin, sizeof w.origin);
    memcpy(w.direction, own->direction, sizeof w.direction);
    if (!surface_search_next(f, &w, NULL, &p->head.volume, &p->search, counters)) {
        p->head.blocked = p->search.state.blocked;
        return false;
    }
    if (look->hits)
        look->hits[i] = found_by(f, own, &p->search);
    else
        look->occluded[i] = hit_exists(&p->search.found);
    return true;
}

/* They have no order in common; that of the first is as good as any. */
static ray_bundle own_bundle(const frame *f, uint32_t leg) {
    const double *d = look_of(f)->rays[0].direction;
    (void)leg;
    return (ray_bundle){RAYS_ALONG, {d[0], d[1], d[2]}};
}

/* ---- Tiles ---- */

/* Rays that go together; results are written as they come, and bound those of volumes to come. */
typedef struct own_batch {
    const frame *f;
    tile_outcome *out;
    ray_counters *counters;
    unsigned count;
    uint32_t pixel[RAY_BATCH];
    uint16_t in_tile[RAY_BATCH]; /* in the tile: TILE_MAX a row */
    bool blocked[RAY_BATCH];
    uint16_t asked[RAY_BATCH]; /* by index in out->batch: of those above */
} own_batch;

/* Put ray k into the batch for volume v, if it still looks for something there. */
static void ask(own_batch *b, unsigned k, int v) {
    const ray_look *look = look_of(b->f);
    const leafcast_ray *own = &look->rays[b->pixel[k]];
    ray_batch *to = b->out->batch;
    trace_state *state = &to->states[to->count];
    const hit start = hit_before_all();
    if (b->blocked[k] || (!look->hits && look->occluded[b->pixel[k]]) ||
        !tracer_ray(&b->f->tracer[v], own->origin, own->direction, own->t0, own->t1,
                    &to->rays[to->count]))
        return;
    *state = trace_begin(&start);
    state->any = !look->hits;
    if (look->hits && look->hits[b->pixel[k]].t < INFINITY)
        state->best = hit_from(look->hits[b->pixel[k]].t);
    b->asked[to->count++] = (uint16_t)k;
}

static void take_answer(own_batch *b, unsigned i, int v) {
    const ray_look *look = look_of(b->f);
    const trace_state *state = &b->out->batch->states[i];
    const trace_result result = b->out->batch->results[i];
    const unsigned k = b->asked[i];
    const uint32_t pixel = b->pixel[k];
    b->blocked[k] = result == TRACE_BLOCKED;
    if (result != TRACE_HIT || hit_is_bound(&state->best))
        return;
    if (look->hits)
        look->hits[pixel] = hit_of(b->f, &look->rays[pixel], v, &state->best, &state->point);
    else
        look->occluded[pixel] = 1;
}

/* Those that are blocked begin anew, one by one. */
static void trace_batch(own_batch *b) {
    const ray_look *look = look_of(b->f);
    for (unsigned k = 0; k < b->count; k++) {
        b->blocked[k] = false;
        if (look->hits)
            look->hits[b->pixel[k]] = no_hit();
        else
            look->occluded[b->pixel[k]] = 0;
    }
    for (int v = 0; v < b->f->volumes; v++) {
        b->out->batch->count = 0;
        for (unsigned k = 0; k < b->count; k++)
            ask(b, k, v);
        if (b->out->batch->count > 0)
            ray_batch_next(&b->f->tracer[v], b->f->kernels, b->out->batch, b->out->batch_scratch,
                           b->counters);
        for (unsigned i = 0; i < b->out->batch->count; i++)
            take_answer(b, i, v);
    }
    for (unsigned k = 0; k < b->count; k++)
        b->out->open[b->in_tile[k] / TILE_MAX] |= (tile_row)b->blocked[k]
                                                  << b->in_tile[k] % TILE_MAX;
    b->count = 0;
}

static void trace_tile(const frame *f, uint32_t x0, uint32_t y0, const tile_row pixels[],
                       tile_outcome *out, ray_counters *counters) {
    own_batch b = {.f = f, .out = out, .counters = counters};
    memset(out->open, 0, sizeof out->open);
    memset(out->waits, 0, sizeof out->waits);
    out->absent_count = 0;
    for (uint32_t y = 0; y < f->tracer->kind->tile_side; y++) {
        for (tile_row left = pixels[y]; left; left &= left - 1) {
            const uint32_t x = (uint32_t)__builtin_ctz(left);
            const uint32_t pixel = (y0 + y) * f->width + x0 + x;
            if (pixel >= look_of(f)->count)
                continue;
            b.in_tile[b.count] = (uint16_t)(TILE_MAX * y + x);
            b.pixel[b.count++] = pixel;
            if (b.count == RAY_BATCH)
                trace_batch(&b);
        }
    }
    if (b.count > 0)
        trace_batch(&b);
}

static tile_fn own_tile(const frame *f) {
    for (int v = 0; v < f->volumes; v++)
        if (f->tracer[v].kind->batch && f->tracer[v].kind->batch(f->kernels))
            return trace_tile;
    return NULL;
}

const integrator ray_integrator = {.record_bytes = sizeof(own_ray),
                                   .begin = own_begin,
                                   .advance = own_advance,
                                   .bundle = own_bundle,
                                   .tile = own_tile};
