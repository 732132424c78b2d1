#include "render/door/scene_groups.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/public_status.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/ray/open_volume.h"

/* ---- Places ---- */

/* How far places go: bounds for all of them. */
typedef struct extent {
    double grow, shrink, uneven, shift; /* uneven: grow / shrink of one */
} extent;

struct leafcast_places {
    const leafcast_device *device;
    uint32_t count;
    placement *place;
    extent most;
    /* Over the places of a group with this box; empty, until a picture shows one. */
    double box[2][3];
    object_tree tree;
    bool listed; /* scratch of scene_groups_check() */
};

static void add_extent(extent *most, const placement *p) {
    double shift = 0.0;
    for (int a = 0; a < 3; a++)
        shift = fmax(shift, fabs(p->space.to_world[a][3]));
    most->grow = fmax(most->grow, p->grow);
    most->shrink = fmin(most->shrink, p->shrink);
    most->uneven = fmax(most->uneven, p->grow / p->shrink);
    most->shift = fmax(most->shift, shift);
}

/* What one extent is inside another. */
static extent within(const extent *outer, const extent *inner) {
    return (extent){outer->grow * inner->grow, outer->shrink * inner->shrink,
                    outer->uneven * inner->uneven,
                    outer->shift + sqrt(3.0) * outer->grow * inner->shift};
}

static const extent nothing_moved = {1.0, 1.0, 1.0, 0.0};

/* Whether all that is there passes placement_check(): norms of a matrix differ by factors of at
 * most 3. */
static bool is_possible(const extent *e) {
    return e->grow <= LEAFCAST_SCALE_MOST / 3.0 && e->shrink >= 3.0 / LEAFCAST_SCALE_MOST &&
           e->uneven <= LEAFCAST_SCALE_UNEVEN / 3.0 && e->shift <= LEAFCAST_PLACE_MOST;
}

static status make_places(const leafcast_device *device, const double *places, uint32_t count,
                          leafcast_places **out) {
    mem outside;
    mem_init(&outside, 0);
    leafcast_places *p = mem_zalloc(&outside, sizeof *p);
    placement *place = mem_array(&outside, count, sizeof *place);
    if (!p || !place) {
        mem_free(&outside, place);
        mem_free(&outside, p);
        return ST_NOMEM;
    }
    *p = (leafcast_places){
        .device = device, .count = count, .place = place, .most = {0.0, INFINITY, 0.0, 0.0}};
    for (uint32_t i = 0; i < count; i++) {
        place[i] = placement_of(places + 12 * (size_t)i);
        add_extent(&p->most, &place[i]);
    }
    *out = p;
    return ST_OK;
}

static status check_places(const double *places, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        status st = ST_OK;
        for (int k = 0; k < 12 && st == ST_OK; k++)
            st = public_in_range("leafcast_make_places", "a number of a place",
                                 places[12 * (size_t)i + (size_t)k], -LEAFCAST_PLACE_MOST,
                                 LEAFCAST_PLACE_MOST);
        if (st == ST_OK)
            st = placement_check(places + 12 * (size_t)i);
        if (st != ST_OK)
            return status_describe(st, "place %u of %u: %s", i + 1, count, status_text());
    }
    return ST_OK;
}

leafcast_status leafcast_make_places(const leafcast *volume, const double *places, uint32_t count,
                                     leafcast_places **out) {
    status st = public_needs(__func__, "volume places out", (const void *[]){volume, places, out});
    if (st != ST_OK)
        return public_status(st);
    *out = NULL;
    st = public_in_range(__func__, "count", count, 1, OBJECTS_MOST);
    if (st == ST_OK)
        st = check_places(places, count);
    if (st == ST_OK)
        st = make_places(volume->device, places, count, out);
    return public_status(st);
}

void leafcast_free_places(leafcast_places *places) {
    mem outside;
    mem_init(&outside, 0);
    if (!places)
        return;
    object_tree_release(&places->tree, &outside);
    mem_free(&outside, places->place);
    mem_free(&outside, places);
}

/* Make the tree over places of a box, unless there is that one. */
static status raise_places(leafcast_places *p, const double box[2][3]) {
    mem outside;
    if (p->tree.entries > 0 && memcmp(p->box, box, sizeof p->box) == 0)
        return ST_OK;
    mem_init(&outside, 0);
    object_tree_release(&p->tree, &outside);
    double(*boxes)[2][3] = mem_array(&outside, p->count, sizeof *boxes);
    if (!boxes)
        return ST_NOMEM;
    for (uint32_t i = 0; i < p->count; i++)
        placement_box(&p->place[i], box, boxes[i]);
    const status st = object_tree_make(&p->tree, &outside, (const double(*)[2][3])boxes, p->count);
    memcpy(p->box, box, sizeof p->box);
    if (st != ST_OK)
        object_tree_release(&p->tree, &outside);
    mem_free(&outside, boxes);
    return st;
}

/* ---- Lists ---- */

/* A group of the list. */
struct scene_group {
    const leafcast_group *of;
    int first; /* its first volume, */
    int child; /* and group, in the list */
    object_tree members;
};

static status refuse(const char *what) {
    return status_describe(ST_USAGE, "leafcast_scene.groups: not with %s", what);
}

/* What a picture with groups cannot have. */
static status check_picture(const leafcast_scene *scene) {
    if (scene->project != LEAFCAST_PROJECT_NONE)
        return refuse("projections");
    if (scene->caps)
        return refuse("caps");
    if (scene->lod == LEAFCAST_LOD_PIXEL)
        return refuse("levels by pixels");
    if (scene->experiments && scene->experiments->summing != LEAFCAST_CERTIFIED)
        return refuse("media in steps");
    return ST_OK;
}

static status check_member(const leafcast_shown *s, const extent *all) {
    extent e = nothing_moved;
    const placement place = placement_of(s->place);
    if (s->count == 0)
        return status_describe(ST_USAGE, "a volume of a group has no surfaces");
    if (s->colour_by)
        return status_describe(ST_USAGE, "a volume of a group is coloured by another volume's "
                                         "values: only volumes of the scene itself can be");
    if (place.moved) {
        e = (extent){0.0, INFINITY, 0.0, 0.0};
        add_extent(&e, &place);
    }
    e = within(all, &e);
    if (is_possible(&e))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "a volume of a group: its place, with the places of its groups, may "
                           "scale by more than %g, move by more than %g, or nearly flatten space",
                           LEAFCAST_SCALE_MOST / 3.0, LEAFCAST_PLACE_MOST);
}

/* Check a group inside another; sets `listed` of its places. */
static status check_group(const leafcast *v, const leafcast_group *g, const extent *outer,
                          int depth, int *volumes) {
    if (depth >= OBJECT_DEPTH)
        return status_describe(ST_USAGE,
                               "leafcast_scene.groups: groups lie in groups, %d deep: %d is "
                               "possible",
                               depth, OBJECT_DEPTH - 1);
    status st = arguments_check_group(g);
    if (st != ST_OK)
        return st;
    if (g->places->device != v->device)
        return status_describe(ST_USAGE, "places of a group are of another device");
    if (g->places->listed)
        return status_describe(ST_USAGE, "two groups of a scene have the same leafcast_places: "
                                         "make them twice");
    g->places->listed = true;
    const extent all = within(outer, &g->places->most);
    *volumes += g->volume_count;
    for (int i = 0; i < g->volume_count && st == ST_OK; i++)
        st = check_member(&g->volumes[i], &all);
    for (int i = 0; i < g->group_count && st == ST_OK; i++)
        st = check_group(v, &g->groups[i], &all, depth + 1, volumes);
    return st;
}

static void unlist(const leafcast_group *groups, int count, int depth) {
    for (int i = 0; i < count && depth < OBJECT_DEPTH; i++) {
        if (groups[i].places)
            groups[i].places->listed = false;
        if (groups[i].groups)
            unlist(groups[i].groups, groups[i].group_count, depth + 1);
    }
}

status scene_groups_check(const leafcast *v, const leafcast_scene *scene) {
    int volumes = scene->volume_count;
    if (scene->group_count == 0)
        return ST_OK;
    status st = check_picture(scene);
    for (int i = 0; i < scene->group_count && st == ST_OK; i++)
        st = check_group(v, &scene->groups[i], &nothing_moved, 1, &volumes);
    unlist(scene->groups, scene->group_count, 1);
    if (st == ST_OK && volumes > LEAFCAST_VOLUMES_MAX)
        st = status_describe(ST_USAGE,
                             "a scene and its groups list %d volumes: %d are possible, each placed "
                             "often",
                             volumes, LEAFCAST_VOLUMES_MAX);
    return st;
}

static int groups_below(const leafcast_group *groups, int count) {
    int all = count;
    for (int i = 0; i < count; i++)
        all += groups_below(groups[i].groups, groups[i].group_count);
    return all;
}

static int volumes_below(const leafcast_group *groups, int count) {
    int all = 0;
    for (int i = 0; i < count; i++)
        all += groups[i].volume_count + volumes_below(groups[i].groups, groups[i].group_count);
    return all;
}

/* Append groups that lie side by side. */
static void append(scene_groups *g, const leafcast_group *groups, int count) {
    for (int i = 0; i < count; i++)
        g->groups[g->count++] = (struct scene_group){.of = &groups[i]};
}

status scene_groups_list(scene_groups *g, mem *m, const leafcast_scene *scene) {
    *g = (scene_groups){.singles = scene->volume_count, .own = scene->group_count};
    if (scene->group_count == 0)
        return ST_OK;
    const size_t volumes = (size_t)(scene->volume_count +
                                    volumes_below(scene->groups, scene->group_count)),
                 groups = (size_t)groups_below(scene->groups, scene->group_count);
    g->shown = mem_array(m, volumes, sizeof *g->shown);
    g->media = mem_array(m, volumes, sizeof *g->media);
    g->groups = mem_array(m, groups, sizeof *g->groups);
    g->links = mem_array(m, groups, sizeof *g->links);
    if (!g->shown || !g->media || !g->groups || !g->links)
        return ST_NOMEM;
    for (int i = 0; i < scene->volume_count; i++) {
        g->shown[i] = scene->volumes[i];
        if (scene->media_count > 0)
            g->media[i] = scene->media[i];
    }
    g->volumes = scene->volume_count;
    append(g, scene->groups, scene->group_count);
    for (int i = 0; i < g->count; i++) {
        const leafcast_group *of = g->groups[i].of;
        g->groups[i].first = g->volumes;
        g->groups[i].child = g->count;
        for (int k = 0; k < of->volume_count; k++)
            g->shown[g->volumes++] = of->volumes[k];
        append(g, of->groups, of->group_count);
    }
    return ST_OK;
}

void scene_groups_release(scene_groups *g, mem *m) {
    for (int i = 0; i < g->count; i++)
        object_tree_release(&g->groups[i].members, m);
    mem_free(m, g->links);
    mem_free(m, g->groups);
    mem_free(m, g->media);
    mem_free(m, g->shown);
    *g = (scene_groups){0};
}

/* ---- Trees ---- */

/* Make the tree over volumes and groups that lie in the same world. */
static status make_tree(scene_groups *g, mem *m, const double (*boxes)[2][3], int first,
                        int volumes, int child, int groups, object_tree *t) {
    const size_t count = (size_t)(volumes + groups);
    double(*of)[2][3] = mem_array(m, count, sizeof *of);
    if (!of)
        return ST_NOMEM;
    for (int i = 0; i < volumes; i++)
        memcpy(of[i], boxes[first + i], sizeof *of);
    for (int i = 0; i < groups; i++)
        memcpy(of[volumes + i], g->links[child + i].places->nodes->box, sizeof *of);
    object_tree_release(t, m);
    status st = object_tree_make(t, m, (const double(*)[2][3])of, (uint32_t)count);
    mem_free(m, of);
    t->singles = (uint32_t)volumes;
    t->volume = (uint32_t)first;
    t->groups = groups > 0 ? &g->links[child] : NULL;
    if (st == ST_OK && !object_tree_count(t, groups > 0 ? &g->links[child] : NULL))
        st = status_describe(ST_USAGE, "a scene with its groups has more than %u objects",
                             (unsigned)OBJECTS_MOST);
    return st;
}

/* Make the trees of a group, once those of the groups in it are there. */
static status make_group(scene_groups *g, mem *m, const double (*boxes)[2][3],
                         const placement *place, int i) {
    struct scene_group *group = &g->groups[i];
    leafcast_places *places = group->of->places;
    status st = make_tree(g, m, boxes, group->first, group->of->volume_count, group->child,
                          group->of->group_count, &group->members);
    group->members.place = place + group->first;
    if (st == ST_OK)
        st = raise_places(places, (const double(*)[3])group->members.nodes->box);
    g->links[i] = (object_group){&places->tree, places->place, &group->members, 0};
    return st;
}

status scene_groups_join(scene_groups *g, mem *m, const double (*boxes)[2][3],
                         const placement *place, object_tree *top) {
    status st = ST_OK;
    for (int i = g->count - 1; i >= 0 && st == ST_OK; i--)
        st = make_group(g, m, boxes, place, i);
    return st == ST_OK ? make_tree(g, m, boxes, 0, g->singles, 0, g->own, top) : st;
}
