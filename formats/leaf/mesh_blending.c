/* mesh_blending.c - times between the steps of a mesh (leaf_blending.h): vertices and values are
 * blended, topologies stay.
 */
#include <string.h>

#include "formats/leaf/block_blending.h"
#include "formats/leaf/mesh_geometry.h"
#include "formats/leaf/mesh_layout.h"
#include "formats/mesh/mesh_refit.h"

/* ---- The directory ---- */

static status lay_out(leaf_file *f) {
    const leaf_layout *of = &f->below->layout;
    const mesh_layout_blocks blocks = {.treelets = of->treelets,
                                       .fields = 1,
                                       .steps = block_blending_first_set(of) + LEAF_BETWEEN_SETS,
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
    leaf_layout_keep_blocks(&f->layout);
    leaf_layout_set_counts(&f->layout, (const uint32_t(*)[4])to->counts);
    return ST_OK;
}

/* ---- Payloads ---- */

static void make_values(const leaf_file *f, const mesh_shape *s, const leaf_mix *m) {
    const size_t element = (size_t)m->set * f->layout.treelets + m->treelet;
    block_blending_mix(m, m->part[0] + s->values_at, s->values_at, s->vertices);
    mesh_refit_values(s, m->shared, f->own[element], !(f->flags[element] & LEAF_FLAG_NON_FINITE),
                      m->payload, m->scratch);
}

static void make_positions(const leaf_file *f, const mesh_shape *s, const leaf_mix *m) {
    const void *first =
        m->part[0] ? (const void *)(m->part[0] + s->moved_at) : mesh_leaf_positions(s, m->shared);
    block_blending_mix(m, first, s->moved_at, 3 * (size_t)s->vertices);
    mesh_refit_boxes(s, m->shared,
                     f->mesh->bounds[leaf_layout_bounds(&f->layout, m->set, m->treelet)],
                     m->payload, m->scratch);
}

static void make(const leaf_file *f, uint32_t p, const leaf_mix *m) {
    const mesh_shape s = mesh_leaf_shape(f->layout.counts[m->treelet]);
    uint32_t index;
    switch (leaf_layout_block_of(&f->layout, p, &index)) {
    case LEAF_BLOCK_VALUES: make_values(f, &s, m); break;
    case LEAF_BLOCK_GRADIENTS: block_blending_mix(m, m->part[0], 0, 3 * (size_t)s.vertices); break;
    default: make_positions(f, &s, m);
    }
}

const leaf_blending mesh_blending = {.blocks = 1 + 3 * (LEAF_BETWEEN_SETS + 1),
                                     .first_set = block_blending_first_set,
                                     .lay_out = lay_out,
                                     .allocate = allocate,
                                     .fill = block_blending_fill,
                                     .set_of = block_blending_set_of,
                                     .alike = block_blending_alike,
                                     .beside = mesh_layout_beside,
                                     .make = make};
