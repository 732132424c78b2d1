#include "render/door/leafcast_scene.h"

#include <string.h>

#include "render/door/arguments.h"
#include "render/door/between_steps.h"
#include "render/door/leafcast_volume.h"
#include "render/frame/laboratory.h"
#include "render/look/scene_facts.h"
#include "render/ray/kind.h"

/* ---- Which volumes ---- */

/* Check that volume i's world axes agree with those of earlier volumes, where both are known. */
static status check_world(const leafcast_scene *scene, int i) {
    const world_axes axes = scene->volumes[i].volume->axes;
    for (int k = 0; k < i; k++) {
        const world_axes other = scene->volumes[k].volume->axes;
        if (axes && other && axes != other)
            return status_describe(ST_USAGE,
                                   "volume %d of the scene lies in a world of %s axes, volume %d "
                                   "in one of %s: open both with the same leafcast_options.axes",
                                   k + 1, world_axes_name(other), i + 1, world_axes_name(axes));
    }
    return ST_OK;
}

/* Check the i-th volume of a scene's list. Its fields have been checked, so that nothing else can
 * be wrong with its surfaces than that there are none. */
static status check_shown(const leafcast *v, const leafcast_scene *scene, int i) {
    const leafcast_shown *s = &scene->volumes[i];
    if (s->volume->device != v->device)
        return status_describe(ST_USAGE, "volume %d of the scene is on another device", i + 1);
    for (int k = 0; k < i; k++)
        if (scene->volumes[k].volume == s->volume)
            return status_describe(ST_USAGE, "volumes %d and %d of the scene are the same", k + 1,
                                   i + 1);
    status st = check_world(scene, i);
    if (st == ST_OK)
        st = between_steps_check(s->volume, s->field, s->step, s->between);
    const bool empty = s->count == 0 && !scene_is_filled(scene);
    return st == ST_OK && empty ? arguments_check_surfaces(s->surfaces, s->count) : st;
}

status scene_volumes(leafcast *v, const leafcast_scene *scene,
                     leafcast_shown shown[LEAFCAST_VOLUMES_MAX], int *count) {
    status st = ST_OK;
    *count = scene->volume_count;
    for (int i = 0; i < *count && st == ST_OK; i++) {
        st = check_shown(v, scene, i);
        shown[i] = scene->volumes[i];
    }
    if (st != ST_OK || *count > 0)
        return st;
    shown[0] = (leafcast_shown){.volume = v,
                                .field = v->field,
                                .step = v->step,
                                .surfaces = v->surfaces,
                                .count = v->surface_count,
                                .between = v->share};
    *count = 1;
    return ST_OK;
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
    const int count = v->kind->given && s->count > 1 ? 1 : s->count;
    bool changed = count != v->isovalue_count || set != v->set || loader_is_behind(v->treelets) ||
                   !interest_same(beside, &v->beside);
    for (int i = 0; i < count; i++) {
        changed |= v->isovalues[i] != s->surfaces[i].isovalue;
        v->isovalues[i] = s->surfaces[i].isovalue;
    }
    v->isovalue_count = count;
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
    const bool coarse = scene->preview && v->preview_levels > 1;
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
    *tr =
        (tracer){.kind = v->kind,
                 .kernels = &v->kernels,
                 .choice = choice,
                 .treelets = v->treelets,
                 .layout = &v->file->layout,
                 .set = v->set,
                 .target_level = scene_level(scene, v),
                 .isos = {v->isovalue_count, v->isovalues},
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
    return volume_tracer_of_all(v, scene, c, tr);
}
