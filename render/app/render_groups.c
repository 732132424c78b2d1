#include "render/app/render_groups.h"

#include <string.h>

#include "formats/base/box3.h"
#include "render/app/scene_tiles.h"
#include "render/ray/placement.h"

/* ---- Tiles ---- */

/* What is shown of the ground: the scene's object of that file. */
static status find_ground(const render_job *job, const char *path, leafcast_shown *out) {
    static const leafcast_surface surface = {.opacity = 1.0f};
    const render_places *places = NULL;
    *out = (leafcast_shown){.surfaces = &surface, .count = 1};
    if (job->group == 0 && strcmp(job->source, path) == 0) {
        out->volume = job->volume;
        places = &job->places;
    }
    for (int i = 0; i < job->also_count && !out->volume; i++)
        if (job->also[i].group == 0 && strcmp(job->also[i].path, path) == 0) {
            out->volume = job->also[i].volume;
            places = &job->also[i].places;
        }
    if (!out->volume || places->count > 1)
        return status_describe(ST_USAGE,
                               "tiles: their ground, \"%s\", is no \"file\" of another object of "
                               "the scene, at one place",
                               path);
    if (!(leafcast_describe(out->volume).abilities & LEAFCAST_ABILITY_GIVEN))
        return status_describe(ST_USAGE,
                               "tiles: their ground, \"%s\", is no surface: terrain and triangles "
                               "are",
                               path);
    out->place = places->count > 0 ? places->at : NULL;
    return ST_OK;
}

static status lay_tiles(const render_job *job, render_group *group) {
    const char *path = scene_tiles_ground(group->tiles);
    leafcast_shown ground;
    mem outside;
    mem_init(&outside, 0);
    const status st = path ? find_ground(job, path, &ground) : ST_OK;
    return st == ST_OK ? scene_tiles_place(group->tiles, &outside, path ? &ground : NULL,
                                           &group->places, &group->which)
                       : st;
}

/* ---- Places ---- */

status render_groups_place(render_job *job) {
    status st = ST_OK;
    job->placed = mem_array(&job->m, (size_t)job->group_count, sizeof *job->placed);
    if (!job->placed)
        return ST_NOMEM;
    for (int i = 0; i < job->group_count && st == ST_OK; i++) {
        render_group *g = &job->groups[i];
        job->placed[i] = (picture_group){.parent = g->parent, .chosen = g->chosen};
        if (g->tiles)
            st = lay_tiles(job, g);
        if (st == ST_OK && g->places.count > 0)
            st = render_status(leafcast_make_places(job->volume, g->places.at, g->which,
                                                    (uint32_t)g->places.count,
                                                    &job->placed[i].places));
    }
    return st;
}

void render_groups_release(render_job *job) {
    for (int i = 0; i < job->group_count && job->placed; i++)
        leafcast_free_places(job->placed[i].places);
    mem_free(&job->m, job->placed);
    job->placed = NULL;
}

/* ---- Boxes ---- */

static bool is_empty(const double box[2][3]) {
    return !(box[0][0] <= box[1][0]);
}

/* Widen a box by one that lies at a place; NULL: in the same world. */
static void widen_at(double box[2][3], const double own[2][3], const double *at) {
    const placement place = placement_of(at);
    double there[2][3];
    if (is_empty(own))
        return;
    placement_box(&place, own, there);
    box3_widen(box, there[0], there[1]);
}

static void box_in(const render_job *job, int group, double box[2][3]);

/* Widen a box by what lies where the places of group k say so: the groups behind it. */
static void widen_by_chosen(double box[2][3], const render_job *job, int k) {
    const render_group *g = &job->groups[k];
    double inside[SCENE_TILES_MAX][2][3];
    for (int i = 0; i < scene_tiles_count(g->tiles); i++)
        box_in(job, k + 2 + i, inside[i]);
    for (int i = 0; i < g->places.count; i++)
        widen_at(box, (const double(*)[3])inside[g->which[i]], g->places.at + 12 * (size_t)i);
}

/* Widen a box by group k at all its places. */
static void widen_by(double box[2][3], const render_job *job, int k) {
    const render_group *g = &job->groups[k];
    double inside[2][3];
    if (g->which) {
        widen_by_chosen(box, job, k);
        return;
    }
    box_in(job, k + 1, inside);
    for (int i = 0; i < g->places.count; i++)
        widen_at(box, (const double(*)[3])inside, g->places.at + 12 * (size_t)i);
}

/* The box of what lies in a group, or with 0 in the scene itself. */
static void box_in(const render_job *job, int group, double box[2][3]) {
    box3_begin(box);
    for (int i = 0; i < job->object_count; i++) {
        const picture_volume *o = &job->objects[i];
        const leafcast_info info = leafcast_describe(o->volume);
        if (o->group == group)
            widen_at(box, info.bounds, o->place);
    }
    for (int k = 0; k < job->group_count; k++)
        if (job->groups[k].parent == group)
            widen_by(box, job, k);
}

void render_groups_box(const render_job *job, double box[2][3]) {
    box_in(job, 0, box);
}
