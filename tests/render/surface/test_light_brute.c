/* test_light_brute.c - soft shadows, hidden ambient light, reflections and refractions of a grid, a
 * mesh and both: pixel by pixel what rays of the public calls say, by the pattern that
 * render/surface/ light_samples.h describes; and the same bits for any threads, kernels, treelets,
 * slices and parts.
 */
/* marks: threads */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "tests/support/scene_stage.h"
#include "tests/support/watched.h"

enum { STEP = WATCHED ? 61 : 7, LAYERS = 64, SAMPLES_MAX = 64 };

#define START 1e-7 /* where rays begin to count, */
#define CLOSE 1e-4 /* and up to where what they meet may be the surface that they leave */

/* What is drawn, as rays see it. */
typedef struct lab {
    leafcast *volume;
    leafcast_scene scene; /* as drawn; */
    leafcast_scene cells; /* the same with the gradients of cells as normals */
    leafcast_surface surfaces[3];
    uint32_t x, y; /* of the pixel */
} lab;

typedef struct colour {
    double rgba[4];
    double slack; /* what cannot be told may change it by so much */
    bool unclear; /* it may be anything */
} colour;

/* ---- Vectors ---- */

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit(double v[3]) {
    const double length = sqrt(dot(v, v));
    for (int a = 0; a < 3; a++)
        v[a] /= length;
}

/* ---- The pattern ---- */

static double fraction(double x) {
    return x - floor(x);
}

/* Sample k of n; q: the light. */
static void pattern(const lab *l, int q, int k, int n, double uv[2]) {
    const double whole = 4294967296.0, a = 3242174889.0, b = 2447445413.0, c = 2654435769.0;
    const double x = l->x, y = l->y;
    double mirrored = 0, place = 0.5;
    for (int rest = k; rest > 0; rest /= 2, place /= 2)
        mirrored += place * (rest % 2);
    const double even = floor((k + 0.5) / n * whole);
    uv[0] = fraction((even + fmod(a * x, whole) + fmod(b * y, whole) + fmod(c * q, whole)) / whole);
    uv[1] = fraction(mirrored + fraction(b * x / whole) + fraction(a * y / whole));
}

/* Around an axis, at an angle of this cosine: the basis of Duff et al. */
static void around(const double n[3], double cosine, double turns, double to[3]) {
    const double s = n[2] < 0 ? -1 : 1, a = -1 / (s + n[2]), b = n[0] * n[1] * a;
    const double e1[3] = {1 + s * n[0] * n[0] * a, s * b, -s * n[0]};
    const double e2[3] = {b, s + n[1] * n[1] * a, -n[1]};
    const double sine = sqrt(fmax(0, 1 - cosine * cosine)), w = 2 * acos(-1) * turns;
    for (int i = 0; i < 3; i++)
        to[i] = sine * (cos(w) * e1[i] + sin(w) * e2[i]) + cosine * n[i];
}

/* ---- Rays ---- */

static leafcast_ray ray_of(const double from[3], const double to[3], double t0, double t1) {
    leafcast_ray r = {.t0 = t0, .t1 = t1};
    memcpy(r.origin, from, sizeof r.origin);
    memcpy(r.direction, to, sizeof r.direction);
    return r;
}

/* What comes through all surfaces on each ray; close[i]: its first one may be the one it leaves. */
static void see(const lab *l, leafcast_ray rays[], int count, double through[], bool close[]) {
    leafcast_ray_hit hits[SAMPLES_MAX];
    bool going[SAMPLES_MAX];
    for (int i = 0; i < count; i++) {
        through[i] = 1;
        close[i] = false;
        going[i] = rays[i].t1 > START;
    }
    for (int layer = 0, left = count; layer < LAYERS && left > 0; layer++) {
        assert_int_equal(leafcast_trace_rays(l->volume, &l->scene, rays, (size_t)count, hits),
                         LEAFCAST_OK);
        left = 0;
        for (int i = 0; i < count; i++) {
            if (!going[i])
                continue;
            going[i] = hits[i].t < INFINITY;
            if (!going[i])
                continue;
            close[i] |= layer == 0 && hits[i].t < CLOSE;
            through[i] *= 1 - (double)l->surfaces[hits[i].surface].opacity;
            rays[i].t0 = hits[i].t + 1e-9;
            going[i] = through[i] > 1.0 / 4096 && rays[i].t0 < rays[i].t1;
            if (!(through[i] > 1.0 / 4096))
                through[i] = 0;
            left += going[i];
        }
    }
}

/* ---- Surfaces ---- */

/* A surface that a ray has met. */
typedef struct met {
    double at[3], towards[3]; /* it, and the way back */
    double normal[3];         /* on that side; */
    double side[3];           /* the cell's own: the side that the ray came from */
    bool entering;
    const leafcast_surface *look;
} met;

static met met_of(const lab *l, const leafcast_ray *r, const leafcast_ray_hit *h,
                  const leafcast_ray_hit *of_cell) {
    met m = {.look = &l->surfaces[h->surface], .entering = h->entering};
    for (int a = 0; a < 3; a++) {
        m.at[a] = r->origin[a] + h->t * r->direction[a];
        m.towards[a] = -r->direction[a];
        m.normal[a] = (double)h->normal[a];
        m.side[a] = (double)of_cell->normal[a] * (h->entering ? 1 : -1);
    }
    const double turn = dot(m.normal, m.towards) < 0 ? -1 : 1;
    for (int a = 0; a < 3; a++)
        m.normal[a] *= turn;
    unit(m.normal);
    return m;
}

/* Share of the samples that arrives; *slack: what of it cannot be told. out: those on the other
 * side are left out, not hidden. */
static double arriving(const lab *l, const met *m, leafcast_ray rays[], int n, bool out,
                       double *slack) {
    leafcast_ray asked[SAMPLES_MAX];
    double through[SAMPLES_MAX], sum = 0;
    bool close[SAMPLES_MAX];
    int count = 0, kept = 0, unclear = 0;
    for (int i = 0; i < n; i++) {
        const double slope = dot(m->side, rays[i].direction);
        unclear += fabs(slope) < 1e-4;
        kept += slope > 0 || !out;
        if (slope > 0)
            asked[count++] = rays[i];
    }
    see(l, asked, count, through, close);
    for (int i = 0; i < count; i++) {
        sum += through[i];
        unclear += close[i];
    }
    *slack = (double)unclear / (kept > 0 ? kept : 1);
    return kept > 0 ? sum / kept : 1;
}

static double of_light(const lab *l, const met *m, int q, double *n_l, double *slack) {
    const leafcast_light *light = &l->scene.lights[q];
    leafcast_ray rays[SAMPLES_MAX];
    double to[3], distance = INFINITY;
    for (int a = 0; a < 3; a++)
        to[a] = light->vector[a] - (light->point ? m->at[a] : 0);
    if (light->point)
        distance = sqrt(dot(to, to));
    unit(to);
    *slack = 0;
    *n_l = fmax(0, dot(m->normal, to));
    if (*n_l == 0 || distance <= light->radius)
        return 1;
    const int n = light->radius > 0 ? l->scene.light_samples : 1;
    const double cone =
        light->point ? asin(light->radius / distance) : light->radius * acos(-1) / 180;
    for (int k = 0; k < n; k++) {
        double uv[2], way[3], end = distance;
        pattern(l, q, k, n, uv);
        const double cosine = 1 - uv[0] * (1 - cos(cone));
        around(to, light->radius > 0 ? cosine : 1, uv[1], way);
        if (light->point && light->radius > 0)
            end =
                distance * cosine - sqrt(fmax(0, light->radius * light->radius -
                                                     distance * distance * (1 - cosine * cosine)));
        rays[k] = ray_of(m->at, way, START, fmax(end, START));
    }
    return arriving(l, m, rays, n, false, slack);
}

static double of_surroundings(const lab *l, const met *m, double *slack) {
    leafcast_ray rays[SAMPLES_MAX];
    const int n = l->scene.occlusion_samples;
    *slack = 0;
    if (l->scene.occlusion == 0)
        return 1;
    for (int k = 0; k < n; k++) {
        double uv[2], way[3];
        pattern(l, LEAFCAST_LIGHTS_MAX, k, n, uv);
        around(m->normal, sqrt(1 - uv[0]), uv[1], way);
        rays[k] = ray_of(m->at, way, START, l->scene.occlusion);
    }
    return arriving(l, m, rays, n, true, slack);
}

/* The lit colour, without what it mirrors. */
static void light(const lab *l, const met *m, double rgb[3], double *slack) {
    const double ambient = (double)l->scene.ambient;
    double unsure;
    const double open = of_surroundings(l, m, &unsure);
    *slack = ambient * unsure;
    for (int c = 0; c < 3; c++)
        rgb[c] = open * ambient * (double)m->look->rgb[c];
    for (int q = 0; q < l->scene.light_count; q++) {
        double n_l;
        const double share = of_light(l, m, q, &n_l, &unsure);
        *slack += n_l * unsure;
        for (int c = 0; c < 3; c++)
            rgb[c] += share * (1 - ambient) * n_l * (double)l->scene.lights[q].rgb[c] *
                      (double)m->look->rgb[c];
    }
}

static colour look_along(const lab *l, leafcast_ray r, int depth, double weight);

/* Where light goes at a surface, and the share that is mirrored. */
typedef struct parting {
    double mirrored[3], refracted[3], share;
    bool fits;  /* each leads to its own side; */
    bool close; /* or hardly */
} parting;

static void mirror(const met *m, const double normal[3], double to[3]) {
    for (int a = 0; a < 3; a++)
        to[a] = 2 * dot(m->towards, normal) * normal[a] - m->towards[a];
    unit(to);
}

/* By angles. */
static parting part(const met *m, const double normal[3]) {
    const double index = (double)m->look->refraction;
    const double before = acos(fmin(1, dot(m->towards, normal)));
    const double sine = sin(before) * (m->entering ? 1 / index : index),
                 behind = asin(fmin(1, sine));
    parting p = {.share = 1, .close = fabs(sine - 1) < 1e-6};
    double across[3];
    mirror(m, normal, p.mirrored);
    p.close |= fabs(dot(p.mirrored, m->side)) < 1e-6;
    p.fits = dot(p.mirrored, m->side) > 0;
    if (sine >= 1)
        return p;
    for (int a = 0; a < 3; a++)
        across[a] = cos(before) * normal[a] - m->towards[a];
    if (before > 0)
        unit(across);
    for (int a = 0; a < 3; a++)
        p.refracted[a] = sin(behind) * across[a] - cos(behind) * normal[a];
    const double s = sin(before - behind) / sin(before + behind),
                 t = tan(before - behind) / tan(before + behind);
    p.share = (s * s + t * t) / 2;
    p.close |= fabs(dot(p.refracted, m->side)) < 1e-6;
    p.fits &= dot(p.refracted, m->side) < 0;
    return p;
}

/* Add what is seen from the surface along a ray. */
static void add_seen(const lab *l, const met *m, const double to[3], int depth, double weight,
                     double share, double rgba[4], colour *into) {
    const colour seen = look_along(l, ray_of(m->at, to, START, INFINITY), depth + 1, weight);
    for (int c = 0; c < 4; c++)
        rgba[c] += share * seen.rgba[c];
    into->slack += seen.slack;
    into->unclear |= seen.unclear;
}

static bool near_least(double weight) {
    return fabs(weight * 4096 - 1) < 1e-3;
}

/* The colour of a surface, of which at most `weight` is seen. Returns whether all that is behind it
 * is in `behind`. */
static bool colour_of(const lab *l, const met *m, int depth, double weight, double rgb[3],
                      double behind[4], colour *into) {
    double slack, seen[4] = {0};
    light(l, m, rgb, &slack);
    into->slack += slack;
    if (depth == l->scene.bounces)
        return false;
    const double least = 1.0 / 4096, opacity = (double)m->look->opacity,
                 reflects = (double)m->look->reflectivity, own = weight * opacity * reflects,
                 clear = weight * (1 - opacity);
    parting p = {.share = 0};
    bool bends = m->look->refraction > 0 && clear > least;
    into->unclear |= m->look->refraction > 0 && near_least(clear);
    if (bends) {
        p = part(m, m->normal);
        into->unclear |= p.close;
        if (!p.fits)
            p = part(m, m->side);
        into->unclear |= p.close;
        bends = p.fits;
    }
    if (!bends) {
        p.share = 0;
        mirror(m, m->normal, p.mirrored);
    } else {
        into->unclear |= near_least(clear * (1 - p.share)) || near_least(own + clear * p.share);
        p.share = clear * (1 - p.share) <= least ? 1 : own + clear * p.share <= least ? 0 : p.share;
    }
    const double counts = own + clear * p.share, along = dot(p.mirrored, m->side);
    into->unclear |= counts > 0 && (near_least(counts) || fabs(along) < 1e-6);
    if (counts > least && along >= 0) {
        add_seen(l, m, p.mirrored, depth, counts, 1, seen, into);
        for (int c = 0; c < 4; c++)
            behind[c] = p.share * seen[c];
        for (int c = 0; c < 3; c++) {
            seen[c] += (1 - seen[3]) * (double)(l->scene.background[3] * l->scene.background[c]);
            rgb[c] = (1 - reflects) * rgb[c] + reflects * seen[c];
        }
    }
    if (bends && p.share < 1)
        add_seen(l, m, p.refracted, depth, clear * (1 - p.share), 1 - p.share, behind, into);
    return bends;
}

/* All that a ray sees, without the background. */
static colour look_along(const lab *l, leafcast_ray r, int depth, double weight) {
    colour out = {.slack = 0};
    double through = 1;
    for (int layer = 0; layer < LAYERS && through > 1.0 / 4096; layer++) {
        leafcast_ray_hit h, of_cell;
        double rgb[3], behind[4] = {0};
        assert_int_equal(leafcast_trace_rays(l->volume, &l->scene, &r, 1, &h), LEAFCAST_OK);
        assert_int_equal(leafcast_trace_rays(l->volume, &l->cells, &r, 1, &of_cell), LEAFCAST_OK);
        if (!(h.t < INFINITY))
            break;
        out.unclear |= depth > 0 && layer == 0 && h.t < CLOSE;
        const met m = met_of(l, &r, &h, &of_cell);
        const bool bent = colour_of(l, &m, depth, weight * through, rgb, behind, &out);
        const double opacity = (double)m.look->opacity;
        for (int c = 0; c < 4; c++)
            out.rgba[c] += through * (opacity * (c < 3 ? rgb[c] : 1) + (1 - opacity) * behind[c]);
        through *= 1 - opacity;
        if (bent)
            break;
        r.t0 = h.t + 1e-9;
    }
    return out;
}

/* All that is seen through a pixel. */
static colour look_at_all(const lab *l, leafcast_ray r) {
    colour out = look_along(l, r, 0, 1);
    for (int c = 0; c < 3; c++)
        out.rgba[c] +=
            (1 - out.rgba[3]) * (double)(l->scene.background[3] * l->scene.background[c]);
    return out;
}

/* ---- Scenes ---- */

enum { GRID, MESH, BOTH, CENTRAL, CLIPPED, KINDS };

static const char *const NAMES[KINDS] = {"grid", "mesh", "both", "central differences", "clipped"};

static void set_lights(leafcast_scene *scene) {
    scene->light_count = 3;
    scene->lights[0] = (leafcast_light){false, {1, 0.4, 2}, {0.8f, 0.7f, 0.6f}, 7};
    scene->lights[1] = (leafcast_light){true, {60, -20, 50}, {0.3f, 0.4f, 0.5f}, 9};
    scene->lights[2] = (leafcast_light){true, {17, 16, 40}, {0.2f, 0.1f, 0.1f}, 0};
    scene->shadows = true;
    scene->light_samples = 5;
    scene->ambient = 0.4f;
    scene->occlusion = 9;
    scene->occlusion_samples = 7;
    scene->bounces = 2;
    scene->background[0] = 0.2f;
    scene->background[2] = 0.5f;
    scene->background[3] = 1;
}

/* Of kind, all surfaces opaque or not. */
static void set_lab(lab *l, scene_pair *v, int kind, bool opaque) {
    for (int i = 0; i < 3; i++) {
        l->surfaces[i] = i < 2 ? scene_stage_grid[i] : scene_stage_mesh;
        l->surfaces[i].opacity = opaque ? 1 : i == 1 ? 0.9f : 0.6f;
        l->surfaces[i].reflectivity = 0.3f + 0.2f * (float)i;
        l->surfaces[i].refraction = i == 1 ? 0 : i == 0 ? 1.5f : 0.8f;
    }
    v->shown[0].surfaces = l->surfaces;
    v->shown[1].surfaces = l->surfaces + 2;
    leafcast_scene *scene = &v->scene;
    scene->volume_count = kind == BOTH ? 2 : 1;
    scene->volumes = &v->shown[kind == MESH];
    if (kind == MESH)
        l->surfaces[0] = l->surfaces[2];
    if (kind == MESH)
        v->shown[1].surfaces = l->surfaces;
    scene->clip_box = kind == CLIPPED;
    for (int a = 0; a < 3; a++) {
        scene->clip_min[a] = 9 - a;
        scene->clip_max[a] = 33 - a;
    }
    set_lights(scene);
    scene->analytic_normals = kind != CENTRAL && kind != MESH;
    l->volume = v->volume[kind == MESH];
    l->scene = l->cells = *scene;
    l->cells.analytic_normals = kind != MESH;
}

typedef struct tally {
    int judged, unclear, shaded;
    double slack;
} tally;

static void judge(lab *l, const leafcast_camera *c, const picture *p, const char *what, tally *n) {
    for (int i = 0; i < PICTURE_PIXELS; i += STEP) {
        double o[3], d[3];
        l->x = (uint32_t)(i % PICTURE_WIDTH);
        l->y = (uint32_t)(i / PICTURE_WIDTH);
        if (p->id[i] < 0)
            continue;
        leafcast_pixel_ray(c, l->x + 0.5, l->y + 0.5, o, d);
        const colour want = look_at_all(l, ray_of(o, d, 0, INFINITY));
        n->unclear += want.unclear;
        if (want.unclear)
            continue;
        n->judged++;
        n->slack += want.slack;
        for (int k = 0; k < 3; k++) {
            const double off = fabs((double)p->rgba[k][i] - want.rgba[k]);
            if (off > 2e-5 + 1.0001 * want.slack)
                fail_msg("%s, pixel %u, %u, channel %d: %.7f, not %.7f (slack %g)", what, l->x,
                         l->y, k, (double)p->rgba[k][i], want.rgba[k], want.slack);
        }
    }
}

static void pixels_are_what_rays_say(void **state) {
    static picture p;
    const leafcast_camera c = scene_stage_view(68);
    for (int kind = 0; kind < KINDS; kind++) {
        for (int opaque = 0; opaque < 2; opaque++) {
            scene_pair v;
            lab l;
            tally n = {0};
            leafcast_stats stats = {.size = sizeof stats};
            scene_stage_open(&v, *state, NULL, 0);
            set_lab(&l, &v, kind, opaque);
            pictures_draw(l.volume, &l.scene, &c, &p, &stats);
            judge(&l, &c, &p, NAMES[kind], &n);
            print_message("%s, %s: %d pixels judged, mean slack %.4f; %d unclear\n", NAMES[kind],
                          opaque ? "opaque" : "transparent", n.judged, n.slack / n.judged,
                          n.unclear);
            assert_true(n.judged >= 150 / STEP && n.unclear * 20 < n.judged);
            assert_true(n.slack < 0.01 * n.judged);
            assert_true(stats.mirrored_rays > 0 && stats.occlusion_rays > 0);
            assert_true((stats.refracted_rays > 0) == !opaque);
            assert_int_equal(stats.rays, stats.primary_rays + stats.shadow_rays +
                                             stats.occlusion_rays + stats.mirrored_rays +
                                             stats.refracted_rays);
            scene_stage_close(&v);
        }
    }
}

/* ---- The same bits ---- */

static void draw_slices(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *c,
                        picture *p) {
    leafcast_frame *frame;
    const leafcast_image image = {.size = sizeof image,
                                  .r = p->rgba[0],
                                  .g = p->rgba[1],
                                  .b = p->rgba[2],
                                  .a = p->rgba[3],
                                  .z = p->z,
                                  .normal = {p->normal[0], p->normal[1], p->normal[2]},
                                  .id = p->id};
    assert_int_equal(leafcast_frame_begin(volume, scene, c, &image, &frame), LEAFCAST_OK);
    for (bool done = false; !done;)
        assert_int_equal(leafcast_frame_advance(frame, 0, &done, NULL), LEAFCAST_OK);
    leafcast_frame_end(frame);
}

/* Four parts, each a picture of its own. */
static void draw_parts(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *c,
                       picture *p) {
    for (uint32_t k = 0; k < 4; k++) {
        const uint32_t x = k % 2 * 31, y = k / 2 * 17;
        const size_t at = (size_t)PICTURE_WIDTH * y + x;
        const leafcast_image image = {
            .size = sizeof image,
            .r = p->rgba[0] + at,
            .g = p->rgba[1] + at,
            .b = p->rgba[2] + at,
            .a = p->rgba[3] + at,
            .z = p->z + at,
            .normal = {p->normal[0] + at, p->normal[1] + at, p->normal[2] + at},
            .id = p->id + at,
            .x = x,
            .y = y,
            .width = k % 2 ? PICTURE_WIDTH - 31 : 31,
            .height = k / 2 ? PICTURE_HEIGHT - 17 : 17,
            .stride = PICTURE_WIDTH};
        assert_int_equal(leafcast_trace(volume, scene, c, &image, NULL, NULL, NULL), LEAFCAST_OK);
    }
}

typedef struct way {
    const char *name, *isa;
    int threads;
    uint32_t treelets;
    void (*draw)(leafcast *volume, const leafcast_scene *scene, const leafcast_camera *c,
                 picture *p);
} way;

static const way WAYS[] = {{"one thread", "scalar", 1, 0, NULL},
                           {"two threads", NULL, 2, 0, NULL},
                           {"four threads, one treelet", NULL, 4, 1, NULL},
                           {"one treelet, scalar", "scalar", 1, 1, NULL},
                           {"slices", NULL, 2, 2, draw_slices},
                           {"parts", NULL, 2, 0, draw_parts}};

static void other_ways_have_the_same_bits(void **state) {
    static picture want, got;
    const leafcast_camera c = scene_stage_view(150);
    static const leafcast_transfer_point points[] = {{0.2, {0.9, 0.8, 0.1}, 0.02},
                                                     {0.9, {0.1, 0.8, 0.9}, 0.05}};
    const leafcast_medium media[2] = {{points, 2}, {NULL, 0}};
    for (int look = 0; look < 3; look++) { /* surfaces; with four rays a pixel; in a medium */
        for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; i++) {
            const way *w = &WAYS[i];
            const leafcast_options o = {.size = sizeof o, .threads = w->threads, .isa = w->isa};
            scene_pair v;
            lab l;
            scene_stage_open(&v, *state, &o, w->treelets);
            set_lab(&l, &v, BOTH, false);
            l.scene.samples = look == 1 ? 4 : 1;
            l.scene.light_samples = l.scene.occlusion_samples = 2;
            l.scene.media = media;
            l.scene.media_count = look == 2 ? 2 : 0;
            for (int k = 0; k < 3 && look == 2; k++)
                l.surfaces[k].refraction = 0; /* not with media */
            memset(&got, 0, sizeof got);
            if (w->draw)
                w->draw(l.volume, &l.scene, &c, &got);
            else
                pictures_draw(l.volume, &l.scene, &c, i == 0 ? &want : &got, NULL);
            if (i > 0 && memcmp(want.rgba, got.rgba, sizeof want.rgba) != 0)
                fail_msg("look %d, %s: other colours", look, w->name);
            if (i > 0)
                scene_stage_same(&want, &got);
            scene_stage_close(&v);
        }
    }
}

/* A medium that lets all light through changes nothing but the last bits. */
static void clear_media_do_not_show(void **state) {
    static picture want, got;
    const leafcast_camera c = scene_stage_view(110);
    static const leafcast_transfer_point points[] = {{0.2, {0.9, 0.8, 0.1}, 0}};
    const leafcast_medium media[2] = {{points, 1}, {points, 1}};
    scene_pair v;
    lab l;
    scene_stage_open(&v, *state, NULL, 0);
    set_lab(&l, &v, BOTH, false);
    for (int i = 0; i < 3; i++)
        l.surfaces[i].refraction = 0;
    l.scene.media = media;
    for (int count = 1; count <= 2; count++) {
        l.scene.volume_count = l.scene.media_count = count;
        pictures_draw(l.volume, &l.scene, &c, &got, NULL);
        l.scene.media_count = 0;
        pictures_draw(l.volume, &l.scene, &c, &want, NULL);
        for (int i = 0; i < PICTURE_PIXELS; i++)
            for (int k = 0; k < 4; k++)
                assert_true(fabs((double)(got.rgba[k][i] - want.rgba[k][i])) < 2e-6 + 1.0 / 4096);
    }
    scene_stage_close(&v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pixels_are_what_rays_say),
        cmocka_unit_test(other_ways_have_the_same_bits),
        cmocka_unit_test(clear_media_do_not_show),
    };
    return cmocka_run_group_tests(tests, scene_stage_set, scene_stage_clear);
}
