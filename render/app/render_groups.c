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

/* Find the places of all groups that are tiles of the same ground as group i, the first of them. */
static status lay_tiles(render_job *job, int i) {
    const scene_tiles *tiles = job->groups[i].tiles;
    const char *path = scene_tiles_ground(tiles);
    leafcast_shown ground;
    mem outside;
    mem_init(&outside, 0);
    render_places **of =
        mem_array(&outside, (size_t)scene_tiles_count(tiles), sizeof(render_places *));
    if (!of)
        return ST_NOMEM;
    for (int k = i; k < job->group_count; k++)
        if (job->groups[k].tiles == tiles)
            of[job->groups[k].tile] = &job->groups[k].places;
    status st = path ? find_ground(job, path, &ground) : ST_OK;
    if (st == ST_OK)
        st = scene_tiles_place(tiles, &outside, path ? &ground : NULL, of);
    mem_free(&outside, of);
    return st;
}

/* ---- Places ---- */

status render_groups_place(render_job *job) {
    status st = ST_OK;
    job->placed = mem_array(&job->m, (size_t)job->group_count, sizeof *job->placed);
    if (!job->placed)
        return ST_NOMEM;
    for (int i = 0; i < job->group_count && st == ST_OK; i++) {
        const render_group *g = &job->groups[i];
        job->placed[i].parent = g->parent;
        if (g->tiles && g->tile == 0)
            st = lay_tiles(job, i);
        if (st == ST_OK && g->places.count > 0)
            st = render_status(leafcast_make_places(
                job->volume, g->places.at, (uint32_t)g->places.count, &job->placed[i].places));
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

/* Widen a box by one that lies at these places. */
static void widen_at(double box[2][3], const double own[2][3], const double *places, int count) {
    for (int i = 0; i < count && !is_empty(own); i++) {
        const placement place = placement_of(places ? places + 12 * (size_t)i : NULL);
        double at[2][3];
        placement_box(&place, own, at);
        box3_widen(box, at[0], at[1]);
    }
}

/* The box of what lies in a group, or with 0 in the scene itself. */
static void box_in(const render_job *job, int group, double box[2][3]) {
    box3_begin(box);
    for (int i = 0; i < job->object_count; i++) {
        const picture_volume *o = &job->objects[i];
        const leafcast_info info = leafcast_describe(o->volume);
        if (o->group == group)
            widen_at(box, info.bounds, o->place, 1);
    }
    for (int k = 0; k < job->group_count; k++) {
        const render_group *g = &job->groups[k];
        double inside[2][3];
        if (g->parent != group || g->places.count == 0)
            continue;
        box_in(job, k + 1, inside);
        widen_at(box, (const double(*)[3])inside, g->places.at, g->places.count);
    }
}

void render_groups_box(const render_job *job, double box[2][3]) {
    box_in(job, 0, box);
}
