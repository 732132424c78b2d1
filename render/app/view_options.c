#include "render/app/view_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_options.h"
#include "formats/base/cli_value.h"
#include "formats/base/num.h"
#include "render/app/clip_options.h"
#include "render/app/colour.h"
#include "render/app/light_options.h"
#include "render/app/view_options_keys.h"
#include "render/experiments/experiments.h"

LINK_EXPERIMENTS;

static const char SHADINGS[] = "diffuse|phong|flat",
                  KINDS_OF_NORMALS[] = "central|analytic|faceted|smooth";

const struct argp_option view_options_table[] = {
    {NULL, 0, NULL, 0, "Isosurfaces (repeat for more than one):", 10},
    {"iso", ISO, "V[,V...]", 0, "draw the isosurface of value V", 0},
    {"colour", COLOUR, "COLOUR", 0,
     "colour of the isosurface given at the same position: a name (red), R,G,B (linear) or "
     "#rrggbb (sRGB)",
     0},
    {"opacity", OPACITY, "A", 0,
     "opacity of the isosurface given at the same position, above 0 to 1 (1); or V:A,V:A,...: of a "
     "medium, at values V",
     0},
    {"colour-by", COLOUR_BY, "FIELD|FILE[:FIELD]", 0,
     "colour the surfaces by the values there of another field, or of another file, as a colour "
     "map "
     "has them (viridis)",
     0},
    {"layers", LAYERS, "N", 0, "stop each ray after N surfaces (0: no limit)", 0},

    {NULL, 0, NULL, 0, "Camera:", 20},
    {"view", VIEW, "NAME", 0,
     "view without --eye: fit (shows all that is active), standard or close (aim at the volume) "
     "(fit)",
     0},
    {"eye", EYE, "X,Y,Z", 0, "position of the camera", 0},
    {"look-at", LOOK_AT, "X,Y,Z", 0, "the point in the middle of the picture (the volume's centre)",
     0},
    {"up", UP, "X,Y,Z", 0, "the direction that points up (0,0,1)", 0},
    {"fov", FOV, "DEG", 0, "vertical field of view (fit: 35, else 45)", 0},
    {"ortho", ORTHO, "HEIGHT", 0, "parallel rays; the picture is HEIGHT world units high", 0},
    {"size", SIZE, "WxH", 0, "pixels (1024x1024)", 0},
    {"samples", SAMPLES, "N", 0, "rays per pixel, to smooth edges: 1, 4 or 16 (1)", 0},

    {NULL, 0, NULL, 0, "Light and colour:", 30},
    {"shading", SHADING, SHADINGS, 0, "diffuse, phong or flat (diffuse)", 0},
    {"normals", NORMALS, KINDS_OF_NORMALS, 0,
     "grids: central (differences) or analytic (gradient of the cell's trilinear form) (central); "
     "meshes: faceted (one normal per tet) or smooth (interpolated gradients of the vertices) "
     "(faceted)",
     0},
    {"light", LIGHT, "X,Y,Z[,R,G,B][,RADIUS]", 0,
     "a light from this direction, in this colour; without lights, one shines from the eye. "
     "RADIUS: "
     "half the angle that it covers, in degrees (the sun: 0.27), for soft shadows. Repeatable",
     0},
    {"point-light", POINT_LIGHT, "X,Y,Z[,R,G,B][,RADIUS]", 0,
     "a light at this point; a ball of RADIUS world units casts soft shadows. Repeatable", 0},
    {"shadows", SHADOWS, NULL, 0, "lights cast shadows", 0},
    {"light-samples", LIGHT_SAMPLES, "N", 0,
     "rays of each surface to each light with a RADIUS, 1 to 64 (16)", 0},
    {"occlusion", OCCLUSION, "DISTANCE[,SAMPLES]", 0,
     "ambient light is hidden by surfaces within DISTANCE world units, which so many rays look "
     "for, "
     "1 to 64 (16)",
     0},
    {"reflect", REFLECT, "WEIGHT[,BOUNCES]", 0,
     "the isosurface given at the same position reflects: share of the mirrored colour, 0 to 1; "
     "and "
     "of how many surfaces one after the other, 1 to 8 (1)",
     0},
    {"refract", REFRACT, "INDEX[,BOUNCES]", 0,
     "the isosurface given at the same position bends rays, as glass does (1.5): the refractive "
     "index of its inside, divided by that of its outside, 0.25 to 4 (1); and at how many surfaces "
     "one after the other, 1 to 8 (4). It needs --opacity",
     0},
    {"ambient", AMBIENT, "A", 0, "share of ambient light, 0 to 1 (0.15)", 0},
    {"specular", SPECULAR, "S", 0, "weight of the highlight of --shading phong (0.3)", 0},
    {"shininess", SHININESS, "N", 0, "exponent of the highlight of --shading phong, 1 to 1024 (32)",
     0},
    {"background", BACKGROUND, "COLOUR", 0,
     "colour behind all surfaces, as --colour takes it, or R,G,B,A or #rrggbbaa; 0,0,0,0 is "
     "transparent (a dark slate)",
     0},

    {NULL, 0, NULL, 0, "What is drawn:", 40},
    {"field", FIELD, "NAME", 0, "of several fields: draw this one, by name or number (the first)",
     0},
    {"step", STEP, "K", 0, "of several time steps: draw this one, counted from 0 (0)", 0},
    {"time", TIME, "T", 0, TIME_OPTIONS_TIME, 0},
    {"interpolate", INTERPOLATE, NULL, 0, TIME_OPTIONS_INTERPOLATE, 0},
    {"clip-box", CLIP_BOX, "X0,Y0,Z0,X1,Y1,Z1", 0, "draw only what is inside this box", 0},
    {"clip-plane", CLIP_PLANE, "A,B,C,D", 0, "draw only where Ax + By + Cz + D >= 0. Repeatable",
     0},
    {"lod", LOD, "LEVEL", 0,
     "level of detail: exact, pixel (the coarsest cells that fit a pixel) or a level's number "
     "(exact)",
     0},
    {"preview", PREVIEW, NULL, 0,
     "draw what is soon there, coarser, instead of waiting for the rest", 0},
    {"sweep", SWEEP, NULL, CLI_EXPERIMENT,
     "load all that the isovalues need, not only what rays meet", 0},
    {"intersector", INTERSECTOR, "NAME", CLI_EXPERIMENT,
     "midpoint, linear, neubauer, schwarze, marmitt-3 or marmitt (the exact one)", 0},
    {NULL, 0, NULL, 0, NULL, 0}};

void view_options_init(view_options *v) {
    static const float slate[4] = {0.014f, 0.02f, 0.032f, 1.0f};
    *v = (view_options){.scene = leafcast_scene_default(),
                        .camera = {.width = 1024, .height = 1024, .fov = 45.0},
                        .fit = true,
                        .distance = 2.2};
    memcpy(v->scene.background, slate, sizeof slate);
}

int view_options_key(const char *name, bool *repeats, view_value *value) {
    const struct argp_option *const tables[] = {view_options_table, medium_options_table};
    for (int t = 0; t < 2; t++)
        for (const struct argp_option *o = tables[t]; o->name || o->doc; o++) {
            if (!cli_options_same(name, o->name))
                continue;
            const int key = o->key;
            *repeats = key == ISO || key == COLOUR || key == OPACITY || key == LIGHT ||
                       key == POINT_LIGHT || key == CLIP_PLANE || key == REFLECT || key == REFRACT;
            *value = !o->arg && !(o->flags & OPTION_ALIAS) ? VIEW_VALUE_NONE
                     : o->flags & OPTION_ARG_OPTIONAL      ? VIEW_VALUE_OPTIONAL
                                                           : VIEW_VALUE_NEEDED;
            return key;
        }
    return 0;
}

/* ---- values ---- */

static status parse_weight(const char *text, const char *what, double hi, float *out) {
    double value = 0.0;
    status st = cli_finite(text, what, 0.0, hi, &value);
    if (st == ST_OK)
        *out = (float)value;
    return st;
}

static status parse_size(const char *text, leafcast_camera *camera) {
    enum { SIDE_MAX = 65536 };
    double size[2];
    status st = num_doubles(text, "--size", strchr(text, 'x') ? "x" : ",", 2, size);
    for (int i = 0; i < 2 && st == ST_OK; i++)
        if (!(size[i] >= 1.0 && size[i] <= SIDE_MAX && size[i] == floor(size[i])))
            st = status_describe(ST_USAGE, "--size: \"%s\" is not WxH, each 1 to %d", text,
                                 SIDE_MAX);
    if (st == ST_OK) {
        camera->width = (uint32_t)size[0];
        camera->height = (uint32_t)size[1];
    }
    return st;
}

static status parse_lod(const char *text, leafcast_scene *scene) {
    int which = 0;
    if (text[0] >= '0' && text[0] <= '9') {
        scene->lod = LEAFCAST_LOD_LEVEL;
        return cli_uint(text, "--lod", 0, 63, &scene->lod_level);
    }
    if (cli_word(text, "--lod", "exact|pixel", &which))
        return status_describe(ST_USAGE, "--lod: \"%s\" is neither exact, pixel nor a level", text);
    scene->lod = which == 0 ? LEAFCAST_LOD_EXACT : LEAFCAST_LOD_PIXEL;
    return ST_OK;
}

static status parse_intersector(const char *text, leafcast_intersector *how) {
    static const leafcast_intersector named[] = {LEAFCAST_MIDPOINT,  LEAFCAST_LINEAR,
                                                 LEAFCAST_NEUBAUER,  LEAFCAST_SCHWARZE,
                                                 LEAFCAST_MARMITT_3, LEAFCAST_MARMITT};
    int which = 0;
    const status st = cli_word(text, "--intersector",
                               "midpoint|linear|neubauer|schwarze|marmitt-3|marmitt", &which);
    if (st == ST_OK)
        *how = named[which];
    return st;
}

static status parse_field(const char *text, view_options *v) {
    if (!*text || strlen(text) >= sizeof v->field)
        return status_describe(ST_USAGE, "--field: \"%s\" is no field's name", text);
    memcpy(v->field, text, strlen(text) + 1);
    return ST_OK;
}

static status parse_colour_by(const char *text, view_options *v) {
    if (!*text || strlen(text) >= sizeof v->colour_by)
        return status_describe(ST_USAGE, "--colour-by: \"%s\" is no name of a field or file", text);
    memcpy(v->colour_by, text, strlen(text) + 1);
    return ST_OK;
}

/* ---- flags that may be repeated ---- */

static status room(const char *what, int count, int max) {
    if (count < max)
        return ST_OK;
    return status_describe(ST_USAGE, "%s: more than %d of them", what, max);
}

/* Add the isovalues of "V" or "V,V,...": several surfaces in one picture. */
static status add_iso(view_options *v, const char *text) {
    for (const char *at = text;; at++) {
        char one[64];
        const size_t n = strcspn(at, ",");
        snprintf(one, sizeof one, "%.*s", (int)(n < 63 ? n : 63), at);
        status st = room("--iso", v->isos, LEAFCAST_SURFACES_MAX);
        if (st == ST_OK)
            st = cli_finite(one, "--iso", -INFINITY, INFINITY, &v->surfaces[v->isos].isovalue);
        if (st != ST_OK)
            return st;
        v->isos++;
        at += n;
        if (!*at)
            return ST_OK;
    }
}

static status add_colour(view_options *v, const char *text) {
    status st = room("--colour", v->colours, LEAFCAST_SURFACES_MAX);
    if (st == ST_OK)
        st = colour_parse(text, "--colour", v->surfaces[v->colours].rgb, NULL);
    v->colours += st == ST_OK;
    return st;
}

static status add_opacity(view_options *v, const char *text) {
    if (v->takes_media && strchr(text, ':'))
        return medium_options_add_opacities(&v->medium, text);
    float *opacity = &v->surfaces[v->opacities].opacity;
    status st = room("--opacity", v->opacities, LEAFCAST_SURFACES_MAX);
    if (st == ST_OK)
        st = parse_weight(text, "--opacity", 1.0, opacity);
    if (st == ST_OK && !(*opacity > 0.0f))
        st = status_describe(ST_USAGE, "--opacity: %s is not above 0", text);
    v->opacities += st == ST_OK;
    return st;
}

static int more_of(int a, int b) {
    return a > b ? a : b;
}

int view_options_bounces(int reflect, int refract, bool bends) {
    const int bent = refract > 0 ? refract : LIGHT_OPTIONS_BENDS;
    return more_of(reflect, bends ? bent : 0);
}

void view_options_bounce(view_options *v, int reflect, int refract) {
    v->reflect_bounces = more_of(v->reflect_bounces, reflect);
    v->refract_bounces = more_of(v->refract_bounces, refract);
    v->scene.bounces =
        view_options_bounces(v->reflect_bounces, v->refract_bounces, v->refracts > 0);
}

static status add_reflect(view_options *v, const char *text) {
    int bounces = 1;
    status st = room("--reflect", v->reflects, LEAFCAST_SURFACES_MAX);
    if (st == ST_OK)
        st = light_options_reflect(text, &v->surfaces[v->reflects], &bounces);
    if (st == ST_OK)
        view_options_bounce(v, bounces, 0);
    v->reflects += st == ST_OK;
    return st;
}

static status add_refract(view_options *v, const char *text) {
    int bounces = 0;
    status st = room("--refract", v->refracts, LEAFCAST_SURFACES_MAX);
    if (st == ST_OK)
        st = light_options_refract(text, &v->surfaces[v->refracts], &bounces);
    v->refracts += st == ST_OK;
    if (st == ST_OK)
        view_options_bounce(v, 0, bounces);
    return st;
}

/* ---- flags ---- */

static status set_surface(view_options *v, int key, const char *text) {
    switch (key) {
    case ISO: return add_iso(v, text);
    case COLOUR: return add_colour(v, text);
    case OPACITY: return add_opacity(v, text);
    case REFLECT: return add_reflect(v, text);
    case REFRACT: return add_refract(v, text);
    case COLOUR_BY: return parse_colour_by(text, v);
    case LAYERS: return cli_int(text, "--layers", 0, 1 << 20, &v->scene.layers_max);
    default: return ST_AGAIN;
    }
}

static status set_samples(const char *text, int *samples) {
    status st = cli_int(text, "--samples", 1, 16, samples);
    if (st == ST_OK && *samples != 1 && *samples != 4 && *samples != 16)
        st = status_describe(ST_USAGE, "--samples: %d is none of 1, 4, 16", *samples);
    return st;
}

static status set_camera(view_options *v, int key, const char *text) {
    leafcast_camera *c = &v->camera;
    int which = 0;
    status st = ST_OK;
    switch (key) {
    case EYE: v->eye = true; return cli_vector(text, "--eye", 3, c->eye);
    case LOOK_AT: v->look_at = true; return cli_vector(text, "--look-at", 3, c->look_at);
    case UP: v->up = true; return cli_vector(text, "--up", 3, c->up);
    case FOV: v->fov = true; return cli_finite(text, "--fov", 1e-6, 179.999, &c->fov);
    case ORTHO: return cli_finite(text, "--ortho", 1e-300, 1e300, &c->ortho_height);
    case SIZE: return parse_size(text, c);
    case SAMPLES: return set_samples(text, &v->scene.samples);
    case VIEW:
        st = cli_word(text, "--view", "standard|close|fit", &which);
        v->fit = which == 2;
        v->distance = which == 1 ? 1.1 : 2.2;
        return st;
    default: return ST_AGAIN;
    }
}

static status set_light(view_options *v, int key, const char *text) {
    leafcast_scene *s = &v->scene;
    int which = 0;
    status st = ST_OK;
    switch (key) {
    case SHADING:
        st = cli_word(text, "--shading", SHADINGS, &which);
        s->shading = (leafcast_shading)which;
        return st;
    case NORMALS:
        st = cli_word(text, "--normals", KINDS_OF_NORMALS, &which);
        s->analytic_normals = which == 1 || which == 2;
        s->smooth_normals = which == 3;
        v->normals = which;
        return st;
    case LIGHT: return light_options_add(s, false, text);
    case POINT_LIGHT: return light_options_add(s, true, text);
    case SHADOWS: s->shadows = true; return ST_OK;
    case LIGHT_SAMPLES:
        return cli_int(text, "--light-samples", 1, LEAFCAST_LIGHT_SAMPLES_MAX, &s->light_samples);
    case OCCLUSION: return light_options_occlusion(text, s);
    case AMBIENT: return parse_weight(text, "--ambient", 1.0, &s->ambient);
    case SPECULAR: return parse_weight(text, "--specular", 1000.0, &s->specular);
    case SHININESS: return cli_int(text, "--shininess", 1, 1024, &s->shininess);
    case BACKGROUND: return colour_parse(text, "--background", s->background, &s->background[3]);
    default: return ST_AGAIN;
    }
}

static status set_extent(view_options *v, int key, const char *text) {
    switch (key) {
    case CLIP_BOX: return clip_options_box(&v->scene, text);
    case CLIP_PLANE: return clip_options_add_plane(&v->scene, text);
    case LOD: return parse_lod(text, &v->scene);
    case PREVIEW: v->scene.preview = true; return ST_OK;
    case SWEEP: v->scene.sweep = true; return ST_OK;
    case INTERSECTOR: return parse_intersector(text, &v->experiments.intersector);
    default: return ST_AGAIN;
    }
}

static status take_text(const char *text, const char *what, char *to, size_t size) {
    if (strlen(text) >= size)
        return status_describe(ST_USAGE, "%s: a text of more than %zu bytes", what, size - 1);
    memcpy(to, text, strlen(text) + 1);
    return ST_OK;
}

static status set_medium(view_options *v, int key, const char *text) {
    leafcast_scene *s = &v->scene;
    switch (key) {
    case MEDIUM_PROJECT: return medium_options_project(text, &s->project, &s->project_value);
    case MEDIUM_ERROR: return medium_options_error(text, &s->error);
    case MEDIUM_HOMOGENEOUS:
        return cli_finite(text, "--homogeneous", 0.0, 1e300, &v->experiments.homogeneous);
    case MEDIUM_SHADE: s->shade_media = true; return medium_options_shade(text, &s->shade_fade);
    case MEDIUM_LEGEND: v->legend = true; return ST_OK;
    case MEDIUM_ANNOTATE: return annotate_parts(text, &v->annotation.parts);
    case MEDIUM_TITLE:
        return take_text(text, "--title", v->annotation.title, sizeof v->annotation.title);
    case MEDIUM_UNIT:
        return take_text(text, "--unit", v->annotation.unit, sizeof v->annotation.unit);
    case MEDIUM_SUMMING: return medium_options_summing(text, &v->experiments);
    case MEDIUM_CAPS: s->caps = true; return medium_options_caps(text, &v->caps);
    default: return medium_options_set(&v->medium, key, text);
    }
}

static status set_moment(view_options *v, int key, const char *text) {
    switch (key) {
    case STEP:
        time_options_step(&v->time);
        return cli_uint(text, "--step", 0, UINT16_MAX, &v->step);
    case TIME: return time_options_parse(text, &v->time);
    case INTERPOLATE: v->time.interpolate = true; return ST_OK;
    default: return ST_AGAIN;
    }
}

static status set_any(view_options *v, int key, const char *text) {
    status st = set_surface(v, key, text);
    if (st == ST_AGAIN)
        st = set_camera(v, key, text);
    if (st == ST_AGAIN)
        st = set_light(v, key, text);
    if (st == ST_AGAIN)
        st = set_extent(v, key, text);
    if (st == ST_AGAIN && key == FIELD)
        st = parse_field(text, v);
    if (st == ST_AGAIN)
        st = set_moment(v, key, text);
    return st == ST_AGAIN ? set_medium(v, key, text) : st;
}

bool view_options_of_one(int key) {
    return key == ISO || key == COLOUR || key == OPACITY || key == REFLECT || key == REFRACT ||
           key == FIELD || key == STEP || key == TIME || key == INTERPOLATE || key == COLOUR_BY ||
           (key >= MEDIUM_TF && key <= MEDIUM_OPACITY_LENGTH);
}

status view_options_set(view_options *v, int key, const char *text) {
    status st = set_any(v, key, text);
    if (st == ST_OK)
        v->given |= view_options_bit(key);
    return st;
}

void view_options_clear(view_options *v, int key) {
    leafcast_scene *s = &v->scene;
    v->given &= ~view_options_bit(key);
    switch (key) {
    case ISO: v->isos = 0; break;
    case COLOUR: v->colours = 0; break;
    case OPACITY: v->opacities = v->medium.opacities = 0; break;
    case REFLECT:
        v->reflects = v->reflect_bounces = 0;
        view_options_bounce(v, 0, 0);
        break;
    case REFRACT:
        v->refracts = v->refract_bounces = 0;
        view_options_bounce(v, 0, 0);
        break;
    case LIGHT:
    case POINT_LIGHT: light_options_remove(s, key == POINT_LIGHT); break;
    case OCCLUSION: s->occlusion = s->occlusion_samples = 0; break;
    case CLIP_PLANE: s->clip_plane_count = 0; break;
    case CLIP_BOX: s->clip_box = false; break;
    case SHADOWS: s->shadows = false; break;
    case PREVIEW: s->preview = false; break;
    case SWEEP: s->sweep = false; break;
    case EYE: v->eye = false; break;
    case LOOK_AT: v->look_at = false; break;
    case UP: v->up = false; break;
    case FOV: v->fov = false; break;
    case FIELD: v->field[0] = 0; break;
    case COLOUR_BY: v->colour_by[0] = 0; break;
    case STEP: v->step = 0; break;
    case TIME: v->time.given = false; break;
    case INTERPOLATE: v->time.interpolate = false; break;
    case ORTHO: v->camera.ortho_height = 0.0; break;
    case MEDIUM_PROJECT: s->project = LEAFCAST_PROJECT_NONE; break;
    case MEDIUM_LEGEND: v->legend = false; break;
    case MEDIUM_SHADE: s->shade_media = false; break;
    case MEDIUM_ANNOTATE: v->annotation.parts = 0; break;
    case MEDIUM_TITLE: v->annotation.title[0] = 0; break;
    case MEDIUM_UNIT: v->annotation.unit[0] = 0; break;
    case MEDIUM_CAPS: s->caps = false; break;
    default:
        medium_options_clear(&v->medium, key);
        break; /* the others have one value, which is replaced */
    }
}

void view_options_inherit(view_options *v) {
    v->given &= ~view_options_bit(VIEW);
    time_options_inherit(&v->time);
}
