#include "render/view/view_pick.h"

#include <math.h>

#include "formats/base/cli_json.h"
#include "render/app/cell_text.h"
#include "render/app/view_camera.h"
#include "render/view/view_cast.h"
#include "render/view/view_through.h"

static json_t *vector(const double x[3]) {
    json_t *list = json_array();
    for (int i = 0; i < 3; i++)
        json_array_append_new(list, cli_json_real(x[i]));
    return list;
}

/* Set the cell of a hit or point, under what cells are called. */
static void set_cell(json_t *out, const leafcast *volume, uint32_t level, uint64_t cell) {
    const cell_text c = cell_text_of(volume, level, cell);
    json_object_set_new(out, leafcast_describe(volume).cell, cell_text_json(&c));
}

/* v: the flags of the volume that was hit. */
static void describe_hit(json_t *out, const view_options *v, const leafcast *volume,
                         const leafcast_hit *h) {
    uint32_t field;
    json_object_set_new(out, "point", vector(h->point));
    json_object_set_new(out, "t", cli_json_real(h->t));
    if (!v->is_surface) {
        const double isovalue = v->surfaces[h->surface].isovalue;
        json_object_set_new(out, "value", cli_json_real(isovalue));
        json_object_set_new(out, "isovalue", cli_json_real(isovalue));
    }
    json_object_set_new(out, "gradient", vector(h->gradient));
    json_object_set_new(out, "normal", vector(h->normal));
    json_object_set_new(out, "error_bound", cli_json_real(h->error_bound));
    json_object_set_new(out, "surface", json_integer(h->surface));
    set_cell(out, volume, h->level, h->cell);
    if (view_options_field(v, volume, &field) == ST_OK)
        json_object_set_new(out, "field", json_integer(field));
}

/* What a ray through a pixel shows. */
typedef struct pixel_ray {
    double origin[3], direction[3];
    leafcast_hit hit; /* the first one with a surface, if count is not 0 */
    int count;
    view_through through; /* else what it shows of a projection or medium */
} pixel_ray;

static status see_through(mem *m, const view_wish *wish, const leafcast_scene *scene,
                          const transfer_list *medium, pixel_ray *r) {
    uint32_t field;
    status st = view_options_field(&wish->view, wish->volume, &field);
    if (st == ST_OK)
        st = (status)leafcast_select_between(wish->volume, field, wish->view.step,
                                             wish->view.time.between);
    return st == ST_OK ? view_through_find(m, wish->volume, scene, medium, r->origin, r->direction,
                                           &r->through)
                       : st;
}

/* Find the first hit in the scene without media: a probed ray meets surfaces only. Where there is
 * none, find what is seen without one. A projection shows no surfaces. */
static status look_along(mem *m, view_wish *wish, const double at[2], pixel_ray *r) {
    view_options *v = &wish->view;
    picture_scene parts;
    leafcast_scene scene = {.project = LEAFCAST_PROJECT_NONE};
    double suggested[LEAFCAST_SUGGESTIONS_MAX];
    const picture_volume volume = {wish->volume, v, NULL, 0};
    picture_scene_init(&parts, m);
    status st = picture_scene_choose(wish->volume, v, suggested, &r->count);
    r->count = 0;
    if (st == ST_OK)
        st = view_options_check(v);
    if (st == ST_OK)
        st = picture_scene_describe(&parts, &volume, 1, true, &scene);
    if (st == ST_OK) {
        const leafcast_camera camera = view_camera_of(v, wish->volume);
        leafcast_pixel_ray(&camera, at[0], at[1], r->origin, r->direction);
        scene.media_count = 0;
    }
    const bool projected = scene.project != LEAFCAST_PROJECT_NONE;
    if (st == ST_OK && v->isos > 0 && !projected)
        st = (status)leafcast_probe_ray(wish->volume, &scene, r->origin, r->direction, &r->hit, 1,
                                        &r->count);
    if (st == ST_OK && r->count == 0 && (projected || parts.transfer[0].count > 0) &&
        !v->is_surface)
        st = see_through(m, wish, &scene, &parts.transfer[0], r);
    picture_scene_release(&parts);
    return st;
}

/* ---- Of a scene ---- */

/* Find the first hit of one object, if it is nearer than *hit. */
static status nearer_hit(const picture_volume *object, const view_options *first,
                         const double origin[3], const double direction[3], leafcast_hit *hit,
                         bool *found) {
    const view_options *v = object->view;
    leafcast_scene_experiments experiments;
    leafcast_scene scene = view_options_scene(first, &experiments);
    leafcast_hit own;
    int count = 0;
    uint32_t field;
    *found = false;
    status st = view_options_field(v, object->volume, &field);
    if (st != ST_OK || v->isos == 0)
        return st;
    const leafcast_shown shown = {.volume = object->volume,
                                  .field = field,
                                  .step = v->step,
                                  .surfaces = v->surfaces,
                                  .count = v->isos,
                                  .between = v->time.between,
                                  .place = object->place};
    scene.volumes = &shown;
    scene.volume_count = 1;
    st = (status)leafcast_probe_ray(object->volume, &scene, origin, direction, &own, 1, &count);
    *found = st == ST_OK && count > 0 && own.t < hit->t;
    if (*found)
        *hit = own;
    return st;
}

static status pick_in_cast(view_cast *cast, const double at[2], json_t **answer) {
    const view_options *first = &cast->frame.view;
    const picture_volume *objects = render_job_objects(&cast->job, first);
    const leafcast_camera camera = render_job_camera(&cast->job, first);
    leafcast_hit hit = {.t = INFINITY};
    double origin[3], direction[3];
    int nearest = -1;
    status st = ST_OK;
    leafcast_pixel_ray(&camera, at[0], at[1], origin, direction);
    for (int i = 0; i < cast->job.object_count && st == ST_OK; i++) {
        bool found;
        st = nearer_hit(&objects[i], first, origin, direction, &hit, &found);
        nearest = found ? i : nearest;
    }
    if (st != ST_OK)
        return st;
    *answer = json_pack("{s:s,s:b}", "type", "picked", "hit", (int)(nearest >= 0));
    if (nearest < 0)
        return ST_OK;
    json_object_set_new(*answer, "object", json_integer(cast->owner[nearest]));
    describe_hit(*answer, objects[nearest].view, objects[nearest].volume, &hit);
    return ST_OK;
}

static status pick_in_scene(mem *m, const view_wish *wish, const double at[2], json_t **answer) {
    view_cast *cast = NULL;
    status st = view_cast_make(m, wish->scene, &wish->view, wish->changes, &cast);
    if (st == ST_OK)
        st = pick_in_cast(cast, at, answer);
    view_cast_free(m, cast);
    return st;
}

/* ---- Of one volume ---- */

/* What is told of a point of the volume that is selected. */
static void describe_sample(json_t *out, const leafcast *volume, const leafcast_sample *s,
                            uint32_t field) {
    json_object_set_new(out, "gradient", vector(s->gradient));
    set_cell(out, volume, 0, s->cell);
    json_object_set_new(out, "field", json_integer(field));
}

/* Describe the value that is seen without a surface, and where: of a mean, nowhere. */
static status describe_through(json_t *out, const view_wish *wish, const pixel_ray *r,
                               bool somewhere) {
    leafcast_sample sample;
    double point[3];
    uint32_t field;
    for (int a = 0; a < 3; a++)
        point[a] = r->origin[a] + r->through.t * r->direction[a];
    status st = view_options_field(&wish->view, wish->volume, &field);
    if (st == ST_OK && somewhere)
        st = (status)leafcast_probe_point(wish->volume, point, &sample);
    if (st != ST_OK)
        return st;
    json_object_set_new(out, "point", vector(point));
    json_object_set_new(out, "t", cli_json_real(r->through.t));
    json_object_set_new(out, "value", cli_json_real(r->through.value));
    json_object_set_new(out, "through", json_string(somewhere ? "point" : "ray"));
    if (somewhere && sample.inside)
        describe_sample(out, wish->volume, &sample, field);
    return ST_OK;
}

static status pick_pixel(mem *m, const view_wish *wish, const double at[2], json_t **answer) {
    pixel_ray r = {.count = 0};
    view_wish *copy = mem_zalloc(m, sizeof *copy);
    if (!copy)
        return ST_NOMEM;
    view_wish_copy(copy, wish);
    status st = look_along(m, copy, at, &r);
    if (st == ST_OK) {
        *answer = json_pack("{s:s,s:b}", "type", "picked", "hit", r.count > 0 || r.through.any);
        if (r.count > 0)
            describe_hit(*answer, &copy->view, copy->volume, &r.hit);
        else if (r.through.any)
            st = describe_through(*answer, copy, &r,
                                  copy->view.scene.project != LEAFCAST_PROJECT_MEAN);
        if (st != ST_OK) {
            json_decref(*answer);
            *answer = NULL;
        }
    }
    view_wish_release(copy);
    mem_free(m, copy);
    return st;
}

/* A point in the world of the wish's volume, wherever that is in a scene. */
static status pick_point(const view_wish *wish, const double point[3], json_t **answer) {
    const view_options *v = view_wish_of_one(wish);
    double between = v->time.between;
    uint32_t field, step = v->step;
    time_options when = v->time;
    leafcast_sample sample;
    status st = view_options_field(v, wish->volume, &field);
    if (st == ST_OK && wish->scene) {
        st = time_options_find(&when, wish->volume, &step);
        between = when.between;
    }
    if (st == ST_OK)
        st = (status)leafcast_select_between(wish->volume, field, step, between);
    if (st == ST_OK)
        st = (status)leafcast_probe_point(wish->volume, point, &sample);
    if (st != ST_OK)
        return st;
    *answer = json_pack("{s:s,s:b}", "type", "picked", "hit", (int)sample.inside);
    json_object_set_new(*answer, "point", vector(point));
    if (wish->scene)
        json_object_set_new(*answer, "object", json_integer(wish->chosen));
    if (!sample.inside)
        return ST_OK;
    json_object_set_new(*answer, "value", cli_json_real(sample.value));
    describe_sample(*answer, wish->volume, &sample, field);
    return ST_OK;
}

status view_pick(mem *m, const view_wish *wish, const view_place *place, json_t **answer) {
    if (place->in_world)
        return pick_point(wish, place->point, answer);
    return wish->scene ? pick_in_scene(m, wish, place->pixel, answer)
                       : pick_pixel(m, wish, place->pixel, answer);
}
