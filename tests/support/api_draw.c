#include "tests/support/api_draw.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/public_calls.h"

bool api_chance(field_random *r, long n) {
    return field_random_below(r, n) == 0;
}

static double odd_number(field_random *r) {
    static const double odd[] = {0.0,    -0.0,    1.0,    -1.0,    NAN,   INFINITY, -INFINITY,
                                 1e-100, 1e100,   1e-101, -1e101,  1e300, -1e300,   DBL_MAX,
                                 5e-324, -5e-324, 1e-9,   DBL_MIN, 1e30,  -1e30,    1e9,
                                 180.0,  0x1p31,  0x1p32, 0x1p53,  1e-30, 1e-290};
    return odd[field_random_below(r, sizeof odd / sizeof *odd)];
}

double api_number(field_random *r, double x) {
    return api_chance(r, 40) ? odd_number(r) : x;
}

static int below(field_random *r, long n) {
    return (int)field_random_below(r, n);
}

/* ---- One field wrong, or at the end of its range ---- */

/* Counts and sizes of arrays, which the drawing itself sets. */
static bool is_left_alone(const char *name) {
    static const char *const names[] = {"count",     "volume_count", "media_count",   "line_count",
                                        "width",     "height",       "stride",        "x",
                                        "y",         "rows",         "first_row",     "dims",
                                        "memory",    "threads",      "coarse_dims",   "field_count",
                                        "tet_count", "vertex_count", "treelet_limit", "samples"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(names[i], name) == 0)
            return true;
    return false;
}

static double end_of(const public_field *row, field_random *r) {
    switch (below(r, 7)) {
    case 0: return row->least;
    case 1: return row->most;
    case 2: return row->least - 1.0;
    case 3: return row->most + 1.0;
    case 4: return nextafter(row->most, INFINITY);
    case 5: return nextafter(row->least, -INFINITY);
    default: return odd_number(r);
    }
}

static void put(const public_field *row, field_random *r, char *at) {
    const uint64_t bits = field_random_bits(r);
    const double x = end_of(row, r);
    const bool whole = x >= INT_MIN && x <= INT_MAX;
    const int n = whole ? (int)x : (int)bits;
    const float f = (float)x;
    switch (row->type) {
    case PUBLIC_BOOL: *at = (char)(bits % 3); return;
    case PUBLIC_INT:
    case PUBLIC_UINT32: memcpy(at, &n, sizeof n); return;
    case PUBLIC_SIZE:
    case PUBLIC_UINT64: memcpy(at, &bits, sizeof bits); return;
    case PUBLIC_FLOAT: memcpy(at, &f, sizeof f); return;
    case PUBLIC_DOUBLE: memcpy(at, &x, sizeof x); return;
    case PUBLIC_POINTER: *(void **)at = NULL; return;
    default: return;
    }
}

/* Once in n. */
static void spoil(field_random *r, long n, const char *table_name, void *of) {
    if (!api_chance(r, n))
        return;
    const public_fields *table = public_calls_table(table_name);
    const public_field *row = &table->rows[below(r, table->count)];
    if (!is_left_alone(row->name))
        put(row, r,
            (char *)of + row->offset +
                (size_t)below(r, row->values) * public_fields_width(row->type));
}

/* ---- Scenes ---- */

static double isovalue(field_random *r, const leafcast_info *info) {
    const double share = field_random_in(r, -0.1, 1.1);
    return api_number(r, info->value_min + share * (info->value_max - info->value_min));
}

void api_draw_surfaces(field_random *r, const leafcast *v,
                       leafcast_surface surfaces[LEAFCAST_SURFACES_MAX], int *count) {
    const leafcast_info info = leafcast_describe(v);
    *count = api_chance(r, 20) ? below(r, 200) - 100 : 1 + below(r, 3);
    for (int i = 0; i < LEAFCAST_SURFACES_MAX && i < *count; i++) {
        surfaces[i] = leafcast_surface_default(isovalue(r, &info));
        if (api_chance(r, 2))
            surfaces[i].opacity = (float)field_random_in(r, 0.01, 1.0);
        if (api_chance(r, 6))
            surfaces[i].reflectivity = (float)field_random_unit(r);
        if (api_chance(r, 8))
            surfaces[i].refraction = (float)field_random_in(r, 0.25, 4.0);
        spoil(r, 60, "leafcast_surface", &surfaces[i]);
    }
}

static void draw_medium(field_random *r, const leafcast_info *info, leafcast_medium *m,
                        leafcast_transfer_point points[API_POINTS]) {
    double value = info->value_min;
    *m = (leafcast_medium){points, api_chance(r, 4) ? 0 : 2 + below(r, API_POINTS - 1)};
    if (api_chance(r, 60))
        m->count = api_chance(r, 2) ? -1 - below(r, INT_MAX) : 4097 + below(r, 100000);
    for (int i = 0; i < API_POINTS; i++) {
        points[i] = (leafcast_transfer_point){.value = value};
        points[i].extinction = api_chance(r, 2) ? 0.0 : field_random_in(r, 0.0, 10.0);
        for (int c = 0; c < 3; c++)
            points[i].rgb[c] = (float)field_random_unit(r);
        if (!api_chance(r, 6))
            value += field_random_unit(r) * (info->value_max - info->value_min) / 3.0;
        spoil(r, 150, "leafcast_transfer_point", &points[i]);
    }
}

static void draw_light(field_random *r, const leafcast *v, leafcast_light *light) {
    *light = (leafcast_light){.point = api_chance(r, 2), .rgb = {1, 0.5, 0.25}};
    if (light->point)
        api_draw_place(r, v, light->vector);
    else
        api_draw_direction(r, light->vector);
    if (api_chance(r, 4))
        light->radius = api_number(r, field_random_in(r, 0.0, 20.0));
    spoil(r, 60, "leafcast_light", light);
}

/* So few that pictures do not take long. */
static void draw_soft(field_random *r, leafcast_scene *scene) {
    scene->light_samples = 1 + below(r, 3);
    scene->occlusion = api_chance(r, 4) ? api_number(r, field_random_in(r, 0.0, 30.0)) : 0.0;
    scene->occlusion_samples = 1 + below(r, 3);
    scene->bounces = api_chance(r, 3) ? below(r, 3) : 0;
}

static int at_most(int n, int most, int allowed) {
    return n > most && n <= allowed ? most : n;
}

static void draw_clips(field_random *r, const leafcast *v, leafcast_scene *scene) {
    scene->clip_box = api_chance(r, 6);
    api_draw_place(r, v, scene->clip_min);
    api_draw_place(r, v, scene->clip_max);
    scene->clip_plane_count = api_chance(r, 3) ? below(r, 3) : 0;
    if (api_chance(r, 100))
        scene->clip_plane_count = (int)field_random_bits(r);
    for (int i = 0; i < LEAFCAST_CLIP_PLANES_MAX && i < scene->clip_plane_count; i++) {
        api_draw_direction(r, scene->clip_planes[i]);
        scene->clip_planes[i][3] = api_number(r, field_random_in(r, -4.0, 4.0));
    }
}

/* Colours of the i-th object, of its own or another volume's values. */
static void draw_colours(field_random *r, leafcast *const volumes[], int count, int i,
                         api_scene *s) {
    leafcast *const by = volumes[below(r, count)];
    const leafcast_info info = leafcast_describe(by);
    draw_medium(r, &info, &s->shown_colours[i], s->points[API_ROOM + 1 + i]);
    s->shown[i].colours = &s->shown_colours[i];
    if (api_chance(r, 2))
        return;
    s->by[i] = (leafcast_colouring){.volume = by,
                                    .field = (uint32_t)below(r, info.fields),
                                    .step = (uint32_t)below(r, info.steps)};
    for (int k = 0; k < i; k++) /* mostly as it is listed */
        if (s->shown[k].volume == by) {
            s->by[i].field = s->shown[k].field;
            s->by[i].step = s->shown[k].step;
            s->by[i].between = s->shown[k].between;
        }
    spoil(r, 100, "leafcast_colouring", &s->by[i]);
    s->shown[i].colour_by = &s->by[i];
}

static void draw_volumes(field_random *r, leafcast *const volumes[], int count, api_scene *s) {
    const int listed = api_chance(r, 2) ? 0 : 1 + below(r, count);
    for (int i = 0; i < listed; i++) {
        leafcast_shown *shown = &s->shown[i];
        *shown = (leafcast_shown){.volume = volumes[i], .surfaces = s->surfaces[i]};
        const leafcast_info info = leafcast_describe(volumes[i]);
        shown->field = (uint32_t)below(r, info.fields + api_chance(r, 30));
        shown->step = (uint32_t)below(r, info.steps + api_chance(r, 30));
        shown->between = api_chance(r, 3) && shown->step + 1 < info.steps &&
                                 (info.dims[0] > 0 || strcmp(info.cell, "tet") == 0)
                             ? field_random_unit(r)
                             : 0.0;
        api_draw_surfaces(r, volumes[i], s->surfaces[i], &shown->count);
        if (api_chance(r, 3))
            draw_colours(r, volumes, count, i, s);
        spoil(r, 100, "leafcast_shown", shown);
    }
    s->scene.volumes = s->shown;
    s->scene.volume_count = listed;
    if (api_chance(r, 100))
        s->scene.volume_count =
            api_chance(r, 2) ? LEAFCAST_VOLUMES_MAX + 1 + below(r, 1000) : -1 - below(r, INT_MAX);
}

static void draw_media(field_random *r, leafcast *const volumes[], int count, api_scene *s) {
    const int media = s->scene.volume_count > 0 ? s->scene.volume_count : 1;
    if (api_chance(r, 2))
        s->scene.media_count = api_chance(r, 30) ? below(r, 40) - 10 : media;
    s->scene.media = s->media;
    for (int i = 0; i < API_ROOM && i < s->scene.media_count; i++) {
        const leafcast_info info = leafcast_describe(volumes[i < count ? i : 0]);
        draw_medium(r, &info, &s->media[i], s->points[i]);
    }
    if (api_chance(r, 4)) {
        const leafcast_info info = leafcast_describe(volumes[0]);
        draw_medium(r, &info, &s->colours, s->points[API_ROOM]);
        s->scene.cap_colours = &s->colours;
    }
}

static void draw_experiments(field_random *r, api_scene *s) {
    if (!api_chance(r, 8))
        return;
    s->experiments = (leafcast_scene_experiments){.size = sizeof s->experiments};
    s->experiments.intersector = (leafcast_intersector)(api_chance(r, 2) ? below(r, 6) : 0);
    s->experiments.homogeneous = api_chance(r, 3) ? field_random_unit(r) : 0.0;
    s->experiments.summing = (leafcast_summing)(api_chance(r, 3) ? below(r, 3) : 0);
    s->experiments.step = field_random_in(r, 0.1, 2.0);
    s->experiments.table = 16;
    spoil(r, 10, "leafcast_scene_experiments", &s->experiments);
    if (s->experiments.step < 0.05) /* LEAFCAST_STEP_LEAST takes its time, as it says */
        s->experiments.step = 0.05;
    if (s->experiments.table > 32 && s->experiments.table <= 2048)
        s->experiments.table = 32;
    s->scene.experiments = &s->experiments;
}

static void draw_switches(field_random *r, const leafcast_info *info, leafcast_scene *scene) {
    scene->shading = (leafcast_shading)below(r, 3);
    scene->shadows = api_chance(r, 2);
    scene->analytic_normals = api_chance(r, 3);
    scene->smooth_normals = info->gradients && api_chance(r, 3);
    scene->lod = (leafcast_lod)(api_chance(r, 3) ? below(r, 3) : 0);
    scene->lod_level = (uint32_t)below(r, 4);
    scene->preview = api_chance(r, 3);
    scene->sweep = api_chance(r, 6);
    scene->samples = api_chance(r, 10) ? below(r, 6) : 0;
    scene->layers_max = api_chance(r, 3) ? below(r, 4) : 0;
    scene->error = api_chance(r, 3) ? field_random_in(r, 1e-4, 0.1) : 0.0;
    scene->project = (leafcast_project)(api_chance(r, 4) ? below(r, 5) : 0);
    scene->project_value = isovalue(r, info);
    scene->caps = api_chance(r, 6);
    scene->shade_media = api_chance(r, 4);
    scene->shade_fade = api_chance(r, 2) ? 0.0 : field_random_unit(r);
}

void api_draw_scene(field_random *r, leafcast *const volumes[], int count, api_scene *s) {
    const leafcast_info info = leafcast_describe(volumes[0]);
    s->scene = leafcast_scene_default();
    draw_volumes(r, volumes, count, s);
    draw_switches(r, &info, &s->scene);
    draw_clips(r, volumes[0], &s->scene);
    draw_media(r, volumes, count, s);
    draw_experiments(r, s);
    s->scene.light_count = api_chance(r, 2) ? below(r, 3) : 0;
    for (int i = 0; i < s->scene.light_count; i++)
        draw_light(r, volumes[0], &s->scene.lights[i]);
    draw_soft(r, &s->scene);
    spoil(r, 6, "leafcast_scene", &s->scene);
    s->scene.light_count = at_most(s->scene.light_count, 2, LEAFCAST_LIGHTS_MAX);
    s->scene.light_samples = at_most(s->scene.light_samples, 3, LEAFCAST_LIGHT_SAMPLES_MAX);
    s->scene.occlusion_samples = at_most(s->scene.occlusion_samples, 3, LEAFCAST_LIGHT_SAMPLES_MAX);
    s->scene.bounces = at_most(s->scene.bounces, 2, LEAFCAST_BOUNCES_MAX);
    if (s->scene.error > 0.0 && s->scene.error < 1e-6) /* takes long, as it may */
        s->scene.error = 1e-6;
}

/* ---- Pictures ---- */

void api_draw_place(field_random *r, const leafcast *v, double point[3]) {
    const leafcast_info info = leafcast_describe(v);
    for (int a = 0; a < 3; a++) {
        const double share = api_chance(r, 4) ? below(r, 3) * 0.5 : field_random_in(r, -0.2, 1.2);
        point[a] =
            api_number(r, info.bounds[0][a] + share * (info.bounds[1][a] - info.bounds[0][a]));
    }
}

void api_draw_direction(field_random *r, double direction[3]) {
    for (int a = 0; a < 3; a++)
        direction[a] =
            api_number(r, api_chance(r, 4) ? below(r, 3) - 1.0 : field_random_in(r, -1.0, 1.0));
}

void api_draw_ray(field_random *r, const leafcast *v, leafcast_ray *ray) {
    *ray = (leafcast_ray){.t0 = api_number(r, 0.0), .t1 = api_number(r, INFINITY)};
    api_draw_place(r, v, ray->origin);
    api_draw_direction(r, ray->direction);
}

static uint32_t side(field_random *r) {
    static const uint32_t odd[] = {0, 0x80000000, UINT32_MAX, INT32_MAX};
    return api_chance(r, 60) ? odd[below(r, 4)] : 1 + (uint32_t)below(r, API_SIDE);
}

void api_draw_camera(field_random *r, const leafcast *v, leafcast_camera *c) {
    *c = leafcast_standard_view(v, field_random_in(r, 0.1, 3.0), API_SIDE, API_SIDE);
    if (api_chance(r, 3))
        api_draw_place(r, v, c->eye);
    if (api_chance(r, 6))
        api_draw_direction(r, c->up);
    if (api_chance(r, 5))
        c->ortho_height = api_number(r, field_random_in(r, 0.1, 20.0));
    c->width = side(r);
    c->height = side(r);
    if ((uint64_t)c->width * c->height > API_SIDE * API_SIDE &&
        (uint64_t)c->width * c->height <= INT32_MAX)
        c->width = c->height = 1; /* else it would be drawn */
    spoil(r, 15, "leafcast_camera", c);
}

static void *plane(field_random *r, long n, size_t bytes) {
    return api_chance(r, n) ? calloc(1, bytes ? bytes : 1) : NULL;
}

void api_draw_image(field_random *r, const leafcast_camera *c, leafcast_image *i) {
    *i = (leafcast_image){.size = sizeof *i};
    if (api_chance(r, 4)) {
        i->x = (uint32_t)below(r, 4);
        i->y = (uint32_t)below(r, 4);
        i->width = side(r);
        i->height = side(r);
    }
    i->stride = api_chance(r, 4) ? (size_t)below(r, 20) : 0;
    if (api_chance(r, 80))
        i->stride = (size_t)field_random_bits(r);
    /* As large as a picture of it needs; one that is refused needs none. */
    const uint64_t width = i->width ? i->width : c->width,
                   height = i->height ? i->height : c->height;
    const uint64_t row = i->stride ? i->stride : width;
    const bool fits = width <= API_SIDE && height <= API_SIDE && row <= 32;
    const size_t values = fits ? (size_t)(height ? (height - 1) * row + width : 0) : 0;
    if (!fits)
        return; /* without planes; rows that far apart are no matter then */
    i->r = plane(r, 2, values * sizeof(float));
    i->g = plane(r, 2, values * sizeof(float));
    i->b = plane(r, 2, values * sizeof(float));
    i->a = plane(r, 2, values * sizeof(float));
    i->z = plane(r, 2, values * sizeof(double));
    for (int a = 0; a < 3; a++)
        i->normal[a] = plane(r, 3, values * sizeof(float));
    i->id = plane(r, 3, values * sizeof(int32_t));
    i->provisional = plane(r, 3, values);
    i->rgba8 = plane(r, 4, 4 * values);
    i->rgba = plane(r, 4, 4 * values * sizeof(double));
    i->error = plane(r, 4, values * sizeof(double));
    i->value = plane(r, 4, values * sizeof(double));
}

void api_free_image(leafcast_image *i) {
    void *const planes[] = {i->r,         i->g,         i->b,         i->a,    i->z,
                            i->normal[0], i->normal[1], i->normal[2], i->id,   i->provisional,
                            i->rgba8,     i->rgba,      i->error,     i->value};
    for (size_t k = 0; k < sizeof planes / sizeof *planes; k++)
        free(planes[k]);
    *i = (leafcast_image){0};
}

/* ---- Slices ---- */

void api_draw_slice(field_random *r, const leafcast *v, double line[API_LINE][3],
                    leafcast_slice_pixels *s) {
    *s = (leafcast_slice_pixels){.size = sizeof *s, .width = side(r), .height = side(r)};
    s->interpolation = (leafcast_interpolation)below(r, 2);
    s->level = (uint32_t)(api_chance(r, 4) ? below(r, 3) : 0);
    api_draw_place(r, v, s->origin);
    api_draw_direction(r, s->u);
    api_draw_direction(r, s->v);
    if (api_chance(r, 3)) {
        s->line = (const double(*)[3])line;
        s->line_count = (uint32_t)below(r, API_LINE + 1);
        for (int i = 0; i < API_LINE; i++)
            api_draw_place(r, v, line[i]);
        if (api_chance(r, 50))
            s->line_count = UINT32_MAX - (uint32_t)below(r, 100);
    }
    if (api_chance(r, 6)) {
        s->first_row = (uint32_t)below(r, 6);
        s->rows = (uint32_t)below(r, 6);
    }
    spoil(r, 12, "leafcast_slice_pixels", s);
    if (s->width > API_SIDE || s->height > API_SIDE) /* would be sampled, into no room */
        s->width = 0;
}

/* ---- Options ---- */

void api_draw_options(field_random *r, leafcast_device *device, leafcast_experiments *e,
                      leafcast_options *o) {
    static const uint64_t budgets[] = {0, 0, 0, 1, 4096, 1 << 19, 1 << 20, 3 << 20, UINT64_MAX};
    *o = (leafcast_options){.size = sizeof *o, .neighbours = api_chance(r, 3)};
    o->device = device;
    if (!device || api_chance(r, 30)) {
        o->memory = budgets[below(r, sizeof budgets / sizeof *budgets)];
        o->threads = api_chance(r, 40) ? below(r, 3000) - 1000 : 1 + api_chance(r, 5);
        if (o->threads > 4 && o->threads <= LEAFCAST_THREADS_MAX)
            o->threads = 4;
        o->isa = api_chance(r, 4) ? "scalar" : api_chance(r, 40) ? "no such" : NULL;
    }
    o->backend = (leafcast_backend)below(r, 3);
    if (api_chance(r, 4)) {
        *e = (leafcast_experiments){.size = sizeof *e};
        e->treelet_limit = (uint32_t)(api_chance(r, 2) ? below(r, 3) : 0);
        e->packets = api_chance(r, 2) ? below(r, 18) : 0;
        e->schema = (leafcast_schema)below(r, 3);
        e->isopolygons = (leafcast_isopolygons)below(r, 3);
        spoil(r, 20, "leafcast_experiments", e);
        o->experiments = e;
    }
    spoil(r, 20, "leafcast_options", o);
}

void api_draw_convert_options(field_random *r, leafcast_convert_options *o) {
    *o = (leafcast_convert_options){.size = sizeof *o, .threads = 1, .replace = true};
    o->zstd_level = api_chance(r, 3) ? 1 : 0;
    o->treelet_cells = 16;
    o->without_halo = api_chance(r, 4);
    o->without_levels = api_chance(r, 4);
    o->has_missing = api_chance(r, 6);
    o->missing = api_number(r, 1.0);
    o->gradients = api_chance(r, 3);
    o->coarse = api_chance(r, 3);
    o->whole_cells = api_chance(r, 4);
    o->by_corners = api_chance(r, 4);
    o->normals = (leafcast_surface_normals)below(r, 3);
    o->coarse_dims = (uint32_t)(api_chance(r, 2) ? below(r, 8) : 0);
    o->allow_empty = api_chance(r, 2);
    spoil(r, 8, "leafcast_convert_options", o);
}

void api_draw_grid(field_random *r, leafcast_grid *g) {
    *g = (leafcast_grid){.size = sizeof *g};
    for (int a = 0; a < 3; a++) {
        g->dims[a] = (uint32_t)(api_chance(r, 60) ? field_random_bits(r) | 0x100000 : 0);
        g->dims[a] = g->dims[a] ? g->dims[a] + 1 : 2 + (uint32_t)below(r, 5);
        g->spacing[a] = api_number(r, api_chance(r, 2) ? 0.0 : field_random_in(r, -2.0, 2.0));
        g->origin[a] = api_number(r, field_random_in(r, -2.0, 2.0));
    }
    g->type = (leafcast_sample_type)(1 + below(r, 8));
    spoil(r, 10, "leafcast_grid", g);
}
