#include "render/view/view_pick.h"

#include "formats/base/cli_json.h"
#include "render/app/cell_text.h"
#include "render/app/view_camera.h"

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

static void describe_hit(json_t *out, const view_wish *wish, const leafcast_hit *h) {
    uint32_t field;
    json_object_set_new(out, "point", vector(h->point));
    json_object_set_new(out, "t", cli_json_real(h->t));
    if (!wish->view.is_surface) {
        const double isovalue = wish->view.surfaces[h->surface].isovalue;
        json_object_set_new(out, "value", cli_json_real(isovalue));
        json_object_set_new(out, "isovalue", cli_json_real(isovalue));
    }
    json_object_set_new(out, "gradient", vector(h->gradient));
    json_object_set_new(out, "normal", vector(h->normal));
    json_object_set_new(out, "error_bound", cli_json_real(h->error_bound));
    json_object_set_new(out, "surface", json_integer(h->surface));
    set_cell(out, wish->volume, h->level, h->cell);
    if (view_options_field(&wish->view, wish->volume, &field) == ST_OK)
        json_object_set_new(out, "field", json_integer(field));
}

/* Find the first hit in the scene without media: a probed ray meets surfaces only. */
static status first_hit(mem *m, view_wish *wish, const double at[2], leafcast_hit *hit,
                        int *count) {
    view_options *v = &wish->view;
    picture_scene parts;
    leafcast_scene scene;
    double suggested[LEAFCAST_SUGGESTIONS_MAX], origin[3], direction[3];
    const picture_volume volume = {wish->volume, v, NULL, 0};
    picture_scene_init(&parts, m);
    status st = picture_scene_choose(wish->volume, v, suggested, count);
    *count = 0;
    if (st == ST_OK)
        st = view_options_check(v);
    if (st == ST_OK)
        st = picture_scene_describe(&parts, &volume, 1, true, &scene);
    if (st == ST_OK && v->isos > 0) {
        const leafcast_camera camera = view_camera_of(v, wish->volume);
        scene.media_count = 0;
        leafcast_pixel_ray(&camera, at[0], at[1], origin, direction);
        st = (status)leafcast_probe_ray(wish->volume, &scene, origin, direction, hit, 1, count);
    }
    picture_scene_release(&parts);
    return st;
}

static status pick_pixel(mem *m, const view_wish *wish, const double at[2], json_t **answer) {
    leafcast_hit hit;
    int count = 0;
    view_wish *copy = mem_alloc(m, sizeof *copy);
    if (!copy)
        return ST_NOMEM;
    *copy = *wish;
    const status st = first_hit(m, copy, at, &hit, &count);
    if (st == ST_OK) {
        *answer = json_pack("{s:s,s:b}", "type", "picked", "hit", count > 0);
        if (count > 0)
            describe_hit(*answer, copy, &hit);
    }
    mem_free(m, copy);
    return st;
}

static status pick_point(const view_wish *wish, const double point[3], json_t **answer) {
    leafcast_sample sample;
    uint32_t field;
    status st = view_options_field(&wish->view, wish->volume, &field);
    if (st == ST_OK)
        st = (status)leafcast_select_between(wish->volume, field, wish->view.step,
                                             wish->view.time.between);
    if (st == ST_OK)
        st = (status)leafcast_probe_point(wish->volume, point, &sample);
    if (st != ST_OK)
        return st;
    *answer = json_pack("{s:s,s:b}", "type", "picked", "hit", (int)sample.inside);
    json_object_set_new(*answer, "point", vector(point));
    if (!sample.inside)
        return ST_OK;
    json_object_set_new(*answer, "value", cli_json_real(sample.value));
    json_object_set_new(*answer, "gradient", vector(sample.gradient));
    set_cell(*answer, wish->volume, 0, sample.cell);
    json_object_set_new(*answer, "field", json_integer(field));
    return ST_OK;
}

status view_pick(mem *m, const view_wish *wish, const view_place *place, json_t **answer) {
    return place->in_world ? pick_point(wish, place->point, answer)
                           : pick_pixel(m, wish, place->pixel, answer);
}
