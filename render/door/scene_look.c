#include "render/door/scene_look.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_histogram.h"
#include "render/door/between_steps.h"
#include "render/door/coarse_preview.h"
#include "render/ray/kind.h"
#include "render/surface/refraction.h"
#include "render/surface/surface_integrator.h"
#include "render/surface/surface_ray.h"

static bool mirrors(const leafcast_surface *s) {
    return s->reflectivity > 0.0F;
}

static bool is_clear(const leafcast_surface *s) {
    return s->opacity < 1.0F;
}

static bool any_surface(const turn *t, bool (*is)(const leafcast_surface *s)) {
    for (int v = 0; v < t->volumes; v++)
        for (int i = 0; i < t->shown[v].count; i++)
            if (is(&t->surfaces[v][i]))
                return true;
    return false;
}

/* Returns an upper bound of a lit surface's colour channels. */
static double brightest_surface(const scene_look *l) {
    const turn *t = l->turn;
    const leafcast_scene *scene = &t->scene;
    double rgb = 0.0, lights = scene->light_count > 0 ? 0.0 : 1.0;
    for (int i = 0; i < scene->light_count; i++)
        lights += (double)fmaxf(scene->lights[i].rgb[0],
                                fmaxf(scene->lights[i].rgb[1], scene->lights[i].rgb[2]));
    for (int v = 0; v < t->volumes; v++)
        for (int i = 0; i < t->shown[v].count; i++)
            for (int c = 0; c < 3; c++)
                rgb = fmax(rgb, (double)t->surfaces[v][i].rgb[c]);
    for (int v = 0; v < t->volumes; v++)
        rgb = fmax(rgb, l->colours[v].spans > 0 ? l->colours[v].most_rgb : t->tracers[v].coloured);
    return rgb * (1.0 + lights) + fabs((double)scene->specular) * lights;
}

/* The value range that lighting and colours go by, also where a coarse grid is drawn. */
static void shown_range(const scene_look *l, int i, double range[2]) {
    const leafcast_shown *s = &l->turn->shown[i];
    const leaf_file *of = s->volume->file;
    leaf_histogram_range(of, between_steps_shown(s), range);
}

/* The value range of the data that is drawn: the volume's, or its coarse grid's. */
static void drawn_range(const scene_look *l, int i, double range[2]) {
    leafcast *drawn = l->turn->drawn[i];
    const leafcast_shown grid = coarse_preview_shown(drawn, &l->turn->shown[i]);
    if (turn_is_instead(l->turn, i))
        leaf_histogram_range(drawn->file, between_steps_shown(&grid), range);
    else
        shown_range(l, i, range);
}

static status refuse_given(const turn *t, int i, const char *what) {
    return status_describe(ST_USAGE, "volume %d of the scene, of %s, is a surface: %s", i + 1,
                           t->shown[i].volume->kind->name, what);
}

static status fill_volume(scene_look *l, int i) {
    turn *t = l->turn;
    interest_interval of[SCENE_BESIDE_MAX];
    transfer *medium = &l->media[i];
    const status st = transfer_init(medium, t->f.m, &t->scene.media[i]);
    if (st != ST_OK || medium->spans == 0)
        return st;
    if (t->shown[i].volume->kind->given)
        return refuse_given(t, i, "no medium fills it");
    t->beside[i] = interest_of_intervals(of, transfer_interest(medium, of, SCENE_BESIDE_MAX));
    drawn_range(l, i, l->ranges[i]);
    l->look.brightest = fmax(l->look.brightest, medium->most_rgb);
    return ST_OK;
}

/* Set media up for an experiment that sums in steps, without an error bound. */
static status fill_for_steps(scene_look *l) {
    turn *t = l->turn;
    if (t->volumes > 1 || t->shown[0].count > 0 || t->place[0].moved)
        return status_describe(ST_USAGE, "media in steps: one volume without isosurfaces, and "
                                         "without a place");
    const status st = laboratory_needed(&l->laboratory);
    const laboratory_medium medium = {&l->media[0], l->ranges[0],
                                      leafcast_describe(t->shown[0].volume).cell_size};
    return st == ST_OK ? l->laboratory->begin_steps(&t->f, &t->scene, &medium, &l->stepped) : st;
}

/* For the only filled volume: which ranges of values are taken whole. */
static homogeneous homogeneous_of(const scene_look *l, int i) {
    const leafcast *v = l->turn->drawn[i];
    const leafcast_scene_experiments *e = l->turn->scene.experiments;
    leafcast_info info = {0};
    double square = 0.0;
    v->kind->describe(v, leaf_layout_step(&v->file->layout, v->set), &info);
    for (int a = 0; a < 3; a++)
        square += (info.bounds[1][a] - info.bounds[0][a]) * (info.bounds[1][a] - info.bounds[0][a]);
    const double longest = sqrt(square) * (l->turn->place[i].moved ? l->turn->place[i].grow : 1.0);
    return medium_homogeneous(&l->look, i, longest, v->file->layout.type != SAMPLE_F32,
                              e ? e->homogeneous : 0.0);
}

/* Set up shading of media. Shading needs the gradient in each node, so no node is taken whole. */
static void shade_media(scene_look *l) {
    const turn *t = l->turn;
    const leafcast_scene *scene = &t->scene;
    l->shade = medium_shade_of(scene);
    l->shade.steepness = l->steepness;
    for (int i = 0; i < t->volumes; i++) {
        const leafcast *v = t->shown[i].volume;
        leafcast_info info = {.cell_size = 1.0};
        double range[2];
        if (l->media[i].spans == 0)
            continue;
        const kind *k = t->tracers[i].kind;
        v->kind->describe(v, leaf_layout_step(&v->file->layout, v->set), &info);
        shown_range(l, i, range);
        if (t->place[i].moved)
            info.cell_size *= t->place[i].size;
        l->steepness[i] = medium_shade_steepness(scene->shade_fade, info.cell_size, range);
        l->look.overlaid |= k->walks->overlaps;
    }
    l->look.brightest *= l->shade.most;
    l->look.shade = &l->shade;
}

/* Set up the media that fill volumes. */
static status fill(scene_look *l) {
    turn *t = l->turn;
    const leafcast_scene *scene = &t->scene;
    status st = ST_OK;
    if (scene->bounces > 0 && any_surface(t, refraction_bends))
        return status_describe(ST_USAGE, "leafcast_surface.refraction: not with media, which bent "
                                         "rays would not see");
    t->f.integrator = &medium_integrator;
    l->look.media = l->media;
    l->look.range = (const double(*)[2])l->ranges;
    l->look.error = scene->error > 0.0 ? scene->error : 1.0 / 510.0;
    l->look.brightest = fmax(1.0, brightest_surface(l));
    for (int c = 0; c < 3; c++)
        l->look.brightest = fmax(l->look.brightest, fabs((double)scene->background[c]));
    l->look.filled = 0;
    for (int i = 0; i < t->volumes && st == ST_OK; i++) {
        st = fill_volume(l, i);
        if (l->media[i].spans > 0)
            l->look.filled_by[l->look.filled++] = (uint16_t)i;
    }
    const bool certified = !scene->experiments || scene->experiments->summing == LEAFCAST_CERTIFIED;
    if (st == ST_OK && !certified)
        return fill_for_steps(l);
    l->look.overlaid = l->look.filled > 1;
    if (st == ST_OK && scene->shade_media)
        shade_media(l);
    l->look.unbounded = turn_any_instead(t);
    t->f.record_more = medium_record_more(&l->look, scene->preview);
    for (int i = 0; i < t->volumes && st == ST_OK && l->look.filled == 1 && !l->look.shade; i++)
        if (l->media[i].spans > 0)
            t->beside[i].whole = homogeneous_of(l, i);
    return st;
}

/* Set a volume up for projection: its interest, and its part of the value range. */
static status project_volume(scene_look *l, int i) {
    turn *t = l->turn;
    leafcast_shown *s = &t->shown[i];
    const leafcast_scene *scene = &t->scene;
    const interest_interval above = {.lo = scene->project_value, .hi = (double)INFINITY};
    double range[2];
    if (s->volume->kind->given)
        return refuse_given(t, i, "there are no values along a ray to project");
    s->count = 0;
    t->beside[i] = scene->project == LEAFCAST_PROJECT_FIRST ? interest_of_intervals(&above, 1)
                                                            : interest_of_all();
    shown_range(l, i, range);
    l->projected.range[0] = fmin(l->projected.range[0], range[0]);
    l->projected.range[1] = fmax(l->projected.range[1], range[1]);
    return ST_OK;
}

static status project_scene(scene_look *l) {
    turn *t = l->turn;
    const leafcast_scene *scene = &t->scene;
    const bool coloured = scene->media_count > 0 && scene->media[0].count > 0;
    status st = coloured ? transfer_init(&l->media[0], t->f.m, &scene->media[0]) : ST_OK;
    l->projected = (projection_look){.project = scene->project,
                                     .value = scene->project_value,
                                     .colour = coloured ? &l->media[0] : NULL,
                                     .range = {(double)INFINITY, -(double)INFINITY}};
    memcpy(l->projected.background, scene->background, sizeof scene->background);
    t->f.integrator = &projection_integrator;
    t->f.look = &l->projected;
    for (int i = 0; i < t->volumes && st == ST_OK; i++)
        st = project_volume(l, i);
    /* Raise a threshold below all data to their least value: rays reach it where data begin, too.
     * So differences from the data lose no digits. */
    if (scene->project == LEAFCAST_PROJECT_FIRST && isfinite(l->projected.range[0]))
        l->projected.value = t->above = fmax(scene->project_value, l->projected.range[0]);
    return st;
}

/* Returns how many mirrored and refracted rays may follow each other. */
static int bounces_of(const turn *t) {
    return any_surface(t, mirrors) || any_surface(t, refraction_bends) ? t->scene.bounces : 0;
}

static bool is_soft(const turn *t) {
    const leafcast_scene *scene = &t->scene;
    bool soft = bounces_of(t) > 0 || scene->occlusion > 0.0;
    for (int i = 0; i < scene->light_count && scene->shadows; i++)
        soft |= scene->lights[i].radius > 0.0;
    return soft;
}

/* Make what has an element for each object. */
static status make_room(scene_look *l) {
    mem outside;
    const size_t objects = (size_t)l->turn->volumes;
    mem_init(&outside, 0);
    l->media = mem_array(&outside, objects, sizeof *l->media);
    l->colours = mem_array(&outside, objects, sizeof *l->colours);
    l->lookups = mem_array(&outside, objects, sizeof *l->lookups);
    l->ranges = mem_array(&outside, objects, sizeof *l->ranges);
    l->steepness = mem_array(&outside, objects, sizeof *l->steepness);
    return l->media && l->colours && l->lookups && l->ranges && l->steepness ? ST_OK : ST_NOMEM;
}

status scene_look_choose(scene_look *l, turn *t) {
    const leafcast_scene *scene = &t->scene;
    const bool clear = any_surface(t, is_clear);
    l->turn = t;
    status st = make_room(l);
    if (st != ST_OK)
        return st;
    l->look.surfaces =
        (surface_look){.scene = scene,
                       .surfaces = (const leafcast_surface(*)[LEAFCAST_SURFACES_MAX])t->surfaces,
                       .first_id = t->first_id,
                       .colours = l->colours,
                       .lookups = t->lookups > 0 ? l->lookups : NULL,
                       .opaque = !clear,
                       .clear = clear,
                       .soft = is_soft(t),
                       .bounces = bounces_of(t)};
    for (int v = 0; v < t->volumes && st == ST_OK; v++)
        if (t->shown[v].colours)
            st = transfer_init(&l->colours[v], t->f.m, t->shown[v].colours);
    for (int v = 0; v < t->volumes; v++)
        if (t->by[v] >= 0)
            l->lookups[v] = (surface_lookup){t->shown[t->by[v]].volume, (uint16_t)t->by[v]};
    if (st != ST_OK)
        return st;
    t->f.integrator = &surface_integrator;
    t->f.look = &l->look;
    if (scene->project != LEAFCAST_PROJECT_NONE)
        st = project_scene(l);
    else if (scene->media_count > 0)
        st = fill(l);
    if (scene->project == LEAFCAST_PROJECT_NONE)
        t->f.record_more += surface_ray_more(&l->look.surfaces);
    if (st == ST_OK && scene->caps && scene->cap_colours)
        st = transfer_init(&l->cap_colours, t->f.m, scene->cap_colours);
    return st;
}

void scene_look_release(scene_look *l, mem *m) {
    mem outside;
    mem_init(&outside, 0);
    for (int i = 0; l->media && i < l->turn->volumes; i++)
        transfer_release(&l->media[i], m);
    for (int i = 0; l->colours && i < l->turn->volumes; i++)
        transfer_release(&l->colours[i], m);
    mem_free(&outside, l->colours);
    mem_free(&outside, l->lookups);
    mem_free(&outside, l->media);
    mem_free(&outside, l->ranges);
    mem_free(&outside, l->steepness);
    transfer_release(&l->cap_colours, m);
    if (l->laboratory)
        l->laboratory->end_steps(m, l->stepped);
}
