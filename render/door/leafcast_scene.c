#include "render/door/leafcast_scene.h"

#include <string.h>

#include "formats/base/colour_field.h"
#include "render/door/arguments.h"
#include "render/door/between_steps.h"
#include "render/door/leafcast_volume.h"
#include "render/frame/laboratory.h"
#include "render/look/scene_facts.h"
#include "render/ray/kind.h"

/* ---- Which volumes ---- */

leafcast_shown scene_object(const leafcast *v, const leafcast_scene *scene, int i) {
    if (scene->volume_count > 0)
        return scene->volumes[i];
    return (leafcast_shown){(leafcast *)(uintptr_t)v,
                            v->field,
                            v->step,
                            v->surfaces,
                            v->surface_count,
                            v->share,
                            NULL,
                            NULL,
                            NULL};
}

int scene_lookups(const leafcast_scene *scene) {
    int count = 0;
    for (int i = 0; i < scene->volume_count && scene->project == LEAFCAST_PROJECT_NONE; i++)
        count += scene_is_coloured(&scene->volumes[i]);
    return count;
}

leafcast_shown scene_lookup(const leafcast_shown *s) {
    const leafcast_colouring *by = s->colour_by;
    return (leafcast_shown){.volume = by->volume,
                            .field = by->field,
                            .step = by->step,
                            .between = by->between,
                            .place = by->place};
}

/* Check that volume i's world axes agree with those of *known, the first volume that tells of its
 * own; -1: none has. */
static status check_world(const leafcast_scene *scene, int i, int *known) {
    const world_axes axes = scene->volumes[i].volume->axes;
    if (axes && *known < 0)
        *known = i;
    const world_axes other = *known < 0 ? axes : scene->volumes[*known].volume->axes;
    if (!axes || axes == other)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "volume %d of the scene lies in a world of %s axes, volume %d in one of "
                           "%s: open both with the same leafcast_options.axes",
                           *known + 1, world_axes_name(other), i + 1, world_axes_name(axes));
}

/* Whether two objects show a volume's same field at the same time. */
static bool same_set(const leafcast_shown *a, const leafcast_shown *b) {
    return a->field == b->field &&
           (a->volume->live || (a->step == b->step && a->between == b->between));
}

/* Check that object i shows its volume as the first object of that volume does. */
static status check_set(const leafcast_scene *scene, int i) {
    const leafcast_shown *s = &scene->volumes[i];
    const int first = s->volume->listed;
    const leafcast_shown *other = &scene->volumes[first];
    if (same_set(s, other))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "volumes %d and %d of the scene are the same, and show field %u at step "
                           "%u, and field %u at step %u, or different times: at a time, a volume "
                           "has one field and step; open it once more for another",
                           first + 1, i + 1, other->field, other->step, s->field, s->step);
}

/* Check the i-th object of a scene's list. Its fields have been checked, so that nothing else can
 * be wrong with its surfaces than that there are none. */
static status check_shown(const leafcast *v, const leafcast_scene *scene, int i, int *known) {
    const leafcast_shown *s = &scene->volumes[i];
    if (s->volume->device != v->device)
        return status_describe(ST_USAGE, "volume %d of the scene is on another device", i + 1);
    if (s->volume->listed < 0)
        s->volume->listed = i;
    status st = check_world(scene, i, known);
    if (st == ST_OK)
        st = between_steps_check(s->volume, s->field, s->step, s->between);
    if (st == ST_OK)
        st = check_set(scene, i);
    if (st == ST_OK && s->place && scene->lod == LEAFCAST_LOD_PIXEL)
        st = status_describe(ST_USAGE,
                             "volume %d of the scene has a place: levels by pixels are for volumes "
                             "without one",
                             i + 1);
    const bool empty = s->count == 0 && !scene_is_filled(scene);
    return st == ST_OK && empty ? arguments_check_surfaces(s->surfaces, s->count) : st;
}

/* Whether what colours an object is an image, whose values are colours. */
static bool has_colours(const leafcast_colouring *by) {
    const leaf_file *f = by->volume->file;
    return by->volume->kind->draped && by->between == 0.0 && by->field < f->header.fields &&
           strcmp(leaf_file_field_name(f, by->field), COLOUR_FIELD) == 0;
}

/* Check what colours object i. `listed` of a volume that only colours is volume_count + the first
 * object that it colours. */
static status check_colouring(const leafcast *v, const leafcast_scene *scene, int i, int known) {
    const leafcast_colouring *by = scene->volumes[i].colour_by;
    if (!by)
        return ST_OK;
    if (by->volume->device != v->device)
        return status_describe(ST_USAGE, "what colours volume %d of the scene is on another device",
                               i + 1);
    if (by->volume->kind->given && !by->volume->kind->draped)
        return status_describe(ST_USAGE,
                               "what colours volume %d of the scene, of %s, is a surface itself: "
                               "it has no values at points",
                               i + 1, by->volume->kind->name);
    const leafcast_medium *colours = scene->volumes[i].colours;
    if (!(colours && colours->count > 0) && !has_colours(by))
        return status_describe(ST_USAGE, "leafcast_shown.colour_by: there are no colours");
    const world_axes axes = by->volume->axes,
                     other_axes = known < 0 ? axes : scene->volumes[known].volume->axes;
    if (axes && axes != other_axes)
        return status_describe(ST_USAGE,
                               "what colours volume %d of the scene lies in a world of %s axes, "
                               "volume %d in one of %s: open both with the same "
                               "leafcast_options.axes",
                               i + 1, world_axes_name(axes), known + 1,
                               world_axes_name(other_axes));
    if (by->volume->listed < 0)
        by->volume->listed = scene->volume_count + i;
    const int count = scene->volume_count, first = by->volume->listed;
    const leafcast_shown s = scene_lookup(&scene->volumes[i]),
                         other = first < count ? scene->volumes[first]
                                               : scene_lookup(&scene->volumes[first - count]);
    const status st = between_steps_check(s.volume, s.field, s.step, s.between);
    if (st != ST_OK || same_set(&s, &other))
        return st;
    return status_describe(ST_USAGE,
                           "what colours volume %d of the scene, field %u at step %u, is %s volume "
                           "%d with field %u at step %u, or a different time: at a time, a volume "
                           "has one field and step; open it once more for another",
                           i + 1, s.field, s.step, first < count ? "shown as" : "what colours",
                           (first < count ? first : first - count) + 1, other.field, other.step);
}

/* Forget which objects list a volume, if it is one of the device. */
static void unlist(const leafcast *v, leafcast *of) {
    if (of->device == v->device)
        of->listed = -1;
}

status scene_check(leafcast *v, const leafcast_scene *scene) {
    status st = ST_OK;
    int known = -1;
    v->listed = 0;
    for (int i = 0; i < scene->volume_count; i++) {
        unlist(v, scene->volumes[i].volume);
        if (scene->volumes[i].colour_by)
            unlist(v, scene->volumes[i].colour_by->volume);
    }
    for (int i = 0; i < scene->volume_count && st == ST_OK; i++)
        st = check_shown(v, scene, i, &known);
    for (int i = 0; i < scene->volume_count && st == ST_OK; i++)
        st = check_colouring(v, scene, i, known);
    return st;
}

/* ---- What rays look for ---- */

/* Returns the whole interest. It fits: INTEREST_MAX is LEAFCAST_SURFACES_MAX + SCENE_BESIDE_MAX. */
static interest wanted_of(const leafcast *v) {
    interest_interval of[INTEREST_MAX];
    int count = 0;
    if (v->kind->given)
        return interest_of_all();
    for (int i = 0; i < v->isovalue_count; i++)
        of[count++] = (interest_interval){v->isovalues[i], v->isovalues[i], false, true};
    for (int i = 0; i < v->beside.count; i++)
        of[count++] = v->beside.of[i];
    interest wanted = interest_of_intervals(of, count);
    wanted.whole = v->beside.whole;
    for (int i = 0; i < v->isovalue_count; i++)
        homogeneous_except(&wanted.whole, v->isovalues[i]);
    return wanted;
}

void volume_show(leafcast *v, uint32_t field, uint32_t step, const leafcast_surface *surfaces,
                 int count) {
    const interest nothing = {.count = 0};
    volume_show_beside(
        &(leafcast_shown){
            .volume = v, .field = field, .step = step, .surfaces = surfaces, .count = count},
        &nothing);
}

void volume_show_beside(const leafcast_shown *s, const interest *beside) {
    leafcast *v = s->volume;
    const uint32_t set = between_steps_shown(s);
    bool changed = s->count != v->isovalue_count || set != v->set ||
                   loader_is_behind(v->treelets) || !interest_same(beside, &v->beside);
    for (int i = 0; i < s->count; i++) {
        changed |= v->isovalues[i] != s->surfaces[i].isovalue;
        v->isovalues[i] = s->surfaces[i].isovalue;
    }
    v->isovalue_count = s->count;
    v->seek = (isovalue_list){s->count, v->isovalues};
    v->set = set;
    v->beside = *beside;
    if (!changed)
        return;
    loader_select_set(v->treelets, set);
    const interest wanted = wanted_of(v);
    loader_select(v->treelets, &wanted);
    loader_reset_statistics(v->treelets);
}

void volume_seek_same(leafcast *v, const leafcast *other) {
    memcpy(v->isovalues, other->isovalues, sizeof v->isovalues);
    v->isovalue_count = other->isovalue_count;
    v->seek = (isovalue_list){v->isovalue_count, v->isovalues};
    v->beside = other->beside;
    const interest wanted = wanted_of(v);
    loader_select(v->treelets, &wanted);
}

static void add_clip(tracer *tr, const double plane[4]) {
    memcpy(tr->clip[tr->clip_count++], plane, sizeof tr->clip[0]);
}

static void add_clips(tracer *tr, const leafcast_scene *scene) {
    for (int a = 0; scene->clip_box && a < 3; a++) {
        double below[4] = {0.0, 0.0, 0.0, -scene->clip_min[a]},
               above[4] = {0.0, 0.0, 0.0, scene->clip_max[a]};
        below[a] = 1.0;
        above[a] = -1.0;
        add_clip(tr, below);
        add_clip(tr, above);
    }
    for (int i = 0; i < scene->clip_plane_count; i++)
        add_clip(tr, scene->clip_planes[i]);
}

/* Set how rays walk: as the scene's experiments choose, or else the device's. */
static status choose_walk(const leafcast *v, const leafcast_scene *scene,
                          const struct walk_choice **out) {
    const laboratory *l;
    *out = v->choice;
    if (scene_intersector(scene) == LEAFCAST_MARMITT)
        return ST_OK;
    const status st = laboratory_needed(&l);
    if (st == ST_OK)
        *out = l->walk_by(scene_intersector(scene));
    return st;
}

status volume_check_level(const leafcast *v, const leafcast_scene *scene) {
    const bool coarse = scene->preview && (v->preview_levels > 1 || scene->volume_count > 1);
    if (scene->lod != LEAFCAST_LOD_LEVEL || scene->lod_level == 0 || coarse)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "this %s has no coarse levels: of one with a coarse grid (leafcast "
                           "convert --coarse) a preview has them",
                           v->kind->name);
}

status volume_tracer_of_all(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    const struct walk_choice *choice;
    status st = v->kind->check(v, scene);
    if (st == ST_OK)
        st = choose_walk(v, scene, &choice);
    if (st != ST_OK)
        return st;
    loader_select_gradients(v->treelets, scene->smooth_normals);
    *tr = (tracer){
        .kind = v->kind,
        .kernels = &v->kernels,
        .choice = choice,
        .treelets = v->treelets,
        .layout = &v->file->layout,
        .set = v->set,
        .target_level = scene_level(scene, v),
        .isos = {v->kind->given && v->seek.count > 1 ? 1 : v->seek.count, v->seek.isovalues},
        .space = v->space,
        .preview = scene->preview,
        .lenient = scene->allow_missing && !scene->preview,
        .doubts = scene->preview && scene_is_certified(scene) && scene_filled(scene) == 1,
        .touched = v->touched};
    v->kind->aim(v, scene, c, tr);
    add_clips(tr, scene);
    return ST_OK;
}

status volume_tracer(leafcast *v, const leafcast_scene *scene, const camera *c, tracer *tr) {
    if (v->isovalue_count == 0 && !scene_is_filled(scene))
        return status_describe(ST_USAGE, "no isosurface is selected");
    const status st = volume_tracer_of_all(v, scene, c, tr);
    if (st != ST_OK || !tr->coloured || !v->kind->draped)
        return st;
    return status_describe(ST_USAGE,
                           "field \"%s\" of this %s is an image, which has no elevations: surfaces "
                           "are coloured by it (leafcast_shown.colour_by)",
                           COLOUR_FIELD, v->kind->name);
}
