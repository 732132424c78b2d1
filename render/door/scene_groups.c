#include "render/door/scene_groups.h"

#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "formats/public_status.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/ray/open_volume.h"

static status too_many(void) {
    return status_describe(ST_USAGE, "a scene with its groups has more than %u objects",
                           (unsigned)OBJECTS_MOST);
}

/* ---- Places ---- */

/* How far places go: bounds for all of them. */
typedef struct extent {
    double grow, shrink, uneven, shift; /* uneven: grow / shrink of one */
} extent;

struct leafcast_places {
    const leafcast_device *device;
    uint32_t count;
    placement *place;
    uint16_t *which; /* NULL: all */
    uint32_t kinds;  /* above all numbers in it; 1 where all is everywhere */
    extent most;
    /* Over the places of what has these boxes, and so many objects; empty, until a picture shows
     * that. */
    double (*box)[2][3];
    uint32_t *objects;
    uint32_t *starts; /* object_group */
    box_tree tree;
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

static void free_places(leafcast_places *p, mem *m) {
    box_tree_release(&p->tree, m);
    mem_free(m, p->starts);
    mem_free(m, p->objects);
    mem_free(m, p->box);
    mem_free(m, p->which);
    mem_free(m, p->place);
    mem_free(m, p);
}

static status make_places(const leafcast_device *device, const double *places,
                          const uint16_t *which, uint32_t count, leafcast_places **out) {
    mem outside;
    mem_init(&outside, 0);
    leafcast_places *p = mem_zalloc(&outside, sizeof *p);
    if (!p)
        return ST_NOMEM;
    *p = (leafcast_places){
        .device = device, .count = count, .kinds = 1, .most = {0.0, INFINITY, 0.0, 0.0}};
    for (uint32_t i = 0; i < count && which; i++)
        p->kinds = which[i] < p->kinds ? p->kinds : which[i] + 1u;
    p->place = mem_array(&outside, count, sizeof *p->place);
    p->which = which ? mem_array(&outside, count, sizeof *p->which) : NULL;
    p->starts = which ? mem_array(&outside, (size_t)count + 1, sizeof *p->starts) : NULL;
    p->box = mem_array(&outside, p->kinds, sizeof *p->box);
    p->objects = mem_array(&outside, p->kinds, sizeof *p->objects);
    if (!p->place || !p->box || !p->objects || (which && (!p->which || !p->starts))) {
        free_places(p, &outside);
        return ST_NOMEM;
    }
    for (uint32_t i = 0; i < count; i++) {
        p->place[i] = placement_of(places + 12 * (size_t)i);
        add_extent(&p->most, &p->place[i]);
    }
    if (which)
        memcpy(p->which, which, count * sizeof *which);
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

leafcast_status leafcast_make_places(const leafcast *volume, const double *places,
                                     const uint16_t *which, uint32_t count, leafcast_places **out) {
    status st = public_needs(__func__, "volume places out", (const void *[]){volume, places, out});
    if (st == ST_OK)
        st = arguments_check_volume(__func__, volume);
    if (st != ST_OK)
        return public_status(st);
    *out = NULL;
    st = public_in_range(__func__, "count", count, 1, BOX_ENTRIES_MOST);
    if (st == ST_OK)
        st = check_places(places, count);
    if (st == ST_OK)
        st = make_places(volume->device, places, which, count, out);
    return public_status(st);
}

void leafcast_free_places(leafcast_places *places) {
    mem outside;
    mem_init(&outside, 0);
    if (places)
        free_places(places, &outside);
}

/* Whether there is the tree over places of what has these trees: their boxes and objects. */
static bool is_raised(leafcast_places *p, const object_tree members[]) {
    bool same = p->tree.entries > 0;
    for (uint32_t k = 0; k < p->kinds; k++) {
        same = same && p->objects[k] == members[k].objects &&
               memcmp(p->box[k], members[k].of.box, sizeof *p->box) == 0;
        p->objects[k] = members[k].objects;
        memcpy(p->box[k], members[k].of.box, sizeof *p->box);
    }
    return same;
}

/* Count objects at places that have different ones. */
static status count_objects(leafcast_places *p) {
    uint64_t count = 0;
    for (uint32_t i = 0; i < p->count && count <= OBJECTS_MOST; i++) {
        p->starts[i] = (uint32_t)count;
        count += p->objects[p->which[i]];
    }
    p->starts[p->count] = (uint32_t)count;
    return count <= OBJECTS_MOST ? ST_OK : too_many();
}

/* Make the tree over places, unless it is there. */
static status raise_places(leafcast_places *p, const object_tree members[]) {
    mem outside;
    if (is_raised(p, members))
        return ST_OK;
    mem_init(&outside, 0);
    box_tree_release(&p->tree, &outside);
    double(*boxes)[2][3] = mem_array(&outside, p->count, sizeof *boxes);
    if (!boxes)
        return ST_NOMEM;
    for (uint32_t i = 0; i < p->count; i++)
        placement_box(&p->place[i], (const double(*)[3])p->box[p->which ? p->which[i] : 0],
                      boxes[i]);
    status st = box_tree_make(&p->tree, &outside, (const double(*)[2][3])boxes, p->count);
    if (st == ST_OK && p->which)
        st = count_objects(p);
    if (st != ST_OK)
        box_tree_release(&p->tree, &outside);
    mem_free(&outside, boxes);
    return st;
}

/* ---- Lists ---- */

/* A group of the list. */
struct scene_group {
    const leafcast_group *of;
    int first; /* its first volume, */
    int child; /* and group, in the list */
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

/* Check where a group is; sets `listed` of its places. chosen: by places of what it lies in. */
static status check_where(const leafcast *v, const leafcast_group *g, bool chosen) {
    leafcast_places *p = g->places;
    if (chosen && !p)
        return ST_OK;
    if (chosen)
        return status_describe(ST_USAGE,
                               "leafcast_group.places: a group that lies where places say "
                               "so has none of its own");
    if (!p)
        return status_describe(ST_USAGE, "leafcast_group.places is NULL");
    if (p->device != v->device)
        return status_describe(ST_USAGE, "places of a group are of another device");
    if (p->listed)
        return status_describe(ST_USAGE, "two groups of a scene have the same leafcast_places: "
                                         "make them twice");
    p->listed = true;
    if (!p->which || (g->volume_count == 0 && p->kinds <= (uint32_t)g->group_count))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "leafcast_group: its places name group %u of %d, and volumes would lie "
                           "nowhere",
                           p->kinds - 1, g->group_count);
}

/* Check a group inside another. chosen: as there. */
static status check_group(const leafcast *v, const leafcast_group *g, const extent *outer,
                          bool chosen, int depth, int *volumes) {
    if (depth >= OBJECT_DEPTH)
        return status_describe(ST_USAGE,
                               "leafcast_scene.groups: groups lie in groups, %d deep: %d is "
                               "possible",
                               depth, OBJECT_DEPTH - 1);
    status st = arguments_check_group(g);
    if (st != ST_OK)
        return st;
    st = check_where(v, g, chosen);
    if (st != ST_OK)
        return st;
    const extent all = g->places ? within(outer, &g->places->most) : *outer;
    const bool choose = g->places && g->places->which;
    *volumes += g->volume_count;
    for (int i = 0; i < g->volume_count && st == ST_OK; i++)
        st = check_member(&g->volumes[i], &all);
    for (int i = 0; i < g->group_count && st == ST_OK; i++)
        st = check_group(v, &g->groups[i], &all, choose, depth + 1, volumes);
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
        st = check_group(v, &scene->groups[i], &nothing_moved, false, 1, &volumes);
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
    g->members = mem_array(m, groups, sizeof *g->members);
    if (!g->shown || !g->media || !g->groups || !g->links || !g->members)
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
        object_tree_release(&g->members[i], m);
    mem_free(m, g->members);
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
        memcpy(of[volumes + i], g->links[child + i].places->box, sizeof *of);
    object_tree_release(t, m);
    status st = object_tree_make(t, m, (const double(*)[2][3])of, (uint32_t)count);
    mem_free(m, of);
    t->singles = (uint32_t)volumes;
    t->volume = (uint32_t)first;
    t->groups = groups > 0 ? &g->links[child] : NULL;
    if (st == ST_OK && !object_tree_count(t, groups > 0 ? &g->links[child] : NULL))
        st = too_many();
    return st;
}

/* Make the trees of a group, once those of the groups in it are there. Groups that lie in it where
 * its places say so are reached by them, and by no tree. */
static status make_group(scene_groups *g, mem *m, const double (*boxes)[2][3],
                         const placement *place, int i) {
    const struct scene_group *group = &g->groups[i];
    leafcast_places *p = group->of->places;
    const bool choose = p && p->which;
    object_tree *members = choose ? &g->members[group->child] : &g->members[i];
    status st = ST_OK;
    if (!choose)
        st = make_tree(g, m, boxes, group->first, group->of->volume_count, group->child,
                       group->of->group_count, members);
    if (!choose)
        members->place = place + group->first;
    if (st != ST_OK || !p)
        return st;
    st = raise_places(p, members);
    g->links[i] = (object_group){&p->tree, p->place, p->which, p->starts, members, 0};
    return st;
}

status scene_groups_join(scene_groups *g, mem *m, const double (*boxes)[2][3],
                         const placement *place, object_tree *top) {
    status st = ST_OK;
    for (int i = g->count - 1; i >= 0 && st == ST_OK; i--)
        st = make_group(g, m, boxes, place, i);
    return st == ST_OK ? make_tree(g, m, boxes, 0, g->singles, 0, g->own, top) : st;
}
