#include "render/arguments.h"

#include <math.h>

#include "formats/public_status.h"
#include "render/leafcast_experimental.h"
#include "render/preintegrated_table.h"
#include "render/samples.h"

/* One of an enumeration's values, which are 0 .. last. An enum may be signed or not. */
static status one_of(const char *name, long long value, int last) {
    if (value >= 0 && value <= last)
        return ST_OK;
    return status_describe(ST_USAGE, "%s is %lld: 0 to %d are possible", name, value, last);
}

static status check_experiments(const leafcast_experiments *e) {
    status st = public_size("leafcast_experiments", e->size, sizeof *e);
    if (st == ST_OK)
        st = one_of("leafcast_experiments.schema", (long long)e->schema, LEAFCAST_SCHEMA_REFIT);
    if (st == ST_OK)
        st = one_of("leafcast_experiments.isopolygons", (long long)e->isopolygons,
                    LEAFCAST_ISOPOLYGONS_CACHE);
    return st;
}

status arguments_check_options(const leafcast_options *o) {
    status st = public_size("leafcast_options", o->size, sizeof *o);
    if (st == ST_OK && o->device && (o->memory || o->threads || o->isa || o->run))
        st = status_describe(ST_USAGE, "leafcast_options.device has its own memory, threads, isa "
                                       "and run: these are for a new device");
    if (st == ST_OK)
        st = one_of("leafcast_options.backend", (long long)o->backend, LEAFCAST_BACKEND_ARENA);
    if (st == ST_OK && o->experiments)
        st = check_experiments(o->experiments);
    if (st == ST_OK && o->experiments && o->experiments->isopolygons && o->neighbours)
        st = status_describe(ST_USAGE, "leafcast_options.neighbours: not beside isopolygons that "
                                       "are kept");
    return st;
}

status arguments_check_surfaces(const leafcast_surface *surfaces, int count) {
    if (count < 1 || count > LEAFCAST_SURFACES_MAX)
        return status_describe(ST_USAGE, "%d isosurfaces: 1 to %d can be drawn at once", count,
                               LEAFCAST_SURFACES_MAX);
    for (int i = 0; i < count; i++) {
        if (!isfinite(surfaces[i].isovalue))
            return status_describe(ST_USAGE, "isovalue %d is not a finite number", i + 1);
        if (!(surfaces[i].opacity > 0.0f && surfaces[i].opacity <= 1.0f))
            return status_describe(ST_USAGE, "opacity %d is not in (0, 1]", i + 1);
    }
    return ST_OK;
}

/* Values and light that sums of products of them do not overflow with. */
static const double medium_most = 1e100, value_most = 1e300;

static status check_steps(const leafcast_scene_experiments *e) {
    if (e->summing == LEAFCAST_CERTIFIED)
        return ST_OK;
    if (!(e->step >= LEAFCAST_STEP_LEAST && e->step <= LEAFCAST_STEP_MOST))
        return status_describe(ST_USAGE,
                               "leafcast_scene_experiments.step is %g: %g to %g cells "
                               "are possible",
                               e->step, LEAFCAST_STEP_LEAST, LEAFCAST_STEP_MOST);
    if (!(e->opaque >= 0.0 && e->opaque <= 1.0))
        return status_describe(
            ST_USAGE, "leafcast_scene_experiments.opaque is %g: 0 to 1 are possible", e->opaque);
    if (e->table != 0 && (e->table < PREINTEGRATED_SIDE_MIN || e->table > PREINTEGRATED_SIDE_MAX))
        return status_describe(ST_USAGE,
                               "leafcast_scene_experiments.table is %d: %d to %d are possible",
                               e->table, PREINTEGRATED_SIDE_MIN, PREINTEGRATED_SIDE_MAX);
    return ST_OK;
}

static status check_scene_experiments(const leafcast_scene_experiments *e) {
    status st = public_size("leafcast_scene_experiments", e->size, sizeof *e);
    if (st == ST_OK)
        st = one_of("leafcast_scene_experiments.intersector", (long long)e->intersector,
                    LEAFCAST_SCHWARZE);
    if (st == ST_OK && !(e->homogeneous >= 0.0 && e->homogeneous <= value_most))
        st = status_describe(ST_USAGE,
                             "leafcast_scene_experiments.homogeneous is %g: 0 to %g is possible",
                             e->homogeneous, value_most);
    if (st == ST_OK)
        st = one_of("leafcast_scene_experiments.summing", (long long)e->summing,
                    LEAFCAST_PREINTEGRATED);
    return st == ST_OK ? check_steps(e) : st;
}

static status check_point(const leafcast_medium *medium, int i) {
    const leafcast_transfer_point *p = &medium->points[i];
    bool fine =
        fabs(p->value) <= value_most && p->extinction >= 0.0 && p->extinction <= medium_most;
    for (int c = 0; c < 3; c++)
        fine = fine && p->rgb[c] >= 0.0f && isfinite(p->rgb[c]);
    if (!fine)
        return status_describe(
            ST_USAGE,
            "point %d of the transfer function: a value up to %g, colours and an "
            "extinction up to %g, neither below 0, are possible",
            i + 1, value_most, medium_most);
    if (i > 0 && p->value < p[-1].value)
        return status_describe(ST_USAGE,
                               "point %d of the transfer function has a smaller value "
                               "than the one before",
                               i + 1);
    if (i > 0 && p->value > p[-1].value && p->value - p[-1].value < LEAFCAST_TRANSFER_NARROWEST)
        return status_describe(ST_USAGE,
                               "point %d of the transfer function: its value is neither that of "
                               "the point before nor %g above it",
                               i + 1, LEAFCAST_TRANSFER_NARROWEST);
    return ST_OK;
}

static status check_medium(const leafcast_medium *medium) {
    status st = one_of("leafcast_medium.count", medium->count, LEAFCAST_TRANSFER_POINTS_MAX);
    for (int i = 0; i < medium->count && st == ST_OK; i++)
        st = check_point(medium, i);
    return st;
}

static status check_media(const leafcast_scene *s) {
    const int volumes = s->volume_count > 0 ? s->volume_count : 1;
    status st = ST_OK;
    if (s->media_count != 0 && s->media_count != volumes)
        return status_describe(ST_USAGE, "leafcast_scene.media_count is %d: there are %d volumes",
                               s->media_count, volumes);
    for (int i = 0; i < s->media_count && st == ST_OK; i++)
        st = check_medium(&s->media[i]);
    if (st == ST_OK && s->caps && s->cap_colours)
        st = check_medium(s->cap_colours);
    if (st == ST_OK && !(s->shade_fade >= 0.0 && s->shade_fade <= 1.0))
        st = status_describe(ST_USAGE, "leafcast_scene.shade_fade is %g: 0 to 1 is possible",
                             s->shade_fade);
    if (st == ST_OK && s->shade_media && s->experiments &&
        (s->experiments->summing != LEAFCAST_CERTIFIED || s->experiments->homogeneous > 0.0))
        st = status_describe(ST_USAGE, "media are shaded cell by cell: not in steps, and no nodes "
                                       "taken whole");
    if (st == ST_OK && s->error != 0.0 && !(s->error >= 1e-9 && s->error <= 1.0))
        st = status_describe(ST_USAGE, "leafcast_scene.error is %g: 1e-9 to 1 are possible, and 0",
                             s->error);
    return st;
}

status arguments_check_scene(const leafcast_scene *s) {
    status st = public_size("leafcast_scene", s->size, sizeof *s);
    if (st == ST_OK)
        st = one_of("leafcast_scene.volume_count", s->volume_count, LEAFCAST_VOLUMES_MAX);
    if (st == ST_OK)
        st = one_of("leafcast_scene.light_count", s->light_count, LEAFCAST_LIGHTS_MAX);
    if (st == ST_OK)
        st = one_of("leafcast_scene.clip_plane_count", s->clip_plane_count,
                    LEAFCAST_CLIP_PLANES_MAX);
    if (st == ST_OK)
        st = one_of("leafcast_scene.shading", (long long)s->shading, LEAFCAST_SHADING_FLAT);
    if (st == ST_OK)
        st = one_of("leafcast_scene.lod", (long long)s->lod, LEAFCAST_LOD_PIXEL);
    if (st == ST_OK)
        st = one_of("leafcast_scene.project", (long long)s->project, LEAFCAST_PROJECT_FIRST);
    if (st == ST_OK && s->project == LEAFCAST_PROJECT_FIRST && !isfinite(s->project_value))
        st = status_describe(ST_USAGE, "leafcast_scene.project_value is not a finite number");
    if (st == ST_OK)
        st = check_media(s);
    if (st == ST_OK && !samples_valid(s->samples))
        st = status_describe(ST_USAGE, "%d samples a pixel: 1, 4 and 16 are possible", s->samples);
    if (st == ST_OK && s->experiments)
        st = check_scene_experiments(s->experiments);
    return st;
}

/* The part of the picture, and its rows. */
static status check_image(const leafcast_image *image, const leafcast_camera *camera) {
    const status st = public_size("leafcast_image", image->size, sizeof *image);
    if (st != ST_OK)
        return st;
    if (image->width == 0 ? image->x || image->y || image->height : image->height == 0)
        return status_describe(ST_USAGE, "a part of the picture with %u x %u pixels", image->width,
                               image->height);
    if ((uint64_t)image->x + image->width > camera->width ||
        (uint64_t)image->y + image->height > camera->height)
        return status_describe(ST_USAGE, "%u x %u pixels from (%u, %u) on: the picture has %u x %u",
                               image->width, image->height, image->x, image->y, camera->width,
                               camera->height);
    const uint32_t width = image->width ? image->width : camera->width;
    if (image->stride != 0 && image->stride < width)
        return status_describe(ST_USAGE, "rows of %u pixels every %zu", width, image->stride);
    return ST_OK;
}

status arguments_check_picture(const leafcast_scene *scene, const leafcast_camera *camera,
                               const leafcast_image *image, const leafcast_stats *stats) {
    status st = arguments_check_scene(scene);
    if (st == ST_OK)
        st = public_size("leafcast_camera", camera->size, sizeof *camera);
    if (st == ST_OK)
        st = check_image(image, camera);
    if (st == ST_OK && scene->samples > 1 && (image->rgba || image->error || image->value))
        st = status_describe(ST_USAGE, "planes of exact colours, errors and values are of one "
                                       "sample a pixel");
    if (st == ST_OK && stats)
        st = public_size("leafcast_stats", stats->size, sizeof *stats);
    return st;
}
