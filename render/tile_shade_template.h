/* tile_shade_template.h - what a tile's rays have found, as pixels; included by the units of an ISA
 * (see formats/base/simd.h).
 *
 * surface_at() and shade.h in the same order of operations, many pixels at a time. Here a frame has
 * one opaque surface a pixel and no shadows; others go pixel by pixel (surface_integrator.h).
 */
#ifndef RENDER_TILE_SHADE_TEMPLATE_H
#define RENDER_TILE_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/shade.h"
#include "render/surface_integrator.h"
#include "render/tile_state_template.h"

typedef struct tile_pixels {
    float normal[3][TILE_RAYS];
    float rgba[4][TILE_RAYS];
    int32_t id[TILE_RAYS];
} tile_pixels;

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

/* Pixels as the lights see them. */
typedef struct lit_pixels {
    vf normal[3], eye[3], rgb[3], out[3];
} lit_pixels;

static const leafcast_surface *tile_surfaces(const tile_state *s) {
    return surface_look_of(s->f)->surfaces[0];
}

/* shade_point_of() and shade_ambient(), VF_N pixels at a time. */
SIMD lit_pixels lit_begin(const tile_state *s, unsigned i, const tile_pixels *p) {
    const leafcast_scene *scene = surface_look_of(s->f)->scene;
    lit_pixels l;
    float rgb[3][VF_N];
    for (unsigned k = 0; k < VF_N; k++)
        for (int c = 0; c < 3; c++)
            rgb[c][k] = tile_surfaces(s)[p->id[i + k] < 0 ? 0 : p->id[i + k]].rgb[c];
    for (int a = 0; a < 3; a++) {
        l.normal[a] = f_load(p->normal[a] + i);
        l.eye[a] = f_load(s->rays.towards_eye[a] + i);
        l.rgb[a] = f_load(rgb[a]);
    }
    const vf zero = f_set(0.0f), length = f_sqrt(dot_f(l.normal, l.normal));
    const vf turn = f_select(f_lt(dot_f(l.normal, l.eye), zero), f_set(-0.0f) - length, length);
    for (int a = 0; a < 3; a++)
        l.normal[a] = f_select(f_gt(length, zero), l.normal[a] / turn, l.eye[a]);
    const bool flat = scene->shading == LEAFCAST_SHADING_FLAT;
    for (int c = 0; c < 3; c++)
        l.out[c] = f_set(flat ? 1.0f : scene->ambient) * l.rgb[c];
    return l;
}

/* shade_light() of a light that is seen. */
SIMD void lit_add(const leafcast_scene *scene, const vf to[3], const float light[3],
                  lit_pixels *l) {
    const vf zero = f_set(0.0f), n_l = dot_f(l->normal, to);
    const mf reaches = f_gt(n_l, zero);
    const vf diffuse = f_set(1.0f - scene->ambient) * n_l;
    if (scene->shading == LEAFCAST_SHADING_FLAT)
        return;
    for (int c = 0; c < 3; c++)
        l->out[c] = f_select(reaches, l->out[c] + diffuse * f_set(light[c]) * l->rgb[c], l->out[c]);
    if (scene->shading != LEAFCAST_SHADING_PHONG)
        return;
    const vf r_v = f_set(2.0f) * n_l * dot_f(l->normal, l->eye) - dot_f(to, l->eye);
    const vf shine = f_set(scene->specular) * power_f(f_min(r_v, f_set(1.0f)), scene->shininess);
    for (int c = 0; c < 3; c++)
        l->out[c] = f_select(mf_and(reaches, f_gt(r_v, zero)), l->out[c] + shine * f_set(light[c]),
                             l->out[c]);
}

/* The unit directions from surfaces to a light. */
SIMD void lit_towards(const tile_state *s, unsigned i, unsigned hits, const leafcast_light *light,
                      vf to[3]) {
    float towards[3][VF_N] = {{0.0f}};
    double direction[3];
    if (!light->point)
        surface_towards(s->f, 0, 0.0, light, direction);
    for (unsigned k = 0; k < VF_N; k++) {
        const unsigned at = i + k;
        if (light->point && (hits >> k & 1u))
            surface_towards(s->f, (s->y0 + at / TILE) * s->f->width + s->x0 + at % TILE, s->t[at],
                            light, direction);
        for (int a = 0; a < 3 && (!light->point || (hits >> k & 1u)); a++)
            towards[a][k] = (float)direction[a];
    }
    for (int a = 0; a < 3; a++)
        to[a] = f_load(towards[a]);
}

/* Colours of the pixels with surfaces: shade_composite() in front of shade_background(). */
SIMD void shade_pixels(const tile_state *s, unsigned i, unsigned hits, tile_pixels *p) {
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const leafcast_scene *scene = surface_look_of(s->f)->scene;
    const mf has = mf_of_bits(hits);
    float opacity[VF_N];
    for (unsigned k = 0; k < VF_N; k++) {
        p->id[i + k] = hits >> k & 1u ? s->iso[i + k] : -1;
        opacity[k] = tile_surfaces(s)[p->id[i + k] < 0 ? 0 : p->id[i + k]].opacity;
    }
    lit_pixels l = lit_begin(s, i, p);
    if (scene->light_count == 0)
        lit_add(scene, l.eye, white, &l);
    for (int k = 0; k < scene->light_count; k++) {
        vf to[3];
        lit_towards(s, i, hits, &scene->lights[k], to);
        lit_add(scene, to, scene->lights[k].rgb, &l);
    }
    const vf weight = f_load(opacity);
    const vf behind = (f_set(1.0f) - weight) * f_set(scene->background[3]);
    for (int c = 0; c < 3; c++) {
        const vf out = weight * l.out[c] + behind * f_set(scene->background[c]);
        f_store(p->rgba[c] + i, f_select(has, out, f_load(p->rgba[c] + i)));
        const vf normal = f_load(p->normal[c] + i);
        f_store(p->normal[c] + i, f_select(has, normal, f_set(0.0f)));
    }
    f_store(p->rgba[3] + i, f_select(has, weight + behind, f_load(p->rgba[3] + i)));
}

/* ---- Writing ---- */

/* Copy the pixels of a row of the tile. Whole lines of the cache need not be read first. */
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

/* The planes of the first surface, and the colours, of the pixels of a row. */
static void write_row(const tile_state *s, unsigned y, unsigned pixels, const tile_pixels *p) {
    const leafcast_image *image = &s->f->image;
    const size_t row = (size_t)(s->y0 + y) * s->f->stride + s->x0;
    const unsigned from = TILE * y;
    float *const colours[4] = {image->r, image->g, image->b, image->a};
    for (unsigned left = pixels; left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left);
        if (image->z)
            image->z[row + x] = s->t[from + x];
        if (image->id)
            image->id[row + x] = p->id[from + x];
        if (image->provisional)
            image->provisional[row + x] = 0;
    }
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            write_floats(image->normal[a] + row, p->normal[a] + from, pixels);
    for (int c = 0; c < 4; c++)
        if (colours[c])
            write_floats(colours[c] + row, p->rgba[c] + from, pixels);
}

/* What a pixel is without a surface. */
static void clear_pixels(const frame *f, tile_pixels *p) {
    float rgba[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    shade_background(rgba, surface_look_of(f)->scene->background);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        p->id[i] = -1;
        for (int a = 0; a < 3; a++)
            p->normal[a][i] = 0.0f;
        for (int c = 0; c < 4; c++)
            p->rgba[c][i] = rgba[c];
    }
}

/* Which of `count` pixels from i on have a surface. */
SIMD unsigned hits_from(const tile_state *s, unsigned i, unsigned count) {
    unsigned hits = 0;
    for (unsigned k = 0; k < count; k += VD_N)
        hits |= md_bits(d_lt(d_load(s->t + i + k), d_set(INFINITY))) << k;
    return hits;
}

/* Colours of the pixels that have a surface; their normals are there. */
static void shade_tile(const tile_state *s, tile_pixels *p) {
    for (unsigned i = 0; i < TILE_RAYS; i += VF_N) {
        const unsigned hits = hits_from(s, i, VF_N);
        if (hits)
            shade_pixels(s, i, hits, p);
    }
}

/* Whether a pixel is done with its first surface, and no light may be hidden from it. */
static bool shaded_together(const frame *f) {
    const leafcast_scene *scene = surface_look_of(f)->scene;
    return (scene->layers_max == 1 || surface_opaque(f)) &&
           (scene->light_count == 0 || !scene->shadows);
}

/* Write what is done; the rest is said in the outcome, but for the hits' cells. together: pixels
 * with a surface are done, too. */
static void write_tile(const tile_state *s, bool together, const tile_pixels *p) {
    tile_outcome *out = s->out;
    for (unsigned y = 0; y < TILE; y++) {
        unsigned found = 0;
        const unsigned left = s->rays.single[y] | out->waits[y];
        out->open[y] = s->rays.single[y];
        for (unsigned x = 0; x < TILE && !together; x++) {
            const unsigned i = TILE * y + x;
            if (!(s->t[i] < INFINITY) || left >> x & 1u)
                continue;
            found |= 1u << x;
            out->hits[i] = (hit){s->t[i], 0, s->iso[i], s->entering[i]};
            out->at[i] = s->at[i];
        }
        out->found[y] = found;
        const unsigned done = s->asked[y] & ~(left | found);
        s->counters->covered_pixels +=
            (unsigned)__builtin_popcount(done & hits_from(s, TILE * y, TILE));
        write_row(s, y, done, p);
    }
    f_stream_end();
}

#endif
#endif
