/* mesh_shade_template.h - what rays of a tile have found in a mesh, as pixels; included by the
 * units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_MESH_SHADE_TEMPLATE_H
#define RENDER_MESH_MESH_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh/mesh_tile.h"
#include "render/mesh/mesh_tracer.h"
#include "render/mesh/mesh_walk.h"
#include "render/mesh/tet_normals_template.h"
#include "render/mesh/tet_smooth.h"
#include "render/tile.h"

enum { TILE = MESH_TILE, TILE_WINDOWS = 0 }; /* of the templates that follow */

#include "render/tile_shade_template.h"

/* Neighbouring rays hit the same tets: slots of the last ones. */
enum { KNOWN_TETS = 64 };

/* The tets that were hit, each by the first ray that is known to have done so. */
typedef struct hit_tets {
    unsigned count;
    uint16_t ray[TILE_RAYS];
    uint16_t of[TILE_RAYS]; /* a ray's place there */
} hit_tets;

/* Room for all that follows. */
typedef struct mesh_shading {
    tile_pixels pixels;
    hit_tets tets;
    float normal[TILE_RAYS / VD_N][3][VD_N]; /* of the tets */
    tet_smooth known[KNOWN_TETS]; /* what the rays have in common that hit a tet's isopolygon */
} mesh_shading;

static void list_tets(const tile_state *s, const uint32_t tet_of[TILE_RAYS], hit_tets *l) {
    uint16_t known[KNOWN_TETS] = {0};
    l->count = 0;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!(s->t[i] < INFINITY))
            continue;
        uint16_t *k = &known[(tet_of[i] + (unsigned)s->iso[i]) % KNOWN_TETS];
        const unsigned first = *k < l->count ? l->ray[*k] : i;
        if (*k >= l->count || tet_of[first] != tet_of[i] || s->at[first] != s->at[i] ||
            s->iso[first] != s->iso[i]) {
            *k = (uint16_t)l->count;
            l->ray[l->count++] = (uint16_t)i;
        }
        l->of[i] = *k;
    }
}

/* Of VD_N tets of the list, from the one at `from` on. */
SIMD void faceted_normals(const tile_state *s, const uint32_t tet_of[TILE_RAYS], const hit_tets *l,
                          unsigned from, float normal[3][VD_N]) {
    tet_columns columns;
    tet tets[VD_N];
    for (unsigned k = 0; k < VD_N; k++) {
        const unsigned i = l->ray[from + k];
        tets[k] = mesh_walk_tet(resident_mesh_of(s->at[i]), tet_of[i]);
        tet_columns_put(&columns, k, &tets[k]);
    }
    for (unsigned left = ~tet_normals_of(&columns, normal) & ((1u << VD_N) - 1u); left;
         left &= left - 1) {
        const unsigned k = (unsigned)__builtin_ctz(left);
        float of[3];
        tet_normal(&tets[k], s->f->tracer->isos.isovalues[s->iso[l->ray[from + k]]], of);
        for (int a = 0; a < 3; a++)
            normal[a][k] = of[a];
    }
}

/* Where gradients at the vertices give normals, they take the place of faceted ones. */
static void smooth_normals(const tile_state *s, const uint32_t tet_of[TILE_RAYS], mesh_shading *m) {
    const hit_tets *l = &m->tets;
    tile_pixels *p = &m->pixels;
    tet_smooth *known = m->known;
    uint16_t place[KNOWN_TETS];
    bool has[KNOWN_TETS];
    memset(place, 0xff, sizeof place);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!(s->t[i] < INFINITY))
            continue;
        const unsigned k = l->of[i] % KNOWN_TETS;
        if (place[k] != l->of[i]) {
            const tet x = mesh_walk_tet(resident_mesh_of(s->at[i]), tet_of[i]);
            const double iso = s->f->tracer->isos.isovalues[s->iso[i]];
            isopolygon g;
            float gradients[4][3];
            mesh_walk_gradients(resident_mesh_of(s->at[i]), tet_of[i], gradients);
            place[k] = l->of[i];
            has[k] = isopolygon_of(&x, iso, &g);
            if (has[k])
                tet_smooth_of(&x, iso, &g, (const float(*)[3])gradients, &known[k]);
        }
        const double d[3] = {s->rays.d[0][i], s->rays.d[1][i], s->rays.d[2][i]};
        float normal[3];
        if (has[k] && tet_smooth_normal(&known[k], s->f->projection->eye, d, s->t[i], normal))
            for (int a = 0; a < 3; a++)
                p->normal[a][i] = normal[a];
    }
}

/* tet_of: where in their treelets the tets lie that were hit. */
static void normals_of_tets(const tile_state *s, const uint32_t tet_of[TILE_RAYS],
                            mesh_shading *m) {
    hit_tets *l = &m->tets;
    list_tets(s, tet_of, l);
    for (unsigned n = l->count; n % VD_N; n++)
        l->ray[n] = l->ray[0];
    for (unsigned n = 0; n < l->count; n += VD_N)
        faceted_normals(s, tet_of, l, n, m->normal[n / VD_N]);
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!(s->t[i] < INFINITY))
            continue;
        for (int a = 0; a < 3; a++)
            m->pixels.normal[a][i] = m->normal[l->of[i] / VD_N][a][l->of[i] % VD_N];
    }
    if (mesh_rays_of(s->f->tracer)->smooth)
        smooth_normals(s, tet_of, m);
}

/* The tile's pixels, and its outcome. */
static void mesh_shade(const tile_state *s, const uint32_t tet_of[TILE_RAYS], mesh_shading *m) {
    clear_pixels(s->f, &m->pixels);
    const bool together = shaded_together(s->f);
    if (together) {
        normals_of_tets(s, tet_of, m);
        shade_tile(s, &m->pixels);
    }
    write_tile(s, together, &m->pixels);
    for (unsigned i = 0; i < TILE_RAYS && !together; i++)
        if (s->out->found[i / TILE] >> i % TILE & 1u)
            s->out->hits[i].cell = resident_mesh_of(s->at[i])->first_tet + tet_of[i];
}

#endif
#endif
