/* view_options_check.c - whether flags fit together, and whether each changes something. */
#include <string.h>

#include "formats/base/cli_options.h"
#include "render/app/light_options.h"
#include "render/app/view_options.h"
#include "render/app/view_options_keys.h"

/* Default colours of surfaces; they differ by more than their hue. */
static const float PALETTE[][3] = {{0.90f, 0.85f, 0.75f}, {0.75f, 0.13f, 0.10f},
                                   {0.10f, 0.32f, 0.75f}, {0.80f, 0.55f, 0.08f},
                                   {0.12f, 0.50f, 0.20f}, {0.50f, 0.15f, 0.55f}};

/* ---- flags that would change nothing ---- */

static bool has_time(const view_options *v) {
    return v->time.given;
}

static bool is_lit(const view_options *v) {
    return v->scene.shading != LEAFCAST_SHADING_FLAT || v->scene.shade_media;
}

static bool has_light(const view_options *v) {
    return v->scene.shading != LEAFCAST_SHADING_FLAT && v->scene.light_count > 0;
}

static bool radius_shows(const view_options *v) {
    return v->scene.shadows || !light_options_soft(&v->scene);
}

static bool is_soft(const view_options *v) {
    return light_options_soft(&v->scene);
}

static bool is_ambient(const view_options *v) {
    return v->scene.ambient > 0.0f || v->scene.shading == LEAFCAST_SHADING_FLAT;
}

static bool is_phong(const view_options *v) {
    return v->scene.shading == LEAFCAST_SHADING_PHONG;
}

static bool is_transparent(const view_options *v) {
    return v->others_transparent || view_options_transparent(v);
}

static bool shows_surface(const view_options *v) {
    return v->isos > 0 || v->others_surfaces;
}

static bool has_surfaces(const view_options *v) {
    return shows_surface(v) || v->unopened;
}

static bool has_inside(const view_options *v) {
    return !v->is_surface || v->others_surfaces;
}

static bool has_normals(const view_options *v) {
    return has_surfaces(v) || v->scene.shade_media;
}

static bool is_certified(const view_options *v) {
    return v->experiments.summing == LEAFCAST_CERTIFIED;
}

static bool not_shaded(const view_options *v) {
    return !v->scene.shade_media;
}

static bool shows_no_surface(const view_options *v) {
    return !shows_surface(v);
}

static bool is_clipped(const view_options *v) {
    return v->scene.clip_box || v->scene.clip_plane_count > 0;
}

typedef struct flag_need {
    int key;
    bool (*met)(const view_options *v);
    const char *why;
} flag_need;

static bool draws_surface(const view_options *v) {
    return v->isos > 0 || v->unopened;
}

static bool has_colours(const view_options *v) {
    return view_options_any_filled(v) || v->others_coloured || view_options_coloured(v);
}

static bool has_no_medium(const view_options *v) {
    return v->unopened || !view_options_any_medium(v); /* they may be colours of a surface */
}

static bool is_annotated(const view_options *v) {
    return v->annotation.parts != 0;
}

static const flag_need NEEDS[] = {
    {INTERPOLATE, has_time, "--interpolate: at which --time?"},
    {MEDIUM_PROJECT, shows_no_surface, "--project shows one value a pixel: without --iso"},
    {MEDIUM_ERROR, view_options_any_medium,
     "--error is of media: --tf, --colour-map or --opacity V:A"},
    {MEDIUM_HOMOGENEOUS, view_options_any_medium,
     "--homogeneous is of media: --tf, --colour-map or --opacity V:A"},
    {MEDIUM_ERROR, is_certified, "--error: steps of --medium have none that is known"},
    {MEDIUM_SHADE, view_options_any_medium,
     "--shade-medium is of media: --tf, --colour-map or --opacity V:A"},
    {MEDIUM_SHADE, is_certified, "--shade-medium: steps of --medium are not shaded"},
    {MEDIUM_HOMOGENEOUS, not_shaded,
     "--homogeneous: what --shade-medium shades is not taken whole"},
    {MEDIUM_SUMMING, view_options_any_medium,
     "--medium is of media: --tf, --colour-map or --opacity V:A"},
    {MEDIUM_LEGEND, has_colours,
     "--legend is of media, projections and colours by value: --tf, --colour-map, --opacity V:A, "
     "--project or --colour-by"},
    {COLOUR_BY, draws_surface, "--colour-by: there is no surface without --iso"},
    {MEDIUM_UNIT, is_annotated, "--unit is of --annotate"},
    {MEDIUM_CAPS, has_surfaces, "--caps: there is no surface without --iso"},
    {MEDIUM_CAPS, has_inside, "--caps: a surface itself has no inside"},
    {MEDIUM_CAPS, is_clipped, "--caps: nothing is cut open without --clip-box or --clip-plane"},
    {SHADING, has_surfaces, "--shading: there is no surface without --iso"},
    {NORMALS, has_normals, "--normals: there is no surface without --iso"},
    {LIGHT, has_normals, "--light: there is no surface without --iso"},
    {POINT_LIGHT, has_normals, "--point-light: there is no surface without --iso"},
    {AMBIENT, has_normals, "--ambient: there is no surface without --iso"},
    {INTERSECTOR, has_surfaces, "--intersector: there is no surface without --iso"},
    {SHADOWS, has_light,
     "--shadows: the light at the eye casts none that can be seen; --light says where another is"},
    {LIGHT, is_lit, "--light: there is none in --shading flat"},
    {POINT_LIGHT, is_lit, "--point-light: there is none in --shading flat"},
    {LIGHT, radius_shows, "--light: a RADIUS shows in shadows alone: --shadows"},
    {POINT_LIGHT, radius_shows, "--point-light: a RADIUS shows in shadows alone: --shadows"},
    {LIGHT_SAMPLES, is_soft, "--light-samples: no --light and no --point-light has a RADIUS"},
    {OCCLUSION, has_surfaces, "--occlusion: there is no surface without --iso"},
    {OCCLUSION, is_ambient, "--occlusion: there is no ambient light to hide with --ambient 0"},
    {AMBIENT, is_lit, "--ambient: there is no light in --shading flat"},
    {SPECULAR, is_phong, "--specular: highlights are --shading phong's"},
    {SHININESS, is_phong, "--shininess: highlights are --shading phong's"},
    {REFRACT, view_options_transparent,
     "--refract: nothing is seen through a surface without --opacity"},
    {REFRACT, has_no_medium,
     "--refract: bent rays see no media: without --tf, --colour-map and --opacity V:A"},
    {LAYERS, is_transparent, "--layers: nothing is seen behind a surface without --opacity"}};

static status check_flags(const view_options *v, const flag_need *needs, size_t count) {
    for (size_t i = 0; i < count; i++)
        if ((v->given & view_options_bit(needs[i].key)) && !needs[i].met(v))
            return status_describe(ST_USAGE, "%s", needs[i].why);
    return ST_OK;
}

status view_options_check_either(const view_options *v) {
    if (v->eye && (v->given & view_options_bit(VIEW)))
        return status_describe(ST_USAGE, "either --view or --eye: both say where the camera is");
    return time_options_check(&v->time);
}

status view_options_only(const view_options *v, const char *names, const char *who) {
    for (const struct argp_option *o = view_options_table; o->name || o->doc; o++)
        if (o->name && !(o->flags & OPTION_ALIAS) && (v->given & view_options_bit(o->key)) &&
            !cli_options_listed(names, o->name))
            return status_describe(ST_USAGE, "--%s: %s would not change by it", o->name, who);
    return ST_OK;
}

/* What else a kind cannot do, the library itself reports. */
status view_options_check_volume(const view_options *v, const leafcast *volume) {
    const leafcast_info info = leafcast_describe(volume);
    const bool lod = (v->given & view_options_bit(LOD)) && v->scene.lod != LEAFCAST_LOD_EXACT;
    const bool normals = v->given & view_options_bit(NORMALS), of_cells = v->normals >= 2;
    const bool inexact = (v->given & view_options_bit(INTERSECTOR)) &&
                         v->experiments.intersector != LEAFCAST_MARMITT;
    if (lod && !v->scene.preview && !(info.abilities & LEAFCAST_ABILITY_LEVELS))
        return status_describe(ST_USAGE, "--lod: a %s has no coarse levels but in a preview",
                               info.kind);
    if (inexact && !(info.abilities & LEAFCAST_ABILITY_INTERSECTORS))
        return status_describe(ST_USAGE, "--intersector: intersectors are for grids");
    if (normals && of_cells && (info.abilities & LEAFCAST_ABILITY_ANALYTIC_NORMALS))
        return status_describe(ST_USAGE, "--normals: a %s's are central or analytic", info.kind);
    if (normals && !of_cells && (info.abilities & LEAFCAST_ABILITY_SMOOTH_NORMALS))
        return status_describe(ST_USAGE, "--normals: a %s's are faceted or smooth", info.kind);
    return ST_OK;
}

/* Check that no flag about one surface is given more often than --iso. */
static status check_counts(const view_options *v) {
    const struct {
        int count;
        const char *name, *more;
    } flags[] = {{v->colours, "colour", ""},
                 {v->opacities, "opacity", ""},
                 {v->reflects, "reflect", "; bounces are in its text: \"WEIGHT,BOUNCES\""},
                 {v->refracts, "refract", "; bounces are in its text: \"INDEX,BOUNCES\""}};
    if (v->unopened && v->isos == 0)
        return ST_OK; /* a surface itself needs no --iso */
    for (size_t i = 0; i < sizeof flags / sizeof *flags; i++)
        if (flags[i].count > v->isos)
            return status_describe(ST_USAGE,
                                   "%d of --%s for %d of --iso: the k-th belongs to the k-th%s",
                                   flags[i].count, flags[i].name, v->isos, flags[i].more);
    return ST_OK;
}

status view_options_check(view_options *v) {
    if (v->isos == 0 && !view_options_filled(v))
        return status_describe(ST_USAGE, "which isosurface? --iso V");
    status st = check_counts(v);
    if (st != ST_OK)
        return st;
    enum { PALETTE_SIZE = sizeof PALETTE / sizeof *PALETTE };
    for (int i = v->colours; i < v->isos; i++)
        memcpy(v->surfaces[i].rgb, PALETTE[(v->painted + i) % PALETTE_SIZE], sizeof PALETTE[0]);
    for (int i = v->opacities; i < v->isos; i++)
        v->surfaces[i].opacity = 1.0f;
    for (int i = v->reflects; i < v->isos; i++)
        v->surfaces[i].reflectivity = 0.0f;
    for (int i = v->refracts; i < v->isos; i++)
        v->surfaces[i].refraction = 0.0f;
    if (v->is_surface && (v->medium.opacities > 0 || v->medium.opacity_length > 0.0))
        return status_describe(ST_USAGE, "--opacity V:A and --opacity-length are of media: this is "
                                         "a surface, for which --opacity A is");
    if (v->colour_by[0] && (v->medium.opacities > 0 || v->medium.opacity_length > 0.0))
        return status_describe(ST_USAGE, "--colour-by colours surfaces, for which --opacity A is: "
                                         "without --opacity V:A and --opacity-length");
    st = medium_options_check(&v->medium, v->scene.project != LEAFCAST_PROJECT_NONE ||
                                              view_options_coloured(v));
    if (st == ST_OK)
        st = view_options_check_either(v);
    return st == ST_OK ? check_flags(v, NEEDS, sizeof NEEDS / sizeof *NEEDS) : st;
}
