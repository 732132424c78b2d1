#include "render/app/picture_scene.h"

#include <stdio.h>
#include <string.h>

#include "render/app/legend.h"
#include "render/ray/placement.h"

void picture_scene_init(picture_scene *p, mem *m) {
    *p = (picture_scene){.m = m};
    p->caps.m = m;
}

void picture_scene_release(picture_scene *p) {
    for (int i = 0; i < p->room; i++) {
        transfer_list_release(&p->transfer[i]);
        colour_by_close(&p->by[i]);
    }
    transfer_list_release(&p->caps);
    mem_free(p->m, p->shown);
    mem_free(p->m, p->transfer);
    mem_free(p->m, p->media);
    mem_free(p->m, p->colours);
    mem_free(p->m, p->measured);
    mem_free(p->m, p->by);
    mem_free(p->m, p->colourings);
    mem_free(p->m, p->grouped);
    p->grouped = NULL;
    p->shown = NULL;
    p->transfer = NULL;
    p->media = NULL;
    p->colours = NULL;
    p->measured = NULL;
    p->by = NULL;
    p->colourings = NULL;
    p->room = 0;
}

void picture_scene_renew(picture_scene *p) {
    for (int i = 0; i < p->room; i++)
        p->measured[i].known = false;
}

/* Make room for so many objects: the first picture of a run says how many all have. */
static status make_room(picture_scene *p, int count) {
    if (count <= p->room)
        return ST_OK;
    const transfer_list caps = p->caps;
    p->caps = (transfer_list){.m = p->m};
    picture_scene_release(p);
    p->caps = caps;
    p->shown = mem_array(p->m, (size_t)count, sizeof *p->shown);
    p->transfer = mem_array(p->m, (size_t)count, sizeof *p->transfer);
    p->media = mem_array(p->m, (size_t)count, sizeof *p->media);
    p->colours = mem_array(p->m, (size_t)count, sizeof *p->colours);
    p->measured = mem_array(p->m, (size_t)count, sizeof *p->measured);
    p->by = mem_array(p->m, (size_t)count, sizeof *p->by);
    p->colourings = mem_array(p->m, (size_t)count, sizeof *p->colourings);
    p->grouped =
        p->group_count ? mem_array(p->m, (size_t)p->group_count, sizeof *p->grouped) : NULL;
    if (p->group_count > 0 && !p->grouped)
        return ST_NOMEM;
    if (!p->shown || !p->transfer || !p->media || !p->colours || !p->measured || !p->by ||
        !p->colourings)
        return ST_NOMEM;
    p->room = count;
    for (int i = 0; i < count; i++)
        p->transfer[i].m = p->m;
    return ST_OK;
}

status picture_scene_choose(const leafcast *volume, view_options *v, double *suggested,
                            int *count) {
    uint32_t field;
    *count = 0;
    status st = volume ? time_options_find(&v->time, volume, &v->step) : ST_OK;
    if (st != ST_OK)
        return st;
    const bool is_surface = volume && leafcast_describe(volume).abilities & LEAFCAST_ABILITY_GIVEN;
    if (is_surface && !v->is_surface && v->isos > 0) {
        v->iso_unused = true;
        v->isos = 1;
    }
    v->is_surface = is_surface;
    v->unopened = !volume;
    if (v->isos > 0 || view_options_filled(v))
        return ST_OK;
    v->isos = 1;
    v->surfaces[0].isovalue = 0.0;
    if (!volume || is_surface)
        return ST_OK;
    st = view_options_field(v, volume, &field);
    if (st == ST_OK)
        st = (status)leafcast_suggested_isovalues(volume, field, v->step, suggested,
                                                  LEAFCAST_SUGGESTIONS_MAX, count);
    if (st == ST_OK && *count == 0)
        st = status_describe(ST_USAGE, "which isosurface? None can be suggested, as no two values "
                                       "differ: --iso V");
    if (st == ST_OK)
        v->surfaces[0].isovalue = suggested[0];
    return st;
}

status picture_scene_check_used(const leafcast *volume, const view_options *v) {
    if (!v->iso_unused)
        return ST_OK;
    return status_describe(ST_USAGE, "--iso: \"%s\" is a surface itself: it has no isosurfaces",
                           leafcast_describe(volume).name);
}

/* The axes of the world that the picture lies in. */
static leafcast_axes world_of(const picture_volume *volumes, int count) {
    leafcast_axes axes = LEAFCAST_AXES_FILE;
    for (int i = 0; i < count && axes == LEAFCAST_AXES_FILE; i++)
        axes = colour_by_world(volumes[i].volume);
    return axes;
}

/* The first object of the same volume that is coloured by the same: it keeps what is open. */
static int keeper_of(const picture_volume *volumes, int i) {
    int k = 0;
    while (k < i && (volumes[k].volume != volumes[i].volume ||
                     strcmp(volumes[k].view->colour_by, volumes[i].view->colour_by) != 0))
        k++;
    return k;
}

/* Find what colours surfaces of object i by another volume's values. */
static status find_colouring(picture_scene *p, const picture_volume *volumes, int count, int i,
                             int keeper) {
    leafcast_shown *s = &p->shown[i];
    if (!volumes[i].view->colour_by[0])
        return ST_OK;
    if (!p->opens)
        return status_describe(ST_USAGE, "--colour-by is of leafcast render and probe");
    const status st = colour_by_find(&p->by[keeper], volumes[i].view, world_of(volumes, count), s,
                                     &p->colourings[i]);
    if (st == ST_OK && p->colourings[i].volume)
        s->colour_by = &p->colourings[i];
    return st;
}

/* Whose values colour an object's surfaces. */
static leafcast_colouring colouring_of(const leafcast_shown *s) {
    return s->colour_by
               ? *s->colour_by
               : (leafcast_colouring){.volume = s->volume, .field = s->field, .step = s->step};
}

/* The flags of an object's colours: by --colour-by, these have a default. */
static medium_options colours_of(const view_options *v) {
    medium_options o = v->medium;
    if (v->colour_by[0] && !o.tf[0] && !o.colour_map[0])
        snprintf(o.colour_map, sizeof o.colour_map, "viridis");
    return o;
}

/* Make the transfer function of one volume of the picture. */
static status fill_volume(picture_scene *p, const picture_volume *volumes, int volume, int keeper) {
    const leafcast_shown *shown = &p->shown[volume];
    const leafcast_colouring of = colouring_of(shown);
    const medium_options medium = colours_of(volumes[volume].view);
    const bool projected = volumes[0].view->scene.project != LEAFCAST_PROJECT_NONE;
    transfer_list *t = &p->transfer[volume];
    status st = ST_OK;
    const uint32_t opened = shown->colour_by ? p->by[keeper].opened : 0;
    if (!p->measured[volume].known || p->measured[volume].field != of.field ||
        p->measured[volume].opened != opened) {
        p->measured[volume].known = true;
        p->measured[volume].opened = opened;
        p->measured[volume].field = of.field;
        p->measured[volume].step = of.step;
    }
    transfer_list_release(t);
    const bool by_value = view_options_coloured(volumes[volume].view);
    if (projected ? volume == 0 : medium_options_given(&medium))
        st = medium_options_make(&medium, of.volume, of.field, p->measured[volume].step,
                                 projected || by_value, t);
    p->media[volume] = (leafcast_medium){t->points, by_value ? 0 : (int)t->count};
    p->colours[volume] = (leafcast_medium){t->points, (int)t->count};
    if (by_value)
        p->shown[volume].colours = &p->colours[volume];
    return st;
}

/* An image colours an object: by itself. */
static status drape_image(picture_scene *p, const view_options *v, int volume) {
    p->media[volume] = (leafcast_medium){.count = 0};
    if (!medium_options_given(&v->medium))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "--colour-by %s: that is an image, which has its own colours: without "
                           "--colour-map, --tf and --window",
                           v->colour_by);
}

/* Colour the caps by the values of the first volume. */
static status colour_caps(picture_scene *p, const picture_volume *first, leafcast_scene *scene) {
    const view_options *v = first->view;
    uint32_t field;
    transfer_list_release(&p->caps);
    if (!v->scene.caps || !v->caps.colour_map[0])
        return ST_OK;
    status st = view_options_field(v, first->volume, &field);
    if (st == ST_OK)
        st = medium_options_make(&v->caps, first->volume, field, v->step, true, &p->caps);
    p->cap_colours = (leafcast_medium){p->caps.points, (int)p->caps.count};
    scene->cap_colours = &p->cap_colours;
    return st;
}

/* ---- Groups ---- */

/* Whether a group is somewhere. */
static bool is_somewhere(const picture_scene *p, int group) {
    while (group > 0 && (p->groups[group - 1].places || p->groups[group - 1].chosen))
        group = p->groups[group - 1].parent;
    return group == 0;
}

/* List the groups that lie in one, side by side, from *at on; they get their own later. */
static void list_inside(picture_scene *p, int parent, leafcast_group *at[], int *count) {
    for (int g = 1; g <= p->group_count; g++)
        if (p->groups[g - 1].parent == parent && is_somewhere(p, g)) {
            at[g] = &p->grouped[(*count)++];
            *at[g] = (leafcast_group){.places = p->groups[g - 1].places};
        }
}

static leafcast_group *list_level(picture_scene *p, int parent, leafcast_group *at[], int *listed,
                                  int *count) {
    leafcast_group *first = &p->grouped[*listed];
    const int before = *listed;
    list_inside(p, parent, at, listed);
    *count = *listed - before;
    return *count > 0 ? first : NULL;
}

/* Give the scene its groups. Objects of groups that are nowhere are left out. */
static status describe_groups(picture_scene *p, const picture_volume *volumes, int count,
                              leafcast_scene *scene) {
    int listed = 0, own = 0;
    leafcast_group **at = mem_array(p->m, (size_t)p->group_count + 1, sizeof *at);
    if (!at)
        return ST_NOMEM;
    scene->groups = list_level(p, 0, at, &listed, &scene->group_count);
    for (int g = 1; g <= p->group_count; g++)
        if (at[g])
            at[g]->groups = list_level(p, g, at, &listed, &at[g]->group_count);
    for (int i = 0; i < count; i++) {
        leafcast_group *in_it = at[volumes[i].group];
        own += volumes[i].group == 0;
        if (in_it && in_it->volume_count++ == 0)
            in_it->volumes = &p->shown[i];
    }
    mem_free(p->m, at);
    scene->volume_count = own;
    if (own == 0 && scene->group_count == 0)
        return status_describe(ST_USAGE, "the scene is empty: no tile lies anywhere");
    return ST_OK;
}

/* Refuse what objects of groups cannot have. */
static status check_grouped(const picture_volume *volume) {
    if (volume->group == 0 || !view_options_medium(volume->view))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "a medium fills \"%s\", which lies in a scene that is placed many "
                           "times: media are of objects of the scene itself, each at its place",
                           leafcast_describe(volume->volume).name);
}

status picture_scene_describe(picture_scene *p, const picture_volume *volumes, int count,
                              bool always, leafcast_scene *scene) {
    const view_options *first = volumes[0].view;
    const bool filled = view_options_any_filled(first);
    *scene = view_options_scene(first, &p->experiments);
    status st = colour_caps(p, volumes, scene);
    const bool by_value = count == 1 && view_options_coloured(first);
    always = always || volumes[0].place || p->group_count > 0;
    if (st != ST_OK || (count == 1 && !filled && !by_value && !always))
        return st;
    st = make_room(p, count);
    for (int i = 0; i < count && st == ST_OK; i++) {
        const view_options *v = volumes[i].view;
        const int keeper = v->colour_by[0] ? keeper_of(volumes, i) : i;
        uint32_t field;
        st = view_options_field(v, volumes[i].volume, &field);
        p->shown[i] = (leafcast_shown){.volume = volumes[i].volume,
                                       .field = field,
                                       .step = v->step,
                                       .surfaces = v->surfaces,
                                       .count = v->isos,
                                       .between = v->time.between,
                                       .place = volumes[i].place};
        if (st == ST_OK)
            st = check_grouped(&volumes[i]);
        if (st == ST_OK)
            st = find_colouring(p, volumes, count, i, keeper);
        if (st == ST_OK && p->shown[i].colour_by && colour_by_image(p->shown[i].colour_by))
            st = drape_image(p, v, i);
        else if (st == ST_OK && (filled || view_options_coloured(v)))
            st = fill_volume(p, volumes, i, keeper);
    }
    scene->volumes = p->shown;
    scene->volume_count = count;
    if (st == ST_OK && p->group_count > 0)
        st = describe_groups(p, volumes, count, scene);
    scene->media = p->media;
    scene->media_count = filled ? scene->volume_count : 0;
    return st;
}

int picture_scene_filled(const picture_scene *p, const leafcast_scene *scene) {
    for (int i = 0; i < scene->media_count; i++)
        if (p->transfer[i].count > 0)
            return i;
    return -1;
}

/* Returns the first object whose surfaces are coloured by value; -1: none is. */
static int coloured(const leafcast_scene *scene) {
    for (int i = 0; i < scene->volume_count; i++)
        if (scene->volumes[i].colours)
            return i;
    return -1;
}

static void annotate(const picture_volume *first, const leafcast_camera *camera,
                     const leafcast_image *image, text_face *face) {
    const view_options *view = first->view;
    const float *rgba = view->scene.background;
    const bool light = rgba[3] * (0.3f * rgba[0] + 0.6f * rgba[1] + 0.1f * rgba[2]) > 0.2f;
    const leafcast_info info = leafcast_describe(first->volume);
    const placement place = placement_of(first->place);
    leafcast_image planes = *image;
    double box[2][3];
    annotation a = view->annotation;
    a.axes = info.axes;
    if (!a.unit[0] && strcmp(info.units[0], info.units[1]) == 0 &&
        strcmp(info.units[0], info.units[2]) == 0)
        snprintf(a.unit, sizeof a.unit, "%s", info.units[0]);
    if (view->scene.project != LEAFCAST_PROJECT_NONE || view->isos == 0)
        planes.z = NULL; /* nothing hides the box */
    placement_box(&place, info.bounds, box);
    annotate_draw(&planes, camera, box, &a, light, face);
}

void picture_scene_mark(const picture_scene *p, const picture_volume *volumes,
                        const leafcast_scene *scene, const leafcast_camera *camera,
                        const leafcast_image *image, text_face *face) {
    const int filled = picture_scene_filled(p, scene), i = filled >= 0 ? filled : coloured(scene);
    double window[2];
    if (volumes[0].view->legend && i >= 0) {
        const leafcast_colouring of = colouring_of(&scene->volumes[i]);
        const char *title =
            volumes[i].view->colour_by[0] ? leafcast_field_name(of.volume, of.field) : "";
        medium_options_window(&volumes[i].view->medium, &p->transfer[i], window);
        legend_draw(image, camera->width, camera->height, &p->transfer[i], window, title, face);
    }
    if (annotate_wanted(&volumes[0].view->annotation))
        annotate(volumes, camera, image, face);
}
