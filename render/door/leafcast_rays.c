#include "render/leafcast.h"

#include "render/door/arguments.h"
#include "render/door/leafcast_turn.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"
#include "render/surface/ray_integrator.h"

enum { RAYS_MAX = INT32_MAX / 2 };

/* Check the arguments of a call. told: the caller's array for the answers. */
static status check_call(const char *call, const leafcast *v, const leafcast_scene *scene,
                         const leafcast_ray *rays, size_t count, const void *told) {
    status st = arguments_check_volume(call, v);
    if (st == ST_OK)
        st = public_needs(call, "scene", (const void *[]){scene});
    if (st == ST_OK && count > 0)
        st = public_needs(call, "rays answers", (const void *[]){rays, told});
    if (st == ST_OK)
        st = public_in_range(call, "count", (double)count, 0, RAYS_MAX);
    if (st == ST_OK)
        st = arguments_check_scene(scene);
    return st == ST_OK ? arguments_check_rays(rays, count) : st;
}

static status trace_rays(turn *t, ray_look *look) {
    frame *f = &t->f;
    ray_counters counters = {0};
    /* Make a picture one tile wide: neighbours in the caller's order share a tile, and walk
     * together. */
    const size_t row = kind_tile_side(f->tracer->kind) < 16 ? kind_tile_side(f->tracer->kind) : 16;
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
    status st = ST_OK;
    if (look->count == 0)
        return LEAFCAST_OK;
    mem_init(&outside, 0);
    turn *t = mem_zalloc(&outside, sizeof *t);
    if (!t)
        return LEAFCAST_NOMEM;
    leafcast_scene waits = *scene;
    waits.preview = waits.allow_missing = false;
    device_lock(v->device);
    st = turn_describe(t, v, &waits, false);
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
    const status st = check_call(__func__, v, scene, rays, count, hits);
    return st == ST_OK ? trace(v, scene, &look) : public_status(st);
}

leafcast_status leafcast_occluded_rays(leafcast *v, const leafcast_scene *scene,
                                       const leafcast_ray *rays, size_t count, uint8_t *occluded) {
    ray_look look = {.rays = rays, .count = count, .occluded = occluded};
    const status st = check_call(__func__, v, scene, rays, count, occluded);
    return st == ST_OK ? trace(v, scene, &look) : public_status(st);
}
