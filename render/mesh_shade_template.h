/* mesh_shade_template.h - what rays of a tile have found in a mesh, as pixels; included by the
 * units of an ISA (see formats/base/simd.h). */
#ifndef RENDER_MESH_SHADE_TEMPLATE_H
#define RENDER_MESH_SHADE_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/mesh_walk.h"
#include "render/tet_smooth.h"
#include "render/tile.h"

enum { TILE = MESH_TILE }; /* of the templates that follow */

#include "render/tile_shade_template.h"

/* Neighbouring rays hit the same tets. */
enum { KNOWN_TETS = 64 };

typedef struct known_tet {
    const treelet *at;
    uint32_t tet;
    int32_t iso;
    float normal[3];
    tet_smooth smooth; /* where normals are */
} known_tet;

/* What the rays have in common that hit a tet's isopolygon. */
static void know_tet(const tracer *tr, known_tet *k) {
    const tet x = mesh_walk_tet(k->at, k->tet);
    const double iso = tr->scene.isovalues[k->iso];
    isopolygon g;
    tet_normal(&x, iso, k->normal);
    if (tr->smooth_normals && isopolygon_of(&x, iso, &g)) {
        float gradients[4][3];
        mesh_walk_gradients(k->at, k->tet, gradients);
        tet_smooth_of(&x, iso, &g, (const float(*)[3])gradients, &k->smooth);
    }
}

/* tet_of: where in their treelets the tets lie that were hit. */
static void normals_of_tets(const tile_state *s, const uint32_t tet_of[TILE_RAYS], tile_pixels *p) {
    const tracer *tr = s->f->tracer;
    known_tet known[KNOWN_TETS];
    for (int k = 0; k < KNOWN_TETS; k++)
        known[k].at = NULL;
    for (unsigned i = 0; i < TILE_RAYS; i++) {
        if (!(s->t[i] < INFINITY))
            continue;
        known_tet *k = &known[(tet_of[i] + (unsigned)s->iso[i]) % KNOWN_TETS];
        if (k->at != s->at[i] || k->tet != tet_of[i] || k->iso != s->iso[i]) {
            k->at = s->at[i];
            k->tet = tet_of[i];
            k->iso = s->iso[i];
            know_tet(tr, k);
        }
        float normal[3] = {k->normal[0], k->normal[1], k->normal[2]};
        if (tr->smooth_normals) {
            const double d[3] = {s->rays.d[0][i], s->rays.d[1][i], s->rays.d[2][i]};
            (void)tet_smooth_normal(&k->smooth, s->f->projection->eye, d, s->t[i], normal);
        }
        for (int a = 0; a < 3; a++)
            p->normal[a][i] = normal[a];
    }
}

/* The tile's pixels, and its outcome. */
static void mesh_shade(const tile_state *s, const uint32_t tet_of[TILE_RAYS]) {
    tile_pixels pixels;
    clear_pixels(s->f, &pixels);
    const bool together = shaded_together(s->f);
    if (together) {
        normals_of_tets(s, tet_of, &pixels);
        shade_tile(s, &pixels);
    }
    write_tile(s, together, &pixels);
    for (unsigned i = 0; i < TILE_RAYS && !together; i++)
        if (s->out->found[i / TILE] >> i % TILE & 1u)
            s->out->hits[i].cell = s->at[i]->first_tet + tet_of[i];
}

#endif
#endif
