/* mesh_blending.c - times between the steps of a mesh (leaf_blending.h): vertices and values are
 * blended, topologies stay.
 *
 * Where vertices move, set 0 stands for no moment: as in any file, it has its vertices in the
 * topologies.
 */
#include <string.h>

#include "formats/leaf/leaf_blending.h"
#include "formats/leaf/mesh_geometry.h"
#include "formats/leaf/mesh_layout.h"
#include "formats/mesh/mesh_refit.h"

static uint32_t first_set(const leaf_layout *l) {
    return leaf_layout_moves(l) ? 1 : 0;
}

/* ---- The directory ---- */

static status lay_out(leaf_file *f) {
    const leaf_layout *of = &f->below->layout;
    const mesh_layout_blocks blocks = {.treelets = of->treelets,
                                       .fields = 1,
                                       .steps = first_set(of) + LEAF_BETWEEN_SETS,
                                       .gradients = of->gradient_sets > 0,
                                       .moving = leaf_layout_moves(of)};
    return mesh_layout_init(&f->layout, f->m, &blocks);
}

/* The boxes of set 0, of which the tree over treelets is made first, are those of step 0. */
static status allocate(leaf_file *f) {
    const mesh_directory *from = f->below->mesh;
    const size_t n = f->layout.treelets;
    mesh_directory *to = f->mesh;
    memcpy(to->counts, from->counts, n * sizeof *to->counts);
    memcpy(to->first_tet, from->first_tet, (n + 1) * sizeof *to->first_tet);
    memcpy(to->bounds, from->bounds, n * sizeof *to->bounds);
    mem_free(f->m, to->coarse); /* those of the file below are asked for (coarse_pair.h) */
    to->coarse = NULL;
    mesh_layout_keep_beside(&f->layout);
    mesh_layout_set_counts(&f->layout, (const uint32_t(*)[4])to->counts);
    return ST_OK;
}

/* A treelet's box is the blend of its boxes at both steps. It holds all blends of vertices, as they
 * are rounded: no blend turns the order of two coordinates round (blend_rows.h), so one that is not
 * below the lower planes at both steps is not below their blend. */
static void fill(leaf_file *f, uint32_t set, const uint32_t sets[2], double share) {
    const leaf_layout *l = &f->layout, *of = &f->below->layout;
    if (!leaf_layout_moves(l))
        return;
    for (uint32_t t = 0; t < l->treelets; t++) {
        const float *a =
            f->below->mesh->bounds[leaf_layout_bounds(of, leaf_layout_step(of, sets[0]), t)];
        const float *b =
            f->below->mesh->bounds[leaf_layout_bounds(of, leaf_layout_step(of, sets[1]), t)];
        float *to = f->mesh->bounds[leaf_layout_bounds(l, set, t)];
        for (int i = 0; i < 6; i++)
            to[i] = blend_sample(a[i], b[i], share) + 0.0F; /* no -0 */
    }
}

/* ---- Payloads ---- */

static uint32_t set_of(const leaf_layout *l, uint32_t p) {
    uint32_t index;
    return leaf_layout_block_of(l, p, &index) == LEAF_BLOCK_TOPOLOGY ? LEAF_NO_SET : index;
}

static uint32_t alike(const leaf_layout *l, uint32_t p, const leaf_layout *of, uint32_t set) {
    const uint32_t t = p % l->treelets, step = leaf_layout_step(of, set);
    uint32_t index;
    switch (leaf_layout_block_of(l, p, &index)) {
    case LEAF_BLOCK_VALUES: return leaf_layout_values(of, set, t);
    case LEAF_BLOCK_GRADIENTS: return leaf_layout_gradients(of, set, t);
    case LEAF_BLOCK_POSITIONS:
        return step > 0 ? leaf_layout_positions(of, step, t) : LEAF_NO_TREELET;
    default: return t;
    }
}

/* Blend `count` floats that lie `at` bytes from the start of their payloads. first: those of the
 * first step. */
static void blend(const leaf_mix *m, const void *first, uint32_t at, size_t count) {
    m->blend(first, m->part[1] ? m->part[1] + at : NULL, m->share, (float *)(m->payload + at),
             count);
}

static void make_values(const leaf_file *f, const mesh_shape *s, const leaf_mix *m) {
    const size_t element = (size_t)m->set * f->layout.treelets + m->treelet;
    blend(m, m->part[0] + s->values_at, s->values_at, s->vertices);
    mesh_refit_values(s, m->shared, f->own[element], !(f->flags[element] & LEAF_FLAG_NON_FINITE),
                      m->payload, m->scratch);
}

static void make_positions(const leaf_file *f, const mesh_shape *s, const leaf_mix *m) {
    const void *first =
        m->part[0] ? (const void *)(m->part[0] + s->moved_at) : mesh_leaf_positions(s, m->shared);
    blend(m, first, s->moved_at, 3 * (size_t)s->vertices);
    mesh_refit_boxes(s, m->shared,
                     f->mesh->bounds[leaf_layout_bounds(&f->layout, m->set, m->treelet)],
                     m->payload, m->scratch);
}

static void make(const leaf_file *f, uint32_t p, const leaf_mix *m) {
    const mesh_shape s = mesh_leaf_shape(f->layout.counts[m->treelet]);
    uint32_t index;
    switch (leaf_layout_block_of(&f->layout, p, &index)) {
    case LEAF_BLOCK_VALUES: make_values(f, &s, m); break;
    case LEAF_BLOCK_GRADIENTS: blend(m, m->part[0], 0, 3 * (size_t)s.vertices); break;
    default: make_positions(f, &s, m);
    }
}

const leaf_blending mesh_blending = {.blocks = 1 + 3 * (LEAF_BETWEEN_SETS + 1),
                                     .first_set = first_set,
                                     .lay_out = lay_out,
                                     .allocate = allocate,
                                     .fill = fill,
                                     .set_of = set_of,
                                     .alike = alike,
                                     .beside = mesh_layout_beside,
                                     .make = make};
