#include "render/door/arguments.h"

#include <float.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/public_grid.h"
#include "formats/public_status.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/door/moving_arguments.h"
#include "render/experiments/preintegrated_table.h"
#include "render/leafcast_experimental.h"
#include "render/look/samples.h"
#include "render/look/scene_facts.h"
#include "render/ray/kind.h"
#include "render/ray/placement.h"

/* Limits within which sums of products of values and light do not overflow. */
#define MEDIUM_VALUE_MOST      1e300
#define MEDIUM_EXTINCTION_MOST 1e100

/* The most bytes of the caller's own, pixels of a slice, and values of a plane: none overflows. */
#define BYTES_MOST        0x1p60
#define SLICE_PIXELS_MOST 0x1p59
#define STRIDE_MOST       0x1p40
#define PLANE_MOST        0x1p58

/* ---- Devices and volumes ---- */

static const public_field experiments_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_experiments),
    PUBLIC_NUMBER(leafcast_experiments, treelet_limit, 0, UINT32_MAX, 0),
    PUBLIC_NUMBER(leafcast_experiments, packets, 2, 16, PUBLIC_OR_ZERO),
    PUBLIC_ENUM(leafcast_experiments, schema, LEAFCAST_SCHEMA_REFIT),
    PUBLIC_ENUM(leafcast_experiments, isopolygons, LEAFCAST_ISOPOLYGONS_CACHE),
};

static status experiments_together(const void *of) {
    const leafcast_experiments *e = of;
    if ((e->packets & (e->packets - 1)) == 0)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "leafcast_experiments.packets is %d: packets of 2, 4, 8 or 16 on a side "
                           "are possible",
                           e->packets);
}

static const public_fields experiments_table =
    PUBLIC_TABLE(leafcast_experiments, experiments_rows, .together = experiments_together);

static const public_field options_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_options),
    PUBLIC_NUMBER(leafcast_options, memory, 0, (double)UINT64_MAX, 0),
    PUBLIC_NUMBER(leafcast_options, threads, 0, LEAFCAST_THREADS_MAX, 0),
    PUBLIC_PLACE(leafcast_options, isa, PUBLIC_OR_NULL),
    PUBLIC_ANY(leafcast_options, run),
    PUBLIC_ANY(leafcast_options, host),
    PUBLIC_PLACE(leafcast_options, device, PUBLIC_OR_NULL),
    PUBLIC_ENUM(leafcast_options, backend, LEAFCAST_BACKEND_ARENA),
    {PUBLIC_MEMBER(leafcast_options, experiments), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .element = &experiments_table},
    PUBLIC_FLAG(leafcast_options, neighbours),
    PUBLIC_ENUM(leafcast_options, axes, LEAFCAST_AXES_RAS),
};

static status options_together(const void *of) {
    const leafcast_options *o = of;
    if (o->device && (o->memory || o->threads || o->isa || o->run))
        return status_describe(ST_USAGE, "leafcast_options.device has its own memory, threads, isa "
                                         "and run: these are for a new device");
    if (o->experiments && o->experiments->isopolygons && o->neighbours)
        return status_describe(ST_USAGE, "leafcast_options.neighbours: not beside isopolygons that "
                                         "are kept");
    return ST_OK;
}

static const public_fields options_table =
    PUBLIC_TABLE(leafcast_options, options_rows, .together = options_together);

/* ---- Scenes ---- */

static const public_field surface_rows[] = {
    PUBLIC_NUMBER(leafcast_surface, isovalue, -DBL_MAX, DBL_MAX, 0),
    PUBLIC_NUMBER(leafcast_surface, rgb, 0, LEAFCAST_COLOUR_MOST, 0),
    PUBLIC_NUMBER(leafcast_surface, opacity, 0, 1, PUBLIC_ABOVE),
    PUBLIC_NUMBER(leafcast_surface, reflectivity, 0, 1, 0),
    PUBLIC_NUMBER(leafcast_surface, refraction, 1 / LEAFCAST_REFRACTION_MOST,
                  LEAFCAST_REFRACTION_MOST, PUBLIC_OR_ZERO),
};
static const public_fields surface_table = PUBLIC_TABLE(leafcast_surface, surface_rows);

static const public_field light_rows[] = {
    PUBLIC_FLAG(leafcast_light, point),
    PUBLIC_NUMBER(leafcast_light, vector, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_light, rgb, 0, LEAFCAST_COLOUR_MOST, 0),
    PUBLIC_NUMBER(leafcast_light, radius, 0, LEAFCAST_PLACE_MOST, 0),
};

static double largest(const double v[3]) {
    return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

static status light_together(const void *of) {
    const leafcast_light *light = of;
    if (!light->point && light->radius > 90.0)
        return status_describe(ST_USAGE,
                               "leafcast_light.radius is %g: the half-angle of a light that is no "
                               "point is 0 to 90 degrees",
                               light->radius);
    if (light->point || largest(light->vector) >= LEAFCAST_DIRECTION_LEAST)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "leafcast_light.vector is no direction: its largest component must be "
                           "%g or more, up or down",
                           LEAFCAST_DIRECTION_LEAST);
}

static const public_fields light_table =
    PUBLIC_TABLE(leafcast_light, light_rows, .together = light_together);

static const public_field transfer_point_rows[] = {
    PUBLIC_NUMBER(leafcast_transfer_point, value, -MEDIUM_VALUE_MOST, MEDIUM_VALUE_MOST, 0),
    PUBLIC_NUMBER(leafcast_transfer_point, rgb, 0, (double)FLT_MAX, 0),
    PUBLIC_NUMBER(leafcast_transfer_point, extinction, 0, MEDIUM_EXTINCTION_MOST, 0),
};
static const public_fields transfer_point_table =
    PUBLIC_TABLE(leafcast_transfer_point, transfer_point_rows);

static const public_field medium_rows[] = {
    PUBLIC_NUMBER(leafcast_medium, count, 0, LEAFCAST_TRANSFER_POINTS_MAX, 0),
    {PUBLIC_MEMBER(leafcast_medium, points), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "count", .element = &transfer_point_table},
};

static status medium_together(const void *of) {
    const leafcast_medium *m = of;
    for (int i = 1; i < m->count; i++) {
        const double from = m->points[i - 1].value, to = m->points[i].value;
        if (to < from)
            return status_describe(ST_USAGE,
                                   "point %d of the transfer function has a smaller value than the "
                                   "one before",
                                   i + 1);
        if (to > from && to - from < LEAFCAST_TRANSFER_NARROWEST)
            return status_describe(ST_USAGE,
                                   "point %d of the transfer function: its value is neither that "
                                   "of the point before nor %g above it",
                                   i + 1, LEAFCAST_TRANSFER_NARROWEST);
    }
    return ST_OK;
}

static const public_fields medium_table =
    PUBLIC_TABLE(leafcast_medium, medium_rows, .together = medium_together);

#define PLACE_ROW(type_)                                                                         \
    {                                                                                            \
        PUBLIC_MEMBER(type_, place), .type = PUBLIC_POINTER, .values = 1, .how = PUBLIC_OR_NULL, \
                                     .number = &(const public_field) {                           \
            .type = PUBLIC_DOUBLE, .values = 12, .least = -LEAFCAST_PLACE_MOST,                  \
            .most = LEAFCAST_PLACE_MOST                                                          \
        }                                                                                        \
    }

static const public_field colouring_rows[] = {
    PUBLIC_PLACE(leafcast_colouring, volume, 0),
    PUBLIC_NUMBER(leafcast_colouring, field, 0, UINT32_MAX - 1, 0),
    PUBLIC_NUMBER(leafcast_colouring, step, 0, UINT32_MAX - 1, 0),
    PUBLIC_NUMBER(leafcast_colouring, between, 0, 1, PUBLIC_BELOW),
    PLACE_ROW(leafcast_colouring),
};

static status colouring_together(const void *of) {
    return placement_check(((const leafcast_colouring *)of)->place);
}

static const public_fields colouring_table =
    PUBLIC_TABLE(leafcast_colouring, colouring_rows, .together = colouring_together);

static const public_field shown_rows[] = {
    PUBLIC_PLACE(leafcast_shown, volume, 0),
    PUBLIC_NUMBER(leafcast_shown, field, 0, UINT32_MAX - 1, 0),
    PUBLIC_NUMBER(leafcast_shown, step, 0, UINT32_MAX - 1, 0),
    PUBLIC_NUMBER(leafcast_shown, count, 0, LEAFCAST_SURFACES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_shown, surfaces), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "count", .element = &surface_table},
    PUBLIC_NUMBER(leafcast_shown, between, 0, 1, PUBLIC_BELOW),
    {PUBLIC_MEMBER(leafcast_shown, colours), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .element = &medium_table},
    PLACE_ROW(leafcast_shown),
    {PUBLIC_MEMBER(leafcast_shown, colour_by), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .element = &colouring_table},
};

static status shown_together(const void *of) {
    const leafcast_shown *s = of;
    return placement_check(s->place);
}

static const public_fields shown_table =
    PUBLIC_TABLE(leafcast_shown, shown_rows, .together = shown_together);

static const public_field scene_experiments_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_scene_experiments),
    PUBLIC_ENUM(leafcast_scene_experiments, intersector, LEAFCAST_SCHWARZE),
    PUBLIC_NUMBER(leafcast_scene_experiments, homogeneous, 0, MEDIUM_VALUE_MOST, 0),
    PUBLIC_ENUM(leafcast_scene_experiments, summing, LEAFCAST_PREINTEGRATED),
    PUBLIC_NUMBER(leafcast_scene_experiments, step, LEAFCAST_STEP_LEAST, LEAFCAST_STEP_MOST,
                  PUBLIC_OR_ZERO),
    PUBLIC_NUMBER(leafcast_scene_experiments, opaque, 0, 1, 0),
    PUBLIC_NUMBER(leafcast_scene_experiments, table, PREINTEGRATED_SIDE_MIN, PREINTEGRATED_SIDE_MAX,
                  PUBLIC_OR_ZERO),
};

static status scene_experiments_together(const void *of) {
    const leafcast_scene_experiments *e = of;
    if (e->summing == LEAFCAST_CERTIFIED || e->step > 0.0)
        return ST_OK;
    return status_describe(ST_USAGE,
                           "leafcast_scene_experiments.step is 0: in steps, %g to %g cells are "
                           "possible",
                           LEAFCAST_STEP_LEAST, LEAFCAST_STEP_MOST);
}

static const public_fields scene_experiments_table = PUBLIC_TABLE(
    leafcast_scene_experiments, scene_experiments_rows, .together = scene_experiments_together);

static const public_field group_rows[] = {
    PUBLIC_PLACE(leafcast_group, places, PUBLIC_OR_NULL),
    PUBLIC_NUMBER(leafcast_group, volume_count, 0, LEAFCAST_VOLUMES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_group, volumes), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "volume_count", .element = &shown_table},
    PUBLIC_NUMBER(leafcast_group, group_count, 0, LEAFCAST_VOLUMES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_group, groups), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "group_count"},
};

static status group_together(const void *of) {
    const leafcast_group *g = of;
    if (g->volume_count + g->group_count > 0)
        return ST_OK;
    return status_describe(ST_USAGE, "leafcast_group: it has neither volumes nor groups");
}

static const public_fields group_table =
    PUBLIC_TABLE(leafcast_group, group_rows, .together = group_together);

static const public_field scene_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_scene),
    PUBLIC_NUMBER(leafcast_scene, volume_count, 0, LEAFCAST_VOLUMES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_scene, volumes), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "volume_count", .element = &shown_table},
    PUBLIC_NUMBER(leafcast_scene, group_count, 0, LEAFCAST_VOLUMES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_scene, groups), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "group_count"},
    PUBLIC_NUMBER(leafcast_scene, light_count, 0, LEAFCAST_LIGHTS_MAX, 0),
    {PUBLIC_MEMBER(leafcast_scene, lights), .type = PUBLIC_STRUCT, .values = 1,
     .counted_by = "light_count", .element = &light_table},
    PUBLIC_NUMBER(leafcast_scene, ambient, 0, 1, 0),
    PUBLIC_NUMBER(leafcast_scene, specular, 0, LEAFCAST_COLOUR_MOST, 0),
    PUBLIC_NUMBER(leafcast_scene, shininess, 0, LEAFCAST_SHININESS_MAX, 0),
    PUBLIC_ENUM(leafcast_scene, shading, LEAFCAST_SHADING_FLAT),
    PUBLIC_FLAG(leafcast_scene, shadows),
    PUBLIC_FLAG(leafcast_scene, analytic_normals),
    PUBLIC_FLAG(leafcast_scene, smooth_normals),
    PUBLIC_NUMBER(leafcast_scene, background, 0, LEAFCAST_COLOUR_MOST, 0),
    PUBLIC_FLAG(leafcast_scene, clip_box),
    PUBLIC_NUMBER(leafcast_scene, clip_min, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_scene, clip_max, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_scene, clip_plane_count, 0, LEAFCAST_CLIP_PLANES_MAX, 0),
    PUBLIC_NUMBERS_OF(leafcast_scene, clip_planes, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST,
                      "clip_plane_count"),
    PUBLIC_ENUM(leafcast_scene, lod, LEAFCAST_LOD_PIXEL),
    PUBLIC_NUMBER(leafcast_scene, lod_level, 0, LEAFCAST_LEVEL_MAX, 0),
    PUBLIC_FLAG(leafcast_scene, preview),
    PUBLIC_FLAG(leafcast_scene, allow_missing),
    PUBLIC_FLAG(leafcast_scene, sweep),
    PUBLIC_NUMBER(leafcast_scene, samples, 0, 16, 0),
    PUBLIC_NUMBER(leafcast_scene, layers_max, 0, INT_MAX, 0),
    {PUBLIC_MEMBER(leafcast_scene, experiments), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .element = &scene_experiments_table},
    PUBLIC_NUMBER(leafcast_scene, media_count, 0, LEAFCAST_VOLUMES_MAX, 0),
    {PUBLIC_MEMBER(leafcast_scene, media), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "media_count", .element = &medium_table},
    PUBLIC_NUMBER(leafcast_scene, error, 1e-9, 1, PUBLIC_OR_ZERO),
    PUBLIC_ENUM(leafcast_scene, project, LEAFCAST_PROJECT_FIRST),
    PUBLIC_NUMBER(leafcast_scene, project_value, -DBL_MAX, DBL_MAX, 0),
    PUBLIC_FLAG(leafcast_scene, caps),
    {PUBLIC_MEMBER(leafcast_scene, cap_colours), .type = PUBLIC_POINTER, .values = 1,
     .how = PUBLIC_OR_NULL, .element = &medium_table},
    PUBLIC_FLAG(leafcast_scene, shade_media),
    PUBLIC_NUMBER(leafcast_scene, shade_fade, 0, 1, 0),
    PUBLIC_NUMBER(leafcast_scene, light_samples, 0, LEAFCAST_LIGHT_SAMPLES_MAX, 0),
    PUBLIC_NUMBER(leafcast_scene, occlusion, 0, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_scene, occlusion_samples, 0, LEAFCAST_LIGHT_SAMPLES_MAX, 0),
    PUBLIC_NUMBER(leafcast_scene, bounces, 0, LEAFCAST_BOUNCES_MAX, 0),
};

static status scene_together(const void *of) {
    const leafcast_scene *s = of;
    const int volumes = s->volume_count > 0 || s->group_count > 0 ? s->volume_count : 1;
    if (s->media_count != 0 && s->media_count != volumes)
        return status_describe(ST_USAGE, "leafcast_scene.media_count is %d: there are %d volumes",
                               s->media_count, volumes);
    if (scene_filled(s) > LEAFCAST_MEDIA_MAX)
        return status_describe(ST_USAGE,
                               "leafcast_scene.media: %d objects are filled, and %d can be",
                               scene_filled(s), LEAFCAST_MEDIA_MAX);
    if (s->shade_media && s->experiments &&
        (s->experiments->summing != LEAFCAST_CERTIFIED || s->experiments->homogeneous > 0.0))
        return status_describe(ST_USAGE, "media are shaded cell by cell: not in steps, and no "
                                         "nodes taken whole");
    if (s->allow_missing && !s->preview &&
        (s->project == LEAFCAST_PROJECT_MAX || s->project == LEAFCAST_PROJECT_MIN))
        return status_describe(ST_USAGE, "a maximum or minimum with allow_missing: what is missing "
                                         "may hold it");
    if (s->allow_missing && !s->preview && s->caps)
        return status_describe(ST_USAGE, "caps with allow_missing: they show samples alone");
    if (!samples_valid(s->samples))
        return status_describe(ST_USAGE,
                               "leafcast_scene.samples is %d: 0, 1, 4 and 16 samples a pixel are "
                               "possible",
                               s->samples);
    if (s->shading == LEAFCAST_SHADING_PHONG && s->shininess == 0)
        return status_describe(ST_USAGE, "leafcast_scene.shininess is 0: a highlight needs 1 to %d",
                               LEAFCAST_SHININESS_MAX);
    return ST_OK;
}

static const public_fields scene_table =
    PUBLIC_TABLE(leafcast_scene, scene_rows, .together = scene_together);

/* ---- Pictures ---- */

static const public_field camera_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_camera),
    PUBLIC_NUMBER(leafcast_camera, eye, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_camera, look_at, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_camera, up, LEAFCAST_DIRECTION_LEAST, LEAFCAST_PLACE_MOST,
                  PUBLIC_DIRECTION),
    PUBLIC_NUMBER(leafcast_camera, fov, 0, 180, PUBLIC_BELOW),
    PUBLIC_NUMBER(leafcast_camera, width, 1, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_camera, height, 1, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_camera, ortho_height, 0, LEAFCAST_PLACE_MOST, 0),
};

/* Check what camera_init() checks, beside the ranges above. */
static status camera_together(const void *of) {
    camera c;
    return camera_init(&c, of);
}

static const public_fields camera_table =
    PUBLIC_TABLE(leafcast_camera, camera_rows, .together = camera_together);

static const public_field image_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_image),
    PUBLIC_PLACE(leafcast_image, r, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, g, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, b, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, a, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, z, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, normal, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, id, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, provisional, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, rgba8, PUBLIC_OR_NULL),
    PUBLIC_NUMBER(leafcast_image, x, 0, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_image, y, 0, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_image, width, 0, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_image, height, 0, CAMERA_PIXELS_MAX, 0),
    PUBLIC_NUMBER(leafcast_image, stride, 0, STRIDE_MOST, 0),
    PUBLIC_PLACE(leafcast_image, rgba, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, error, PUBLIC_OR_NULL),
    PUBLIC_PLACE(leafcast_image, value, PUBLIC_OR_NULL),
};

static status image_together(const void *of) {
    const leafcast_image *i = of;
    if (i->width == 0 ? i->x || i->y || i->height : i->height == 0)
        return status_describe(ST_USAGE, "a part of the picture with %u x %u pixels", i->width,
                               i->height);
    return ST_OK;
}

static const public_fields image_table =
    PUBLIC_TABLE(leafcast_image, image_rows, .together = image_together);

/* Check the part of the picture that is drawn, and its row stride. */
static status check_image(const leafcast_image *image, const leafcast_camera *from) {
    const status st = public_fields_check(&image_table, image);
    if (st != ST_OK)
        return st;
    if ((uint64_t)image->x + image->width > from->width ||
        (uint64_t)image->y + image->height > from->height)
        return status_describe(ST_USAGE, "%u x %u pixels from (%u, %u) on: the picture has %u x %u",
                               image->width, image->height, image->x, image->y, from->width,
                               from->height);
    const uint32_t width = image->width ? image->width : from->width;
    if (image->stride != 0 && image->stride < width)
        return status_describe(ST_USAGE, "leafcast_image.stride: rows of %u pixels every %zu",
                               width, image->stride);
    const uint32_t height = image->height ? image->height : from->height;
    if ((double)image->stride * height > PLANE_MOST)
        return status_describe(ST_USAGE, "leafcast_image.stride: %u rows every %zu", height,
                               image->stride);
    return ST_OK;
}

/* ---- Rays and slices ---- */

static const public_field ray_rows[] = {
    PUBLIC_NUMBER(leafcast_ray, origin, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_ray, direction, LEAFCAST_DIRECTION_LEAST, LEAFCAST_PLACE_MOST,
                  PUBLIC_DIRECTION),
    PUBLIC_NUMBER(leafcast_ray, t0, -DBL_MAX, DBL_MAX, 0),
    PUBLIC_NUMBER(leafcast_ray, t1, -DBL_MAX, (double)INFINITY, 0),
};

static status ray_together(const void *of) {
    const leafcast_ray *r = of;
    if (r->t0 <= r->t1)
        return ST_OK;
    return status_describe(ST_USAGE, "a leafcast_ray: no t from %g to %g", r->t0, r->t1);
}

static const public_fields ray_table =
    PUBLIC_TABLE(leafcast_ray, ray_rows, .together = ray_together);

static const public_field slice_rows[] = {
    PUBLIC_OWN_SIZE(leafcast_slice_pixels),
    PUBLIC_ENUM(leafcast_slice_pixels, interpolation, LEAFCAST_INTERPOLATION_NEAREST),
    PUBLIC_NUMBER(leafcast_slice_pixels, level, 0, LEAFCAST_LEVEL_MAX, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, origin, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, u, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, v, -LEAFCAST_PLACE_MOST, LEAFCAST_PLACE_MOST, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, line_count, 2, LEAFCAST_LINE_POINTS_MAX, PUBLIC_OR_ZERO),
    {PUBLIC_MEMBER(leafcast_slice_pixels, line), .type = PUBLIC_POINTER, .values = 1,
     .counted_by = "line_count",
     .number = &(const public_field){.type = PUBLIC_DOUBLE,
                                     .values = 3,
                                     .least = -LEAFCAST_PLACE_MOST,
                                     .most = LEAFCAST_PLACE_MOST}},
    PUBLIC_NUMBER(leafcast_slice_pixels, width, 1, UINT32_MAX, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, height, 1, UINT32_MAX, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, beside, 0, BYTES_MOST, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, first_row, 0, UINT32_MAX, 0),
    PUBLIC_NUMBER(leafcast_slice_pixels, rows, 0, UINT32_MAX, 0),
};

static status slice_together(const void *of) {
    const leafcast_slice_pixels *s = of;
    if ((double)s->width * s->height > SLICE_PIXELS_MOST)
        return status_describe(ST_USAGE, "a slice of %u x %u pixels", s->width, s->height);
    if (s->first_row > s->height || s->rows > s->height - s->first_row ||
        (s->rows == 0 && s->first_row > 0))
        return status_describe(ST_USAGE, "%u rows from row %u on, of a slice of %u", s->rows,
                               s->first_row, s->height);
    if (s->line && s->line_count == 0)
        return status_describe(ST_USAGE, "leafcast_slice_pixels.line: a line of 0 points");
    return ST_OK;
}

static const public_fields slice_table =
    PUBLIC_TABLE(leafcast_slice_pixels, slice_rows, .together = slice_together);

/* ---- What the library fills ---- */

static const public_fields info_table = PUBLIC_WRITTEN(leafcast_info),
                           block_table = PUBLIC_WRITTEN(leafcast_block),
                           holding_table = PUBLIC_WRITTEN(leafcast_holding),
                           histogram_table = PUBLIC_WRITTEN(leafcast_histogram),
                           stats_table = PUBLIC_WRITTEN(leafcast_stats),
                           hit_table = PUBLIC_WRITTEN(leafcast_hit),
                           segment_table = PUBLIC_WRITTEN(leafcast_segment),
                           ray_hit_table = PUBLIC_WRITTEN(leafcast_ray_hit),
                           cell_table = PUBLIC_WRITTEN(leafcast_cell),
                           sample_table = PUBLIC_WRITTEN(leafcast_sample);

const public_fields *const *arguments_tables(int *count) {
    static const public_fields *const tables[] = {&public_grid_table,
                                                  &options_table,
                                                  &info_table,
                                                  &surface_table,
                                                  &block_table,
                                                  &holding_table,
                                                  &light_table,
                                                  &medium_table,
                                                  &colouring_table,
                                                  &shown_table,
                                                  &group_table,
                                                  &scene_table,
                                                  &camera_table,
                                                  &histogram_table,
                                                  &image_table,
                                                  &stats_table,
                                                  &hit_table,
                                                  &segment_table,
                                                  &ray_table,
                                                  &ray_hit_table,
                                                  &cell_table,
                                                  &sample_table,
                                                  &slice_table,
                                                  &moving_arguments_table,
                                                  &experiments_table,
                                                  &transfer_point_table,
                                                  &scene_experiments_table};
    *count = (int)(sizeof tables / sizeof *tables);
    return tables;
}

/* ---- Checking ---- */

status arguments_check_device(const char *call, const leafcast_device *d) {
    if (!d)
        return status_describe(ST_USAGE, "%s(): the device is NULL", call);
    if (device_is_here(d))
        return ST_OK;
    return status_describe(ST_USAGE,
                           "%s(): the device was made before fork(), by another process: its "
                           "threads are not in this one, which has to make a device of its own",
                           call);
}

status arguments_check_volume(const char *call, const leafcast *v) {
    if (!v)
        return status_describe(ST_USAGE, "%s(): the volume is NULL", call);
    return arguments_check_device(call, v->device);
}

status arguments_check_values(const char *call, const leafcast *v) {
    const status st = arguments_check_volume(call, v);
    if (st != ST_OK || !v->kind->given)
        return st;
    return status_describe(ST_USAGE, "\"%s\" is a surface, of %s: it has no values beside it",
                           leafcast_describe(v).name, v->kind->name);
}

status arguments_check_points(const char *call, const leafcast *v) {
    const status st = arguments_check_volume(call, v);
    return st != ST_OK || v->kind->draped ? st : arguments_check_values(call, v);
}

status arguments_check_options(const leafcast_options *o) {
    return public_fields_check(&options_table, o);
}

status arguments_check_surfaces(const leafcast_surface *surfaces, int count) {
    if (count < 1 || count > LEAFCAST_SURFACES_MAX)
        return status_describe(ST_USAGE, "%d isosurfaces: 1 to %d can be drawn at once", count,
                               LEAFCAST_SURFACES_MAX);
    if (!surfaces)
        return status_describe(ST_USAGE, "surfaces is NULL, and there are %d of them", count);
    return public_fields_check_all(&surface_table, surfaces, (size_t)count);
}

status arguments_check_scene(const leafcast_scene *s) {
    return public_fields_check(&scene_table, s);
}

status arguments_check_group(const leafcast_group *group) {
    return public_fields_check(&group_table, group);
}

status arguments_check_camera(const leafcast_camera *from) {
    return public_fields_check(&camera_table, from);
}

status arguments_begin_view(const char *call, leafcast_camera *view, uint32_t width,
                            uint32_t height) {
    status st = public_needs(call, "camera", (const void *[]){view});
    if (st == ST_OK)
        st = public_size("leafcast_camera", view->size, sizeof *view);
    if (st != ST_OK)
        return st;
    *view = (leafcast_camera){.size = sizeof *view};
    st = public_in_range(call, "width", width, 1, CAMERA_PIXELS_MAX);
    if (st == ST_OK)
        st = public_in_range(call, "height", height, 1, CAMERA_PIXELS_MAX / (double)width);
    return st;
}

status arguments_check_slice(const leafcast_slice_pixels *slice) {
    return public_fields_check(&slice_table, slice);
}

status arguments_check_stats(const leafcast_stats *stats) {
    return stats ? public_fields_check(&stats_table, stats) : ST_OK;
}

status arguments_check_info(const leafcast_info *info) {
    return public_fields_check(&info_table, info);
}

status arguments_check_cell(const leafcast_cell *cell) {
    return public_fields_check(&cell_table, cell);
}

/* Fast form of ray_rows and ray_together(). A NaN fails: no comparison with it is true. */
static bool is_fine(const leafcast_ray *r) {
    bool fine = r->t0 <= r->t1 && r->t0 >= -DBL_MAX && r->t0 <= DBL_MAX;
    for (int a = 0; a < 3; a++)
        fine = fine && fabs(r->origin[a]) <= LEAFCAST_PLACE_MOST &&
               fabs(r->direction[a]) <= LEAFCAST_PLACE_MOST;
    return fine && largest(r->direction) >= LEAFCAST_DIRECTION_LEAST;
}

status arguments_check_rays(const leafcast_ray *rays, size_t count) {
    size_t i = 0;
    while (i < count && is_fine(&rays[i]))
        i++;
    if (i == count)
        return ST_OK;
    char text[STATUS_TEXT_MAX / 2];
    const status st = public_fields_check(&ray_table, &rays[i]);
    snprintf(text, sizeof text, "%s", status_text());
    return st == ST_OK ? st : status_describe(st, "ray %zu: %s", i, text);
}

status arguments_check_ray(const double origin[3], const double direction[3]) {
    leafcast_ray r = {.t1 = (double)INFINITY};
    memcpy(r.origin, origin, sizeof r.origin);
    memcpy(r.direction, direction, sizeof r.direction);
    return public_fields_check(&ray_table, &r);
}

status arguments_check_picture(const leafcast_scene *scene, const leafcast_camera *from,
                               const leafcast_image *image, const leafcast_stats *stats) {
    status st = arguments_check_scene(scene);
    if (st == ST_OK)
        st = arguments_check_camera(from);
    if (st == ST_OK)
        st = check_image(image, from);
    if (st == ST_OK && scene->samples > 1 && (image->rgba || image->error || image->value))
        st = status_describe(ST_USAGE, "planes of exact colours, errors and values are of one "
                                       "sample a pixel");
    return st == ST_OK ? arguments_check_stats(stats) : st;
}
