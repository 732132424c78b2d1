/* tile_shade_template.h - turns what a tile's rays have found into pixels; included by the units of
 * an ISA (see formats/base/simd.h).
 *
 * Shades many pixels at a time, layer by layer. Each layer is composited behind the layers in front
 * of it. The operations are the same as in surface_at(), shade.h and surface_light.h, in the same
 * order.
 */
#ifndef RENDER_TILE_TILE_SHADE_TEMPLATE_H
#define RENDER_TILE_TILE_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/surface/shade.h"
#include "render/surface/surface_light.h"
#include "render/tile/tile_state_template.h"

typedef float tile_normals[3][TILE_RAYS];

typedef struct tile_pixels {
    unsigned count; /* TILE_RAYS; or TILE if nothing was found: all rows are like the first */
    /* Of the first layer: */
    double t[TILE_RAYS];
    int32_t id[TILE_RAYS]; /* -1: there is none */
    tile_normals normal;
    /* Of the layer that is being shaded: */
    tile_normals behind; /* its normals, unless it is the first layer */
    /* The unit directions to lights that are not points. */
    float towards[LEAFCAST_LIGHTS_MAX][3];
    /* With shadows: the share of each light that arrives, and the surfaces that it reaches. */
    float visibility[LEAFCAST_LIGHTS_MAX][TILE_RAYS];
    tile_row reaches[LEAFCAST_LIGHTS_MAX][TILE];
    /* Pixels whose surfaces are coloured by values that are not there yet: left to single rays. */
    tile_row unknown[TILE];
    lit_batch lit;
    uint16_t ray[RAY_BATCH]; /* ray of each surface in lit */
    /* Shadow rays so far; counted when the pixel is done. */
    uint16_t shadow_rays[TILE_RAYS], ill_conditioned[TILE_RAYS];
    /* Composited so far. */
    float rgba[4][TILE_RAYS];
} tile_pixels;

/* The part of shading that depends on the kind. normals: set the unit normals of a layer's
 * surfaces; normals of other pixels are undefined. starts: for shadows, write the points of
 * surfaces, without normals, one after the other; which: the rays, a bit each, of VD_N rays from i
 * on. colours: set the colours of surfaces by surface_colour(), of the rays `which` from i on;
 * NULL: there are none but those of surfaces as a whole (kind_tiles.colours). */
typedef struct tile_kind {
    void (*normals)(void *work, const tile_layer *l, tile_normals normal);
    void (*starts)(void *work, const tile_layer *l, unsigned i, unsigned which, surface_point to[]);
    void (*colours)(void *work, const tile_layer *l, unsigned i, unsigned which, float rgb[][3]);
} tile_kind;

SIMD vf dot_f(const vf a[3], const vf b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

SIMD vf power_f(vf x, int n) {
    vf result = f_set(1.0f);
    for (; n > 0; n >>= 1, x = x * x)
        if (n & 1)
            result = result * x;
    return result;
}

/* VF_N pixels while they are lit. rgb: the surface's colour; out: the light so far. */
typedef struct lit_pixels {
    vf normal[3], eye[3], rgb[3], out[3];
} lit_pixels;

/* Set the surfaces' unit normals, turned to the eye's side as in shade_point_of(). */
SIMD void lit_normals(const tile_state *s, unsigned i, tile_normals normal, lit_pixels *p) {
    for (int a = 0; a < 3; a++) {
        p->normal[a] = f_load(normal[a] + i);
        p->eye[a] = f_load(s->rays.towards_eye[a] + i);
    }
    const vf zero = f_set(0.0f), length = f_sqrt(dot_f(p->normal, p->normal));
    const vf turn = f_select(f_lt(dot_f(p->normal, p->eye), zero), f_set(-0.0f) - length, length);
    for (int a = 0; a < 3; a++)
        p->normal[a] = f_select(f_gt(length, zero), p->normal[a] / turn, p->eye[a]);
}

/* Set rgb[] to the colours of surfaces. Returns their opacities. */
SIMD vf looks_of(const tile_state *s, const tile_layer *l, unsigned i, unsigned hits, vf rgb[3]) {
    float of[4][VF_N];
    if (s->f->tracer->isos.count == 1) {
        const leafcast_surface *look = tile_look(s, 0);
        for (int c = 0; c < 3; c++)
            rgb[c] = f_set(look->rgb[c]);
        return f_set(look->opacity);
    }
    for (unsigned k = 0; k < VF_N; k++) {
        const leafcast_surface *look = tile_look(s, hits >> k & 1u ? surface_of(l, i + k)->iso : 0);
        for (int c = 0; c < 3; c++)
            of[c][k] = look->rgb[c];
        of[3][k] = look->opacity;
    }
    for (int c = 0; c < 3; c++)
        rgb[c] = f_load(of[c]);
    return f_load(of[3]);
}

/* Whether surfaces have other colours than those of surfaces as a whole. */
static bool has_colours(const tile_state *s, const tile_kind *kind) {
    const transfer *by_value = surface_look_of(s->f)->colours;
    const bool own = s->f->tracer->coloured || (by_value && by_value->spans > 0);
    return surface_lookup_of(s->f, 0) || (own && kind->colours);
}

static uint32_t pixel_of(const tile_state *s, unsigned i) {
    return (s->y0 + i / TILE) * s->f->width + s->x0 + i % TILE;
}

/* Set the colours of surfaces of the rays `which` from i on by another volume's values there, as
 * surface_ray.h does. */
static void colours_by(const tile_state *s, const surface_lookup *by, const tile_layer *l,
                       unsigned i, unsigned which, tile_pixels *p, float rgb[][3]) {
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), n = i + k;
        const tile_surface *x = surface_of(l, n);
        const hit h = {.t = x->t, .iso = x->iso};
        surface_point point;
        uint32_t wanted = LEAF_NO_TREELET;
        bool provisional = false;
        surface_value value;
        double at[3];
        if (p->unknown[n / TILE] >> n % TILE & 1u)
            continue;
        lit_at(s->f, pixel_of(s, n), x->t, at);
        if (!surface_value_at(s->f, by, at, &wanted, &provisional, &value) || provisional) {
            p->unknown[n / TILE] |= (tile_row)1 << n % TILE;
            continue;
        }
        surface_colour_by(s->f, 0, &h, &value, &point);
        memcpy(rgb[k], point.own, sizeof point.own);
    }
}

SIMD void colour_each(const tile_state *s, const tile_kind *kind, void *work, const tile_layer *l,
                      unsigned i, unsigned hits, tile_pixels *p, vf rgb[3]) {
    const surface_lookup *by = surface_lookup_of(s->f, 0);
    float each[VF_N][3], of[VF_N];
    memset(each, 0, sizeof each);
    if (by)
        colours_by(s, by, l, i, hits, p, each);
    else
        kind->colours(work, l, i, hits, each);
    for (int c = 0; c < 3; c++) {
        for (unsigned k = 0; k < VF_N; k++)
            of[k] = each[k][c];
        rgb[c] = f_load(of);
    }
}

/* Vector form of shade_point_of() and shade_ambient(). */
SIMD lit_pixels lit_begin(const tile_state *s, unsigned i, tile_normals normal, const vf rgb[3]) {
    const leafcast_scene *scene = surface_look_of(s->f)->scene;
    const bool flat = scene->shading == LEAFCAST_SHADING_FLAT;
    lit_pixels p;
    lit_normals(s, i, normal, &p);
    for (int c = 0; c < 3; c++) {
        p.rgb[c] = rgb[c];
        p.out[c] = f_set(flat ? 1.0f : scene->ambient) * rgb[c];
    }
    return p;
}

/* Vector form of shade_light(). */
SIMD void lit_add(const leafcast_scene *scene, const vf to[3], const float light[3], vf visibility,
                  lit_pixels *l) {
    const vf zero = f_set(0.0f), n_l = dot_f(l->normal, to);
    const mf reaches = f_gt(n_l, zero);
    const vf diffuse = visibility * (f_set(1.0f - scene->ambient) * n_l);
    if (scene->shading == LEAFCAST_SHADING_FLAT)
        return;
    for (int c = 0; c < 3; c++)
        l->out[c] = f_select(reaches, l->out[c] + diffuse * f_set(light[c]) * l->rgb[c], l->out[c]);
    if (scene->shading != LEAFCAST_SHADING_PHONG)
        return;
    const vf r_v = f_set(2.0f) * n_l * dot_f(l->normal, l->eye) - dot_f(to, l->eye);
    const vf shine =
        visibility * f_set(scene->specular) * power_f(f_min(r_v, f_set(1.0f)), scene->shininess);
    for (int c = 0; c < 3; c++)
        l->out[c] = f_select(mf_and(reaches, f_gt(r_v, zero)), l->out[c] + shine * f_set(light[c]),
                             l->out[c]);
}

/* Set to[] to the unit directions from surfaces to a light. */
SIMD void towards_light(const tile_state *s, const tile_layer *l, const tile_pixels *p, unsigned i,
                        unsigned hits, int light, vf to[3]) {
    const leafcast_light *of = &surface_look_of(s->f)->scene->lights[light];
    float towards[3][VF_N] = {{0.0f}};
    double at[3], direction[3];
    for (int a = 0; a < 3 && !of->point; a++)
        to[a] = f_set(p->towards[light][a]);
    if (!of->point)
        return;
    for (unsigned left = hits; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        light_towards(s->f, pixel_of(s, i + k), surface_of(l, i + k)->t, of, at, direction);
        for (int a = 0; a < 3; a++)
            towards[a][k] = (float)direction[a];
    }
    for (int a = 0; a < 3; a++)
        to[a] = f_load(towards[a]);
}

/* Set the directions to lights that are not points; each is the same from everywhere. */
static void aim_lights(const frame *f, tile_pixels *p) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    for (int k = 0; k < scene->light_count; k++) {
        double at[3], direction[3];
        light_towards(f, 0, 0.0, &scene->lights[k], at, direction);
        for (int a = 0; a < 3; a++)
            p->towards[k][a] = (float)direction[a];
    }
}

/* Shade a layer's surfaces, and composite them behind the layers in front, as shade_composite()
 * does. */
SIMD void shade_surfaces(const tile_state *s, const tile_kind *kind, void *work,
                         const tile_layer *l, unsigned i, unsigned hits, tile_normals normal,
                         tile_pixels *p) {
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const leafcast_scene *scene = surface_look_of(s->f)->scene;
    const vf one = f_set(1.0f);
    vf rgb[3];
    const vf opacity = looks_of(s, l, i, hits, rgb);
    if (has_colours(s, kind))
        colour_each(s, kind, work, l, i, hits, p, rgb);
    lit_pixels lit = lit_begin(s, i, normal, rgb);
    if (scene->light_count == 0)
        lit_add(scene, lit.eye, white, one, &lit);
    for (int k = 0; k < scene->light_count; k++) {
        vf to[3];
        towards_light(s, l, p, i, hits, k, to);
        lit_add(scene, to, scene->lights[k].rgb,
                scene->shadows ? f_load(p->visibility[k] + i) : one, &lit);
    }
    const mf has = mf_of_bits(hits);
    const vf alpha = f_load(p->rgba[3] + i), weight = (one - alpha) * opacity;
    for (int c = 0; c < 3; c++) {
        const vf known = f_load(p->rgba[c] + i);
        f_store(p->rgba[c] + i, f_select(has, known + weight * lit.out[c], known));
    }
    f_store(p->rgba[3] + i, f_select(has, alpha + weight, alpha));
    for (int a = 0; a < 3; a++)
        f_store(normal[a] + i, f_select(has, f_load(normal[a] + i), f_set(0.0f)));
}

/* ---- Shadows ---- */

/* Side of a square of the tile whose surfaces fill a batch. */
enum { SQUARE = 16 };
_Static_assert(SQUARE *SQUARE <= RAY_BATCH && TILE % SQUARE == 0, "tiles are made of squares");

/* Find the surfaces of a layer that a light may reach: it is on the eye's side of them. The same
 * test as shade_reaches(), for whole vectors. */
static void find_reached(const tile_state *s, const tile_layer *l, int light, tile_normals normal,
                         tile_pixels *p) {
    const bool flat = surface_look_of(s->f)->scene->shading == LEAFCAST_SHADING_FLAT;
    tile_row *reaches = p->reaches[light];
    memset(reaches, 0, TILE * sizeof *reaches);
    for (unsigned i = 0; i < TILE_RAYS && !flat; i += VF_N) {
        const unsigned hits = hits_from(l, i, VF_N);
        lit_pixels lit;
        vf to[3];
        if (!hits)
            continue;
        lit_normals(s, i, normal, &lit);
        towards_light(s, l, p, i, hits, light, to);
        reaches[i / TILE] |= (mf_bits(f_gt(dot_f(lit.normal, to), f_set(0.0f))) & hits) << i % TILE;
    }
}

/* Vector form of lit_at(): compute the points of surfaces of VD_N rays. */
SIMD void surfaces_at(const tile_state *s, const tile_layer *l, unsigned i, unsigned which,
                      double at[3][VD_N]) {
    const camera *c = &s->f->camera;
    const double y = s->y0 + i / TILE + 0.5;
    double u[VD_N], t[VD_N];
    vd unit[3];
    for (unsigned k = 0; k < VD_N; k++) {
        u[k] = (2.0 * (s->x0 + i % TILE + k + 0.5) - c->middle[0]) / c->height;
        t[k] = which >> k & 1u ? surface_of(l, i + k)->t : 0.0;
    }
    ray_directions(c, d_load(u), d_set((c->middle[1] - 2.0 * y) / c->height), unit);
    for (int a = 0; a < 3; a++)
        d_store(at[a], d_set(c->eye[a]) + d_load(t) * unit[a]);
}

/* Add the surfaces of VD_N rays to the batch. */
static void list_surfaces(const tile_state *s, const tile_kind *kind, void *work,
                          const tile_layer *l, unsigned i, unsigned which, tile_pixels *p) {
    lit_batch *b = &p->lit;
    double at[3][VD_N];
    surfaces_at(s, l, i, which, at);
    kind->starts(work, l, i, which, b->point + b->count);
    for (unsigned left = which; left; left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left), n = b->count++;
        p->ray[n] = (uint16_t)(i + k);
        b->found[n] = tile_hit(s, surface_of(l, i + k));
        for (int a = 0; a < 3; a++)
            b->at[n][a] = at[a][k];
    }
}

/* Collect the surfaces of a square that some light reaches, of pixels that do not wait for a
 * treelet. */
static void list_square(const tile_state *s, const tile_kind *kind, void *work, const tile_layer *l,
                        unsigned first, tile_pixels *p) {
    const int lights = surface_look_of(s->f)->scene->light_count;
    p->lit.count = 0;
    for (unsigned y = first / TILE; y < first / TILE + SQUARE; y++) {
        tile_row left = 0;
        for (int k = 0; k < lights; k++)
            left |= p->reaches[k][y];
        left &= ~s->out->waits[y] & (((1u << SQUARE) - 1u) << first % TILE);
        for (unsigned x = first % TILE; x < first % TILE + SQUARE; x += VD_N) {
            const unsigned which = left >> x & ((1u << VD_N) - 1u);
            if (which)
                list_surfaces(s, kind, work, l, TILE * y + x, which, p);
        }
    }
}

static void trace_square(const tile_state *s, int light, tile_pixels *p) {
    lit_batch *b = &p->lit;
    for (unsigned n = 0; n < b->count; n++)
        b->reaches[n] = p->reaches[light][p->ray[n] / TILE] >> p->ray[n] % TILE & 1u;
    lit_batch_trace(s->f, b, &surface_look_of(s->f)->scene->lights[light], s->out->batch,
                    s->out->batch_scratch, s->counters);
}

/* Take the visibility of a light. Pixels whose shadow rays need an absent treelet wait for it. */
static void take_visibility(const tile_state *s, int light, tile_pixels *p) {
    const lit_batch *b = &p->lit;
    for (unsigned k = 0; k < b->count; k++) {
        const unsigned i = p->ray[k];
        p->visibility[light][i] = b->visibility[k];
        p->shadow_rays[i] += b->needed[k];
        p->ill_conditioned[i] += b->ill_conditioned[k];
        if (!b->undone[k])
            continue;
        s->out->waits[i / TILE] |= (tile_row)1 << i % TILE;
        if (b->absent[k] != LEAF_NO_TREELET)
            tile_absent(s->out, b->absent[k], (uint16_t)(light + 1));
    }
}

/* Find how much of each light arrives at a layer's surfaces. */
static void shadow_layer(const tile_state *s, const tile_kind *kind, void *work,
                         const tile_layer *l, tile_normals normal, tile_pixels *p) {
    const int lights = surface_look_of(s->f)->scene->light_count;
    for (int k = 0; k < lights; k++)
        find_reached(s, l, k, normal, p);
    for (unsigned y = 0; y < TILE; y += SQUARE) {
        for (unsigned x = 0; x < TILE; x += SQUARE) {
            list_square(s, kind, work, l, TILE * y + x, p);
            for (int k = 0; k < lights && p->lit.count > 0; k++) {
                trace_square(s, k, p);
                take_visibility(s, k, p);
            }
        }
    }
}

/* ---- Layers ---- */

static void shade_layer(const tile_state *s, const tile_kind *kind, void *work, int k,
                        tile_pixels *p) {
    const leafcast_scene *scene = surface_look_of(s->f)->scene;
    const tile_layer layer = {s, (unsigned)k}, *l = &layer;
    float(*normal)[TILE_RAYS] = s->before + k == 0 ? p->normal : p->behind;
    kind->normals(work, l, normal);
    if (scene->shadows && scene->light_count > 0)
        shadow_layer(s, kind, work, l, normal, p);
    for (unsigned i = 0; i < TILE_RAYS; i += VF_N) {
        const unsigned hits = hits_from(l, i, VF_N);
        if (hits)
            shade_surfaces(s, kind, work, l, i, hits, normal, p);
    }
}

/* Clear the pixels before the first layer. */
static void pixels_begin(const tile_state *s, tile_pixels *p) {
    p->count = s->deepest > 0 ? TILE_RAYS : TILE;
    for (int c = 0; c < 4; c++)
        memset(p->rgba[c], 0, p->count * sizeof p->rgba[c][0]);
    for (int a = 0; a < 3; a++)
        memset(p->normal[a], 0, p->count * sizeof p->normal[a][0]);
    memset(p->unknown, 0, sizeof p->unknown);
    memset(p->shadow_rays, 0, p->count * sizeof p->shadow_rays[0]);
    memset(p->ill_conditioned, 0, p->count * sizeof p->ill_conditioned[0]);
}

static void keep_first(const tile_state *s, tile_pixels *p) {
    const tile_layer l = {s, 0};
    for (unsigned i = 0; i < p->count; i++) {
        const bool any = s->deepest > 0 && in_layer(&l, i);
        p->t[i] = any ? surface_of(&l, i)->t : (double)INFINITY;
        p->id[i] = any ? surface_of(&l, i)->iso : -1;
    }
}

/* Shade all that a walk has found. */
static void shade_walk(const tile_state *s, const tile_kind *kind, void *work, tile_pixels *p) {
    if (s->before == 0) {
        pixels_begin(s, p);
        keep_first(s, p);
        aim_lights(s->f, p);
    }
    for (int k = 0; k < s->deepest; k++)
        shade_layer(s, kind, work, k, p);
}

/* Vector form of shade_background(). */
static void shade_behind_all(const frame *f, tile_pixels *p) {
    const float *background = surface_look_of(f)->scene->background;
    for (unsigned i = 0; i < p->count; i += VF_N) {
        const vf alpha = f_load(p->rgba[3] + i);
        const vf weight = (f_set(1.0f) - alpha) * f_set(background[3]);
        for (int c = 0; c < 3; c++)
            f_store(p->rgba[c] + i, f_load(p->rgba[c] + i) + weight * f_set(background[c]));
        f_store(p->rgba[3] + i, alpha + weight);
    }
}

/* ---- Writing ---- */

/* Copy the pixels of a row of the tile. Streams whole cache lines, which then need not be read
 * first. */
static void write_floats(float *to, const float *from, unsigned pixels) {
    enum { LINE = 64 };
    _Static_assert(TILE * sizeof(float) % LINE == 0, "a tile's row is whole lines");
    if (pixels == row_full && (uintptr_t)to % LINE == 0) {
        for (unsigned x = 0; x < TILE; x += VF_N)
            f_stream(to + x, f_load(from + x));
        return;
    }
    if (pixels == row_full) {
        memcpy(to, from, TILE * sizeof *to);
        return;
    }
    for (; pixels; pixels &= pixels - 1)
        to[__builtin_ctz(pixels)] = from[__builtin_ctz(pixels)];
}

/* Write t, id and provisional of a row's first surfaces. */
static void write_first(const leafcast_image *image, size_t to, unsigned pixels,
                        const tile_pixels *p, unsigned from) {
    if (pixels == row_full) {
        if (image->z)
            memcpy(image->z + to, p->t + from, TILE * sizeof *image->z);
        if (image->id)
            memcpy(image->id + to, p->id + from, TILE * sizeof *image->id);
        if (image->provisional)
            memset(image->provisional + to, 0, TILE * sizeof *image->provisional);
        return;
    }
    for (unsigned left = pixels; left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left);
        if (image->z)
            image->z[to + x] = p->t[from + x];
        if (image->id)
            image->id[to + x] = p->id[from + x];
        if (image->provisional)
            image->provisional[to + x] = 0;
    }
}

/* Write the planes of the first surface, and the colours, of the pixels of row y. They lie in *p
 * from `from` on. */
static void write_row(const tile_state *s, unsigned y, unsigned pixels, const tile_pixels *p,
                      unsigned from) {
    const leafcast_image *image = &s->f->image;
    const size_t row = (size_t)(s->y0 + y) * s->f->stride + s->x0;
    float *const colours[4] = {image->r, image->g, image->b, image->a};
    write_first(image, row, pixels, p, from);
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            write_floats(image->normal[a] + row, p->normal[a] + from, pixels);
    for (int c = 0; c < 4; c++)
        if (colours[c])
            write_floats(colours[c] + row, p->rgba[c] + from, pixels);
}

static void count_done(const tile_state *s, const tile_pixels *p, unsigned from, unsigned done) {
    ray_counters *counters = s->counters;
    unsigned found = 0;
    for (unsigned x = 0; x < TILE; x += VD_N)
        found |= md_bits(d_lt(d_load(p->t + from + x), d_set(INFINITY))) << x;
    counters->covered_pixels += (unsigned)__builtin_popcount(done & found);
    if (!surface_look_of(s->f)->scene->shadows)
        return;
    for (unsigned left = done & found; left; left &= left - 1) {
        const unsigned i = from + (unsigned)__builtin_ctz(left);
        counters->shadow_rays += p->shadow_rays[i];
        counters->ill_conditioned += p->ill_conditioned[i];
    }
}

/* Write the pixels that are done. The outcome tells of the rest. */
static void write_tile(const tile_state *s, const tile_pixels *p) {
    tile_outcome *out = s->out;
    for (unsigned y = 0; y < TILE; y++) {
        const tile_row alone = s->rays.single[y] | (p->unknown[y] & s->asked[y]);
        const unsigned done = s->asked[y] & ~(alone | out->waits[y]);
        const unsigned from = p->count == TILE_RAYS ? TILE * y : 0;
        out->open[y] = alone & ~out->waits[y];
        count_done(s, p, from, done);
        write_row(s, y, done, p, from);
    }
    f_stream_end();
}

#endif
#endif
