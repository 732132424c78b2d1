#include "render/door/leafcast_turn.h"

#include "formats/base/box3.h"
#include "render/door/between_steps.h"
#include "render/door/coarse_preview.h"
#include "render/door/leafcast_volume.h"
#include "render/ray/kind.h"

/* Returns the number of media, or 0 if all of them are empty. */
static int filled_media(const leafcast_scene *scene) {
    for (int i = 0; i < scene->media_count; i++)
        if (scene->media[i].count > 0)
            return scene->media_count;
    return 0;
}

/* All that has an element for each object. */
#define TURN_ARRAYS(X) \
    X(of)              \
    X(shown)           \
    X(by)              \
    X(first)           \
    X(next)            \
    X(holds)           \
    X(surfaces)        \
    X(isovalues)       \
    X(place)           \
    X(first_id) X(beside) X(drawn) X(tracers) X(coarse) X(coarse_tracers) X(level) X(reads_on)

/* Make room for objects and lookups, outside of the budget, as the turn itself is. */
static status make_room(turn *t, int objects, int lookups) {
    mem outside;
    bool made = true;
    mem_init(&outside, 0);
#define MAKE(array)                                                                \
    t->array = mem_array(&outside, (size_t)(objects + lookups), sizeof *t->array); \
    made = made && t->array;
    TURN_ARRAYS(MAKE)
#undef MAKE
    t->volumes = made ? objects : 0;
    t->lookups = made ? lookups : 0;
    return made ? ST_OK : ST_NOMEM;
}

static void free_room(turn *t) {
    mem outside;
    mem_init(&outside, 0);
    object_tree_release(&t->objects, &outside);
    scene_groups_release(&t->groups, &outside);
#define FREE(array) mem_free(&outside, t->array);
    TURN_ARRAYS(FREE)
#undef FREE
}

/* The place that a tracer knows: none of a volume of a group. */
static placement tracer_place(const turn *t, int i) {
    return turn_grouped(t, i) ? placement_of(NULL) : t->place[i];
}

/* Choose between the volume and its coarse grid, which then stays open until turn_end(): the same
 * for all objects of a volume. */
static status choose_drawn(turn *t, int i) {
    const leafcast_shown *s = &t->shown[i];
    leafcast *coarse = NULL;
    status st = ST_OK;
    if (turn_is_first(t, i)) {
        if (!turn_is_lookup(t, i))
            st = coarse_preview_instead(s->volume, &t->scene, s, &coarse);
        t->drawn[i] = coarse ? coarse : s->volume;
    } else {
        t->drawn[i] = t->drawn[t->first[i]];
    }
    t->drawn[i]->frames += turn_is_instead(t, i);
    t->tracers[i] = (tracer){.kind = t->drawn[i]->kind,
                             .kernels = &t->drawn[i]->kernels,
                             .twin = t->first[i],
                             .layout = &t->drawn[i]->file->layout,
                             .place = tracer_place(t, i)};
    return st;
}

/* Note which objects are of the same volume as object i. */
static void join_first(turn *t, int i, int last[]) {
    const int first = t->shown[i].volume->listed;
    t->first[i] = first;
    t->next[i] = -1;
    if (first != i)
        t->next[last[first]] = i;
    last[first] = i;
}

/* Copy what the scene says of object i, and choose what is drawn of it. */
static status describe_object(turn *t, int i, int32_t *id) {
    leafcast_shown *s = &t->shown[i];
    t->place[i] = placement_of(s->place);
    s->place = NULL;
    for (int k = 0; k < s->count; k++) {
        t->surfaces[i][k] = s->surfaces[k];
        t->isovalues[i][k] = s->surfaces[k].isovalue;
    }
    s->surfaces = t->surfaces[i];
    if (turn_is_first(t, i)) {
        t->holds[i] = (live_hold){.step = s->step};
        live_steps_hold(s->volume->live, &t->holds[i]);
        s->step = t->holds[i].step;
    } else {
        s->step = t->shown[t->first[i]].step;
    }
    t->first_id[i] = *id;
    *id += s->count;
    t->of[i] = s->volume;
    const status st = between_steps_open(&s->volume, s->between);
    return st == ST_OK ? choose_drawn(t, i) : st;
}

/* List all volumes of the scene's groups behind its own. */
static status list_groups(turn *t, const leafcast *v) {
    mem outside;
    status st = scene_groups_check(v, &t->scene);
    if (st != ST_OK || t->scene.group_count == 0) {
        t->groups.singles = scene_objects(&t->scene);
        return st;
    }
    mem_init(&outside, 0);
    st = scene_groups_list(&t->groups, &outside, &t->scene);
    t->scene.volumes = t->groups.shown;
    t->scene.volume_count = t->groups.volumes;
    if (t->scene.media_count > 0) {
        t->scene.media = t->groups.media;
        t->scene.media_count = t->groups.volumes;
    }
    return st;
}

/* List all objects, and what colours them. */
static void list_objects(turn *t, const leafcast *v, const leafcast_scene *scene) {
    int count = t->volumes;
    for (int i = 0; i < t->volumes; i++) {
        t->shown[i] = scene_object(v, scene, i);
        t->by[i] = -1;
        if (t->lookups > 0 && scene_is_coloured(&t->shown[i])) {
            t->by[i] = count;
            t->shown[count++] = scene_lookup(&t->shown[i]);
        }
    }
    for (int i = turn_all(t) - 1; i >= 0; i--)
        t->shown[i].volume->listed = i;
}

status turn_describe(turn *t, leafcast *v, const leafcast_scene *scene, bool coloured) {
    *t = (turn){.device = v->device, .scene = *scene};
    scene = &t->scene;
    status st = list_groups(t, v);
    if (st == ST_OK)
        st = scene_check(v, scene);
    if (st == ST_OK)
        st = make_room(t, scene_objects(scene), coloured ? scene_lookups(scene) : 0);
    if (st == ST_OK && scene->experiments) {
        t->experiments = *scene->experiments;
        t->scene.experiments = &t->experiments;
    }
    t->scene.media_count = st == ST_OK ? filled_media(scene) : 0;
    list_objects(t, v, scene);
    for (int i = 0; i < turn_all(t); i++)
        join_first(t, i, (int *)t->level); /* not in use yet */
    int32_t id = 0;
    for (int i = 0; i < turn_all(t) && st == ST_OK; i++)
        st = describe_object(t, i, &id);
    for (int i = 0; i < turn_all(t); i++)
        t->level[i] = 0;
    for (int i = t->volumes; i < turn_all(t); i++)
        t->beside[i] = interest_of_all();
    t->f.m = &v->device->budget;
    t->f.threads = v->device->threads;
    t->f.isa = v->device->isa;
    t->f.tracer = t->tracers;
    t->f.volumes = t->volumes;
    t->f.lookups = t->lookups;
    t->f.stand_ins = t->coarse;
    return st;
}

bool turn_any_instead(const turn *t) {
    bool any = false;
    for (int i = 0; i < t->volumes; i++)
        any |= turn_is_instead(t, i);
    return any;
}

bool turn_shows(const turn *t, const leafcast *v) {
    bool shown = false;
    for (int i = 0; i < turn_all(t); i++)
        shown |= t->shown[i].volume == v;
    return shown;
}

/* The volume of the other times of volume i, at steps or between them; NULL: there is none, or it
 * is shown, too. */
static leafcast *other_times(const turn *t, int i) {
    leafcast *of = t->of[i], *other = t->shown[i].volume == of ? of->between : of;
    return !other || turn_shows(t, other) ? NULL : other;
}

/* Whether volume i is drawn at one level, and only its isosurfaces. */
static bool may_be_coarser(const turn *t, int i) {
    return t->scene.preview && !t->scene.sweep && t->scene.lod != LEAFCAST_LOD_PIXEL &&
           !scene_is_filled(&t->scene) && t->shown[i].count > 0 &&
           t->shown[i].volume->file->layout.sampled > 1;
}

/* Choose the level of volume i for the whole frame: one that is soon there (stream/README.md). */
static void choose_level(turn *t, int i) {
    const leafcast *v = t->shown[i].volume;
    const uint32_t asked = scene_level(&t->scene, v);
    t->level[i] = loader_level_within(v->treelets, asked, LOADER_PREVIEW_BYTES);
    t->coarser |= t->level[i] > asked;
}

/* ---- What objects of one volume ask for together ---- */

/* The surfaces of all objects of a volume; `surfaces` lies in of[]. */
typedef struct joint {
    leafcast_shown shown;
    leafcast_surface of[LEAFCAST_SURFACES_MAX];
    interest beside;
    bool all; /* there are too many: it asks for all values */
} joint;

static void add_surface(joint *j, const leafcast_surface *s) {
    int k = 0;
    while (k < j->shown.count && j->of[k].isovalue != s->isovalue)
        k++;
    if (k < j->shown.count)
        return;
    if (k < LEAFCAST_SURFACES_MAX)
        j->of[j->shown.count++] = *s;
    else
        j->all = true;
}

static void add_beside(joint *j, const interest *more) {
    interest_interval of[2 * SCENE_BESIDE_MAX];
    int count = 0;
    for (int i = 0; i < j->beside.count && count < 2 * SCENE_BESIDE_MAX; i++)
        of[count++] = j->beside.of[i];
    for (int i = 0; i < more->count && count < 2 * SCENE_BESIDE_MAX; i++)
        of[count++] = more->of[i];
    const homogeneous whole = j->beside.count > 0 ? j->beside.whole : more->whole;
    j->beside = interest_of_intervals(of, count);
    j->beside.whole = whole;
    j->all = j->all || j->beside.count > SCENE_BESIDE_MAX;
}

/* Join what all objects of volume i, the first of them, ask for. */
static void join_objects(const turn *t, int i, joint *j) {
    *j = (joint){.shown = t->shown[i], .beside = t->beside[i]};
    j->shown.surfaces = j->of;
    j->shown.count = 0;
    for (int k = 0; k < t->shown[i].count; k++)
        j->of[j->shown.count++] = t->surfaces[i][k];
    for (int n = t->next[i]; n >= 0 && !j->all; n = t->next[n]) {
        for (int k = 0; k < t->shown[n].count; k++)
            add_surface(j, &t->surfaces[n][k]);
        add_beside(j, &t->beside[n]);
    }
    if (j->all)
        j->beside = interest_of_all();
}

/* ---- A turn ---- */

/* Select what rays see of a volume in this turn: what all its objects ask for. */
static void select_volume(const turn *t, int i, const joint *j) {
    const leafcast_shown *s = &t->shown[i];
    leafcast *v = s->volume, *other = other_times(t, i);
    if (other)
        loader_rest(other->treelets);
    if (turn_is_instead(t, i))
        return;
    loader_forget_failures(v->treelets);
    if (t->scene.allow_missing && !t->scene.preview)
        loader_tolerate(v->treelets);
    volume_show_beside(&j->shown, &j->beside);
}

static void place_tracer(const turn *t, int i, tracer *tr) {
    tr->place = tracer_place(t, i);
    tr->twin = t->first[i];
    tr->above = t->above;
}

/* Make the tracer of a lookup. Of one that no object shows, it does not matter how surfaces are
 * shaded. */
static status prepare_lookup(turn *t, int i) {
    leafcast_scene scene = t->scene;
    if (turn_is_lookup(t, t->first[i]))
        scene.smooth_normals = scene.analytic_normals = false;
    const status st =
        volume_tracer_of_all(t->shown[i].volume, &scene, &t->f.camera, &t->tracers[i]);
    place_tracer(t, i, &t->tracers[i]);
    return st;
}

/* Make the tracer of object i, and that of its coarse grid. */
static status prepare_object(turn *t, int i, const joint *j) {
    const leafcast_shown *s = &t->shown[i];
    leafcast *v = s->volume;
    status st = ST_OK;
    v->seek = (isovalue_list){s->count, t->isovalues[i]};
    if (turn_is_instead(t, i)) {
        st = coarse_preview_show(t->drawn[i], &t->scene, &j->shown, &j->beside, &t->f.camera,
                                 &t->tracers[i]);
        place_tracer(t, i, &t->tracers[i]);
        return st;
    }
    leafcast_scene scene = t->scene;
    if (turn_is_lookup(t, i))
        return prepare_lookup(t, i);
    if (may_be_coarser(t, i) && !t->begun)
        choose_level(t, i);
    if (t->level[i] > 0) {
        scene.lod = LEAFCAST_LOD_LEVEL;
        scene.lod_level = t->level[i];
    }
    st = volume_tracer(v, &scene, &t->f.camera, &t->tracers[i]);
    place_tracer(t, i, &t->tracers[i]);
    t->tracers[i].preview &= !may_be_coarser(t, i); /* it waits for the level that was chosen */
    if (st == ST_OK && s->count > 0) {
        st = coarse_preview_begin(v, &t->scene, &j->shown, &t->coarse_tracers[i], &t->coarse[i]);
        t->coarse_tracers[i].place = tracer_place(t, i);
    }
    return st;
}

/* Prepare a volume, and all its objects. */
static status prepare_volume(turn *t, int i) {
    joint j;
    status st = ST_OK;
    join_objects(t, i, &j);
    select_volume(t, i, &j);
    for (int n = i; n >= 0 && st == ST_OK; n = t->next[n])
        st = prepare_object(t, n, &j);
    return st;
}

static void widen_by(const turn *t, int i, const tracer *tr, double box[2][3]) {
    double corners[8][3];
    tracer_corners(tr, corners);
    for (int k = 0; k < 8; k++)
        if (turn_grouped(t, i))
            placement_widen(&t->place[i], corners[k], box);
        else
            box3_widen(box, corners[k], corners[k]);
}

/* The box of an object in the world of the scene, or of its group: with that of what stands in for
 * it. */
static void object_box(const turn *t, int i, double box[2][3]) {
    box3_begin(box);
    widen_by(t, i, &t->tracers[i], box);
    if (t->coarse[i])
        widen_by(t, i, t->coarse[i], box);
}

/* Of fewer objects each ray asks all. */
enum { TREE_LEAST = 4 };

/* Make the tree of objects, once their tracers are there. */
static status make_tree(turn *t) {
    mem outside;
    mem_init(&outside, 0);
    t->f.coarse = false;
    for (int i = 0; i < t->volumes; i++)
        t->f.coarse |= t->tracers[i].coarse;
    if (t->volumes < TREE_LEAST && t->groups.count == 0)
        return ST_OK;
    double(*boxes)[2][3] = mem_array(&outside, (size_t)t->volumes, sizeof *boxes);
    if (!boxes)
        return ST_NOMEM;
    for (int i = 0; i < t->volumes; i++)
        object_box(t, i, boxes[i]);
    const status st = scene_groups_join(&t->groups, &outside, (const double(*)[2][3])boxes,
                                        t->place, &t->objects);
    t->f.objects = &t->objects;
    mem_free(&outside, boxes);
    return st;
}

/* Close coarse grids to gain room, also what an earlier preview left. Returns whether any was
 * open. */
static bool drop_coarse(turn *t) {
    bool any = false;
    for (int i = 0; i < turn_all(t); i++) {
        any |= t->shown[i].volume->coarse != NULL;
        t->coarse[i] = NULL;
        coarse_preview_end(t->shown[i].volume);
    }
    return any;
}

/* Read on for the previews that follow, up to so many bytes: what the level asked for needs, coarse
 * levels first. */
static void sweep_for_previews(const turn *t, int i, uint64_t bytes) {
    const leafcast *v = t->shown[i].volume;
    loader_sweep_level(v->treelets, scene_level(&t->scene, v), bytes);
}

static void begin_loading(turn *t, int i) {
    leafcast *v = t->shown[i].volume;
    /* The first picture of a selection shall come soon: what it needs is read alone. */
    t->reads_on[i] = may_be_coarser(t, i) && loader_statistics(v->treelets).loads > 0;
    if (!t->scene.preview)
        loader_follow(v->treelets, v->touched);
    for (uint32_t k = 0; k < v->file->layout.treelets && !t->begun; k++)
        atomic_store_explicit(&v->touched[k], 0, memory_order_relaxed);
    if (turn_is_instead(t, i))
        loader_rest(v->treelets);
    else if (t->scene.sweep && !turn_is_lookup(t, i))
        loader_sweep(v->treelets);
    else if (t->reads_on[i])
        sweep_for_previews(t, i, LOADER_PREVIEW_BYTES);
    else if (t->scene.preview && !may_be_coarser(t, i))
        loader_sweep_level(v->treelets, t->tracers[i].target_level, UINT64_MAX);
}

/* Share the budget out, if need be without what a frame of more scratch has left. */
static status share_budget(turn *t) {
    const status st = budget_share(t);
    return st == ST_NOMEM && device_drop_scratch(t->device) ? budget_share(t) : st;
}

static status prepare_all(turn *t) {
    status st = ST_OK;
    for (int i = 0; i < turn_all(t) && st == ST_OK; i++)
        st = turn_is_first(t, i) ? prepare_volume(t, i) : ST_OK;
    return st == ST_OK ? make_tree(t) : st;
}

/* Set all that another frame may have changed in between. */
status turn_prepare(turn *t) {
    status st = prepare_all(t);
    if (st == ST_NOMEM && !t->scene.preview && drop_coarse(t))
        st = prepare_all(t);
    if (st != ST_OK)
        return st;
    st = share_budget(t);
    if (st == ST_NOMEM && drop_coarse(t))
        st = share_budget(t);
    if (st != ST_OK)
        return st;
    for (int i = 0; i < turn_all(t); i++)
        if (turn_is_first(t, i))
            begin_loading(t, i);
    st = device_scratch(t->device, budget_scratch(&t->f));
    t->f.scratch = t->device->scratch;
    t->begun = true;
    return st;
}

/* ---- The end of a turn ---- */

status turn_check(const turn *t, bool done, status st) {
    for (int i = 0; i < turn_all(t); i++) {
        const leafcast *v = t->shown[i].volume;
        if (!turn_is_first(t, i))
            continue;
        if (st == ST_OK && (t->coarse[i] || turn_is_instead(t, i)))
            st = loader_failure(v->coarse->treelets);
        if (st == ST_OK && done && t->scene.sweep && !t->scene.preview && !turn_is_lookup(t, i))
            st = loader_settle(v->treelets);
        st = volume_check_file(v, st);
    }
    return st;
}

/* Read what is expected of the volume of the other times: what rays saw of this one is much the
 * same. */
static void read_other_times(const turn *t, int i) {
    const leafcast *v = t->shown[i].volume;
    leafcast *other = other_times(t, i);
    if (!other || t->device->budget.limit != 0 || !loader_is_expecting(other->treelets))
        return;
    volume_seek_same(other, v);
    budget_slots(other, SIZE_MAX);
    loader_read_expected(other->treelets, v->touched);
}

void turn_read_on(const turn *t) {
    for (int i = 0; i < turn_all(t); i++) {
        if (!turn_is_first(t, i))
            continue;
        const uint64_t read = loader_statistics(t->shown[i].volume->treelets).bytes_read;
        if (may_be_coarser(t, i) && !t->reads_on[i] && read < LOADER_PREVIEW_BYTES)
            sweep_for_previews(t, i, LOADER_PREVIEW_BYTES - read);
        loader_read_expected(t->shown[i].volume->treelets, t->shown[i].volume->touched);
        read_other_times(t, i);
    }
}

/* ---- Statistics ---- */

static uint64_t visible_bytes(const leafcast *v) {
    uint64_t visible = 0;
    uint32_t family = LEAF_NO_TREELET;
    for (uint32_t t = 0; t < v->file->layout.treelets; t++)
        visible += atomic_load_explicit(&v->touched[t], memory_order_relaxed)
                       ? loader_stored_bytes(v->treelets, t, &family)
                       : 0;
    return visible;
}

static void add_lost(const leafcast *v, leafcast_stats *stats) {
    const char *why;
    const uint32_t lost = loader_lost(v->treelets, &why);
    if (lost > 0 && stats->treelets_lost == 0)
        stats->lost_why = why;
    stats->treelets_lost += lost;
}

static void add_volume_stats(const leafcast *v, leafcast_stats *stats) {
    const loader_stats l = loader_statistics(v->treelets);
    stats->load_s += l.load_s;
    stats->treelets_total += v->file->layout.treelets;
    stats->treelets_active += v->treelets->treelets_active;
    stats->treelets_loaded += l.loads;
    stats->bytes_file += v->file->header.file_bytes;
    stats->bytes_active += v->treelets->bytes_active;
    stats->bytes_visible += visible_bytes(v);
    stats->bytes_read += l.bytes_read;
    stats->bytes_read_ever += l.bytes_read_ever;
    stats->bytes_resident += l.bytes_resident;
    add_lost(v, stats);
}

void turn_stats(const turn *t, leafcast_stats *stats) {
    const leafcast *first = t->shown[0].volume;
    stats->open_s = first->open_s;
    stats->first_image_s = first->first_image_s;
    stats->bytes_peak = mem_peak(&t->device->budget);
    stats->threads = pool_threads(t->f.threads);
    stats->isa = first->device->isa_name;
    for (int i = 0; i < turn_all(t); i++) {
        if (!turn_is_first(t, i))
            continue;
        add_volume_stats(t->shown[i].volume, stats);
        if (t->coarse[i] || turn_is_instead(t, i))
            coarse_preview_stats(t->shown[i].volume, stats);
    }
}

void turn_end(turn *t) {
    t->device->frames_bytes -= t->reserved;
    for (int i = 0; i < turn_all(t) && t->drawn[i]; i++) {
        t->drawn[i]->frames -= turn_is_instead(t, i);
        if (t->holds[i].of)
            loader_rest(t->shown[i].volume->treelets);
        live_steps_let_go(&t->holds[i]);
    }
    free_room(t);
}
