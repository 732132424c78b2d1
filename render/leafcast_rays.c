#include "render/leafcast.h"

#include <math.h>

#include "render/arguments.h"
#include "render/kind.h"
#include "render/leafcast_turn.h"
#include "render/ray_integrator.h"

enum { RAYS_MAX = INT32_MAX / 2 };

static status check_rays(const leafcast_ray *rays, size_t count) {
    if (count > RAYS_MAX)
        return status_describe(ST_USAGE, "%zu rays: at most %d at a time", count, RAYS_MAX);
    for (size_t i = 0; i < count; i++) {
        const leafcast_ray *r = &rays[i];
        double length = 0.0, distance = 0.0;
        for (int a = 0; a < 3; a++) {
            length += fabs(r->direction[a]);
            distance += fabs(r->origin[a]);
        }
        if (!(length > 0.0 && length < INFINITY && distance < INFINITY))
            return status_describe(ST_USAGE,
                                   "ray %zu needs a finite origin and a finite direction that is "
                                   "not 0,0,0",
                                   i);
        if (!(r->t0 > -INFINITY && r->t0 <= r->t1))
            return status_describe(ST_USAGE, "ray %zu: no t from %g to %g", i, r->t0, r->t1);
    }
    return ST_OK;
}

static status trace_rays(turn *t, ray_look *look) {
    frame *f = &t->f;
    ray_counters counters = {0};
    /* A narrow picture: neighbours in the caller's order are in one tile, and go on together. */
    const size_t row = f->tracer->kind->tile_side < 16 ? f->tracer->kind->tile_side : 16;
    f->integrator = &ray_integrator;
    f->look = look;
    f->stride = f->width = (uint32_t)(look->count < row ? look->count : row);
    f->height = (uint32_t)((look->count + row - 1) / row);
    look->first_id = t->first_id;
    status st = turn_prepare(t);
    if (st == ST_OK)
        st = frame_render(f, &counters);
    return turn_check(t, true, st);
}

static leafcast_status trace(leafcast *v, const leafcast_scene *scene, ray_look *look) {
    mem outside;
    status st = arguments_check_scene(scene);
    if (st == ST_OK)
        st = check_rays(look->rays, look->count);
    if (st != ST_OK || look->count == 0)
        return public_status(st);
    mem_init(&outside, 0);
    turn *t = mem_zalloc(&outside, sizeof *t);
    if (!t)
        return LEAFCAST_NOMEM;
    leafcast_scene waits = *scene;
    waits.preview = false;
    device_lock(v->device);
    st = turn_describe(t, v, &waits);
    if (st == ST_OK)
        st = trace_rays(t, look);
    turn_end(t);
    device_unlock(v->device);
    mem_free(&outside, t);
    return public_status(st);
}

leafcast_status leafcast_trace_rays(leafcast *v, const leafcast_scene *scene,
                                    const leafcast_ray *rays, size_t count,
                                    leafcast_ray_hit *hits) {
    ray_look look = {.rays = rays, .count = count, .hits = hits};
    return trace(v, scene, &look);
}

leafcast_status leafcast_occluded_rays(leafcast *v, const leafcast_scene *scene,
                                       const leafcast_ray *rays, size_t count, uint8_t *occluded) {
    ray_look look = {.rays = rays, .count = count, .occluded = occluded};
    return trace(v, scene, &look);
}
