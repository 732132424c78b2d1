/* tile_shade_template.h - what a tile's rays have found, as pixels; included by the units of an ISA
 * (see formats/base/simd.h).
 *
 * surface_at() and shade.h in the same order of operations, many pixels at a time. Here a frame has
 * one opaque surface a pixel and no shadows; others go pixel by pixel (pixel_ray.h).
 */
#ifndef RENDER_TILE_SHADE_TEMPLATE_H
#define RENDER_TILE_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/pixel_ray.h"
#include "render/shade.h"
#include "render/tile_walk_template.h"

typedef double four __attribute__((vector_size(32)));

SIMD four four_set(double a) {
    return (four){a, a, a, a};
}

SIMD four mix_four(four a, four b, double s) {
    return four_set(1.0 - s) * a + four_set(s) * b;
}

/* The gradients at the corners of the cells that were hit last: neighbouring rays share them. */
enum { KNOWN_CELLS = 32 };

typedef struct known_cell {
    const treelet *at;
    uint32_t cell[3];
    four gradients[8];
} known_cell;

typedef struct tile_pixels {
    double gradient[3][TILE_RAYS]; /* grid space */
    float normal[3][TILE_RAYS];
    float rgba[4][TILE_RAYS];
    int32_t id[TILE_RAYS];
} tile_pixels;

/* The gradients at the corners of the cell that ray i hit. */
static const four *corners_of(const tile_walk *w, unsigned i, known_cell *known) {
    const uint32_t *cell = w->cell[i];
    known_cell *k = &known[(cell[0] + 5 * cell[1] + 11 * cell[2]) % KNOWN_CELLS];
    if (k->at == w->at[i] && k->cell[0] == cell[0] && k->cell[1] == cell[1] &&
        k->cell[2] == cell[2])
        return k->gradients;
    double gradients[8][4];
    surface_gradients(&w->f->tracer->scene, w->at[i], cell, gradients);
    memcpy(k->gradients, gradients, sizeof gradients);
    k->at = w->at[i];
    for (int a = 0; a < 3; a++)
        k->cell[a] = cell[a];
    return k->gradients;
}

/* The gradients that the normals of VD_N pixels are taken from; lanes without a hit: any. */
SIMD void gradients_at(const tile_walk *w, unsigned i, unsigned hits, bool central,
                       known_cell *known, tile_pixels *p) {
    const walk_scene *scene = &w->f->tracer->scene;
    double lo[3][VD_N], inverse[3][VD_N], at[3][VD_N];
    for (unsigned k = 0; k < VD_N; k++) {
        for (int a = 0; a < 3; a++) {
            const bool has = hits >> k & 1u;
            const level_planes *planes = &scene->levels[has ? w->at[i + k]->level : 0];
            const uint32_t c = has ? w->cell[i + k][a] : 0;
            lo[a][k] = planes->at[a][c] - w->place.p->eye[a];
            inverse[a][k] = planes->inverse[a][c];
        }
    }
    for (int a = 0; a < 3; a++) {
        const vd u =
            (d_load(w->t + i) * d_load(w->rays.d[a] + i) - d_load(lo[a])) * d_load(inverse[a]);
        d_store(at[a], d_min(d_max(u, d_set(0.0)), d_set(1.0)));
    }
    for (unsigned k = 0; k < VD_N; k++) {
        double g[4] = {1.0, 1.0, 1.0, 0.0};
        const double x = at[0][k], y = at[1][k], z = at[2][k];
        if ((hits >> k & 1u) && central) {
            const four *c = corners_of(w, i + k, known);
            const four low = mix_four(mix_four(c[0], c[1], x), mix_four(c[2], c[3], x), y);
            const four high = mix_four(mix_four(c[4], c[5], x), mix_four(c[6], c[7], x), y);
            const four mixed = mix_four(low, high, z);
            memcpy(g, &mixed, sizeof g);
        } else if (hits >> k & 1u) {
            const double place[3] = {x, y, z};
            const double widths[3] = {inverse[0][k], inverse[1][k], inverse[2][k]};
            float samples[8];
            walk_cell_samples(scene, w->at[i + k], w->cell[i + k], samples);
            surface_trilinear(samples, place, widths, g);
        }
        for (int a = 0; a < 3; a++)
            p->gradient[a][i + k] = g[a];
    }
}

/* Unit normals against the gradients, VD_N at a time. Returns the lanes that have no such: gradient
 * zero or not finite. */
SIMD unsigned normals_of(const affine *space, tile_pixels *p, unsigned i) {
    vd grid[3], g[3], v[3];
    for (int a = 0; a < 3; a++)
        grid[a] = d_load(p->gradient[a] + i);
    for (int a = 0; a < 3; a++)
        g[a] = d_set(space->to_grid[0][a]) * grid[0] + d_set(space->to_grid[1][a]) * grid[1] +
               d_set(space->to_grid[2][a]) * grid[2];
    const vd largest = d_max(d_abs(g[0]), d_max(d_abs(g[1]), d_abs(g[2])));
    for (int a = 0; a < 3; a++)
        v[a] = g[a] / largest;
    const vd length = d_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        d_store_floats(p->normal[a] + i, (d_set(-0.0) - v[a]) / length);
    const vd sum = g[0] + g[1] + g[2], infinite = d_set(INFINITY);
    return ~md_bits(md_and(d_gt(largest, d_set(0.0)), d_lt(d_abs(sum), infinite)));
}

/* surface_at() by itself, where neighbours do not give a normal. */
static void normal_of_its_own(const tile_walk *w, unsigned i, tile_pixels *p) {
    const tracer *tr = w->f->tracer;
    ray r = {.t0 = w->rays.t0[i], .t1 = w->rays.t1[i]};
    for (int a = 0; a < 3; a++) {
        r.o[a] = r.held[a] = w->place.p->eye[a];
        r.d[a] = w->rays.d[a][i];
    }
    const hit h = {w->t[i], index_of(w, w->at[i], w->cell[i]), w->iso[i], w->entering[i]};
    const surface_point point =
        surface_at(&tr->scene, &tr->space, w->at[i], &r, &h, tr->analytic_normals);
    for (int a = 0; a < 3; a++)
        p->normal[a][i] = point.normal[a];
}

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

/* shade_point_of() and shade_ambient(), VF_N pixels at a time. */
SIMD lit_pixels lit_begin(const tile_walk *w, unsigned i, const tile_pixels *p) {
    const leafcast_scene *scene = w->f->scene;
    lit_pixels l;
    float rgb[3][VF_N];
    for (unsigned k = 0; k < VF_N; k++)
        for (int c = 0; c < 3; c++)
            rgb[c][k] = w->f->surfaces[p->id[i + k] < 0 ? 0 : p->id[i + k]].rgb[c];
    for (int a = 0; a < 3; a++) {
        l.normal[a] = f_load(p->normal[a] + i);
        l.eye[a] = f_load(w->rays.towards_eye[a] + i);
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
SIMD void lit_towards(const tile_walk *w, unsigned i, unsigned hits, const leafcast_light *light,
                      vf to[3]) {
    float towards[3][VF_N] = {{0.0f}};
    double direction[3];
    if (!light->point)
        pixel_ray_towards(w->f, 0, 0.0, light, direction);
    for (unsigned k = 0; k < VF_N; k++) {
        const unsigned at = i + k;
        if (light->point && (hits >> k & 1u))
            pixel_ray_towards(w->f, (w->y0 + at / TILE) * w->f->width + w->x0 + at % TILE, w->t[at],
                              light, direction);
        for (int a = 0; a < 3 && (!light->point || (hits >> k & 1u)); a++)
            towards[a][k] = (float)direction[a];
    }
    for (int a = 0; a < 3; a++)
        to[a] = f_load(towards[a]);
}

/* Colours of the pixels with surfaces: shade_composite() in front of shade_background(). */
SIMD void shade_pixels(const tile_walk *w, unsigned i, unsigned hits, tile_pixels *p) {
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const leafcast_scene *scene = w->f->scene;
    const mf has = mf_of_bits(hits);
    float opacity[VF_N];
    for (unsigned k = 0; k < VF_N; k++) {
        p->id[i + k] = hits >> k & 1u ? w->iso[i + k] : -1;
        opacity[k] = w->f->surfaces[p->id[i + k] < 0 ? 0 : p->id[i + k]].opacity;
    }
    lit_pixels l = lit_begin(w, i, p);
    if (scene->light_count == 0)
        lit_add(scene, l.eye, white, &l);
    for (int k = 0; k < scene->light_count; k++) {
        vf to[3];
        lit_towards(w, i, hits, &scene->lights[k], to);
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

/* Copy the pixels of a row of the tile. */
static void write_floats(float *to, const float *from, unsigned pixels) {
    if (pixels == UINT16_MAX) {
        memcpy(to, from, TILE * sizeof *to);
        return;
    }
    for (; pixels; pixels &= pixels - 1)
        to[__builtin_ctz(pixels)] = from[__builtin_ctz(pixels)];
}

/* The planes of the first surface, and the colours, of the pixels of a row. */
static void write_row(const tile_walk *w, unsigned y, unsigned pixels, const tile_pixels *p) {
    const leafcast_image *image = &w->f->image;
    const size_t row = (size_t)(w->y0 + y) * w->f->width + w->x0;
    const unsigned from = TILE * y;
    float *const colours[4] = {image->r, image->g, image->b, image->a};
    for (unsigned left = pixels; left; left &= left - 1) {
        const unsigned x = (unsigned)__builtin_ctz(left);
        if (image->z)
            image->z[row + x] = w->t[from + x];
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
    shade_background(rgba, f->scene->background);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        p->id[i] = -1;
        for (int a = 0; a < 3; a++)
            p->normal[a][i] = 0.0f;
        for (int c = 0; c < 4; c++)
            p->rgba[c][i] = rgba[c];
    }
}

/* Normals and colours of the pixels that have a surface. */
static void shade_tile(const tile_walk *w, tile_pixels *p) {
    const tracer *tr = w->f->tracer;
    const bool central = !tr->analytic_normals && tr->scene.halo > 0;
    known_cell known[KNOWN_CELLS];
    for (int k = 0; k < KNOWN_CELLS; k++)
        known[k].at = NULL;
    for (unsigned i = 0; i < TILE_RAYS; i += VF_N) {
        unsigned hits = 0;
        for (unsigned k = 0; k < VF_N; k++)
            hits |= (unsigned)(w->t[i + k] < INFINITY) << k;
        if (!hits)
            continue;
        for (unsigned k = 0; k < VF_N; k += VD_N) {
            const unsigned mine = hits >> k & ((1u << VD_N) - 1u);
            gradients_at(w, i + k, mine, central, known, p);
            for (unsigned bad = normals_of(&tr->space, p, i + k) & mine; bad; bad &= bad - 1)
                normal_of_its_own(w, i + k + (unsigned)__builtin_ctz(bad), p);
        }
        shade_pixels(w, i, hits, p);
    }
}

#endif
#endif
