/* leafcast_moving.c - surfaces of triangles whose vertices a running program moves. */
#include <string.h>

#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/door/moving_arguments.h"
#include "stream/moving_surface.h"

/* ---- Opening ---- */

static status open_triangles(leafcast *v, const void *from) {
    const leafcast_triangles *of = from;
    const moving_source given = {.vertices = of->vertex_count,
                                 .triangles = of->triangle_count,
                                 .positions = of->vertices,
                                 .rows = of->triangles,
                                 .values = of->values,
                                 .colours = of->colours,
                                 .name = of->field,
                                 .smooth = of->smooth};
    moving_surface *s;
    status st = moving_surface_create(v->m, &given, v->threads, &s);
    if (st != ST_OK)
        return st;
    v->file = s->file;
    return live_steps_create(v->m, v->file, &v->live);
}

leafcast_status leafcast_open_triangles(const leafcast_triangles *triangles,
                                        const leafcast_options *options, leafcast **volume) {
    status st = public_needs(__func__, "triangles volume", (const void *[]){triangles, volume});
    if (st == ST_OK)
        st = moving_arguments_check(triangles);
    return st == ST_OK ? volume_open_by(open_triangles, triangles, options, volume)
                       : public_status(st);
}

/* ---- Moving ---- */

static status check_moving(const char *call, const leafcast *v, const void *positions,
                           size_t count) {
    status st = arguments_check_volume(call, v);
    if (st == ST_OK)
        st = public_needs(call, "positions", (const void *[]){positions});
    if (st == ST_OK && !v->file->moving)
        return status_describe(ST_USAGE, "%s(): the volume is not of leafcast_open_triangles()",
                               call);
    if (st == ST_OK && count != v->file->moving->vertices)
        return status_describe(ST_USAGE, "%s(): %zu positions: the surface has %u vertices", call,
                               count, v->file->moving->vertices);
    return st;
}

leafcast_status leafcast_update_vertices(leafcast *v, const float (*positions)[3], size_t count) {
    uint32_t step;
    status st = check_moving(__func__, v, positions, count);
    if (st == ST_OK)
        st = live_steps_begin(v->live, &step);
    if (st != ST_OK)
        return public_status(st);
    st = moving_surface_put(v->file->moving, step, positions);
    live_steps_end(v->live, step, st == ST_OK);
    return public_status(st);
}
