/* mesh_shade_template.h - shades the hits of a tile's rays in a mesh as pixels; included by the
 * units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_SHADE_TEMPLATE_H
#define RENDER_MESH_MESH_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/flat/flat_points_template.h"
#include "render/frame/tile.h"
#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_normals_template.h"
#include "render/mesh/tet_smooth.h"

enum { TILE = MESH_TILE, TILE_WINDOWS = 0 }; /* for the templates that follow */

#include "render/tile/tile_shade_template.h"

/* Slots for the last tets: neighbouring rays hit the same ones. */
enum { KNOWN_TETS = 64 };

/* The tets that were hit, each with the first ray known to hit it. */
typedef struct hit_tets {
    unsigned count;
    uint16_t ray[TILE_RAYS];
    uint16_t of[TILE_RAYS]; /* index of a ray's tet in the list */
} hit_tets;

/* Scratch for the functions below. */
typedef struct mesh_shading {
    const tile_state *s;
    tile_pixels pixels;
    hit_tets tets;
    float normal[TILE_RAYS / VD_N][3][VD_N]; /* of the listed tets */
    /* Terms shared by all rays that hit a tet's isopolygon: */
    tet_smooth known[KNOWN_TETS];
    flat_facts facts[KNOWN_TETS];
    uint16_t facts_of[KNOWN_TETS]; /* the layer's list index of each slot's facts */
} mesh_shading;

static uint64_t mesh_cell_of(const frame *f, const tile_surface *s) {
    (void)f;
    return resident_mesh_of(s->at)->first_tet + s->local;
}

static bool mesh_less(const hit *a, const hit *b) {
    return flat_polygon_less(a, b);
}

static bool mesh_same(const hit *a, const hit *b) {
    return flat_polygon_double(a, b);
}

static const tile_order mesh_order = {mesh_cell_of, mesh_less, mesh_same};

static void list_tets(const tile_layer *s, hit_tets *l) {
    uint16_t known[KNOWN_TETS] = {0};
    l->count = 0;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!in_layer(s, i))
            continue;
        const tile_surface *x = surface_of(s, i);
        uint16_t *k = &known[(x->local + (unsigned)x->iso) % KNOWN_TETS];
        const tile_surface *first = *k < l->count ? surface_of(s, l->ray[*k]) : NULL;
        if (!first || first->local != x->local || first->at != x->at || first->iso != x->iso) {
            *k = (uint16_t)l->count;
            l->ray[l->count++] = (uint16_t)i;
        }
        l->of[i] = *k;
    }
}

static tet tet_of(const tile_layer *s, unsigned i) {
    return mesh_walk_tet(resident_mesh_of(surface_of(s, i)->at), surface_of(s, i)->local);
}

/* Make the normals of VD_N listed tets, from number `from` on. */
SIMD void faceted_normals(const tracer *tr, const tile_layer *s, const hit_tets *l, unsigned from,
                          float normal[3][VD_N]) {
    tet_columns columns;
    tet tets[VD_N];
    for (unsigned k = 0; k < VD_N; k++) {
        tets[k] = tet_of(s, l->ray[from + k]);
        tet_columns_put(&columns, k, &tets[k]);
    }
    for (unsigned left = ~tet_normals_of(&columns, normal) & ((1u << VD_N) - 1u); left;
         left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        float of[3];
        tet_normal(&tets[k], tr->isos.isovalues[surface_of(s, l->ray[from + k])->iso], of);
        for (int a = 0; a < 3; a++)
            normal[a][k] = of[a];
    }
}

/* Replace faceted normals by smooth ones where gradients at the vertices give any. */
static void smooth_normals(mesh_shading *m, const tile_layer *l, tile_normals normal) {
    const tile_state *s = m->s;
    uint16_t made[KNOWN_TETS];
    bool has[KNOWN_TETS];
    memset(made, 0xff, sizeof made);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!in_layer(l, i))
            continue;
        const unsigned k = m->tets.of[i] % KNOWN_TETS;
        if (made[k] != m->tets.of[i]) {
            const tet x = tet_of(l, i);
            const double iso = s->f->tracer->isos.isovalues[surface_of(l, i)->iso];
            isopolygon g;
            float gradients[4][3];
            const tile_surface *y = surface_of(l, i);
            mesh_walk_gradients(resident_mesh_of(y->at), y->local, gradients);
            made[k] = m->tets.of[i];
            has[k] = isopolygon_of(&x, iso, &g);
            if (has[k])
                tet_smooth_of(&x, iso, &g, (const float(*)[3])gradients, &m->known[k]);
        }
        const double d[3] = {s->rays.d[0][i], s->rays.d[1][i], s->rays.d[2][i]};
        float smooth[3];
        if (has[k] &&
            tet_smooth_normal(&m->known[k], s->f->projection->eye, d, surface_of(l, i)->t, smooth))
            for (int a = 0; a < 3; a++)
                normal[a][i] = smooth[a];
    }
}

static void mesh_normals(void *work, const tile_layer *s, tile_normals normal) {
    mesh_shading *m = work;
    const tracer *tr = m->s->f->tracer;
    hit_tets *l = &m->tets;
    list_tets(s, l);
    memset(m->facts_of, 0xff, sizeof m->facts_of);
    for (unsigned n = l->count; n % VD_N; n++)
        l->ray[n] = l->ray[0];
    for (unsigned n = 0; n < l->count; n += VD_N)
        faceted_normals(tr, s, l, n, m->normal[n / VD_N]);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!in_layer(s, i))
            continue;
        for (int a = 0; a < 3; a++)
            normal[a][i] = m->normal[l->of[i] / VD_N][a][l->of[i] % VD_N];
    }
    if (mesh_rays_of(tr)->smooth)
        smooth_normals(m, s, normal);
}

/* Returns the facts of a surface's tet, made when first needed. */
static const flat_facts *facts_of(mesh_shading *m, const tile_layer *l, unsigned i) {
    const unsigned of = m->tets.of[i], k = of % KNOWN_TETS;
    if (m->facts_of[k] != of) {
        const tet x = tet_of(l, i);
        m->facts_of[k] = (uint16_t)of;
        m->facts[k] = tet_facts_of(&x, m->s->f->tracer->isos.isovalues[surface_of(l, i)->iso]);
    }
    return &m->facts[k];
}

/* Of the rays `which`, a bit each from i on, returns the rays that hit the same isopolygon as ray
 * i + as. */
SIMD unsigned same_tet(const hit_tets *l, unsigned i, unsigned which, unsigned as) {
    unsigned same = 0;
    for (unsigned k = 0; k < VD_N; k++)
        same |= (unsigned)(l->of[i + k] == l->of[i + as]) << k;
    return same & which;
}

/* Gather the facts of VD_N rays' tets. The points get their errors later. */
SIMD void start_columns(mesh_shading *m, const tile_layer *l, unsigned i, unsigned which,
                        point_columns *c, surface_point to[]) {
    double t[VD_N] = {0.0};
    memset(c, 0, sizeof *c);
    for (unsigned left = which; left;) {
        const unsigned first = (unsigned)__builtin_ctz(left);
        const unsigned same = same_tet(&m->tets, i, left, first);
        const flat_facts *f = facts_of(m, l, i + first);
        left &= ~same;
        point_columns_put(c, same, f);
        for (unsigned of = same; of; of &= of - 1) {
            const unsigned k = (unsigned)__builtin_ctz(of);
            to[__builtin_popcount(which & ((1u << k) - 1u))] = f->point;
            t[k] = surface_of(l, i + k)->t;
        }
    }
    c->t = d_load(t);
    for (int a = 0; a < 3; a++)
        c->d[a] = d_load(m->s->rays.d[a] + i);
}

/* Requires that mesh_normals() has listed the layer's tets. */
static void mesh_starts(void *work, const tile_layer *l, unsigned i, unsigned which,
                        surface_point to[]) {
    mesh_shading *m = work;
    double error[VD_N];
    point_columns c;
    start_columns(m, l, i, which, &c, to);
    point_errors(&c, m->s->f->projection->eye, error);
    for (unsigned left = which; left; left &= left - 1)
        to++->error = error[__builtin_ctz(left)];
}

static const tile_kind mesh_kind_of_tile = {mesh_normals, mesh_starts, NULL};

/* Call before the first walk. */
static void mesh_shade_begin(mesh_shading *m, const tile_state *s) {
    m->s = s;
}

/* Shade what a walk has found. */
static void mesh_shade(mesh_shading *m) {
    shade_walk(m->s, &mesh_kind_of_tile, m, &m->pixels);
}

/* Put the background behind the tile's pixels, and write them. m->s->out then says which pixels are
 * left to be traced one by one. */
static void mesh_shade_end(mesh_shading *m) {
    shade_behind_all(m->s->f, &m->pixels);
    write_tile(m->s, &m->pixels);
}

#endif
#endif
