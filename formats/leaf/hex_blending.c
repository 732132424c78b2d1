#include "formats/leaf/hex_blending.h"

#include <assert.h>
#include <string.h>

#include "formats/leaf/block_blending.h"
#include "formats/leaf/hex_treelet.h"

/* ---- The directory ---- */

static status lay_out(leaf_file *f) {
    const leaf_layout *of = &f->below->layout;
    const bool fits =
        leaf_layout_blocks(&f->layout, f->geometry, of->treelets, 1,
                           block_blending_first_set(of) + LEAF_BETWEEN_SETS, leaf_layout_moves(of));
    assert(fits); /* checked */
    (void)fits;
    leaf_layout_keep_blocks(&f->layout);
    return ST_OK;
}

/* The sections of the kind's own; of boxes, where cells move, those of step 0, of which the tree
 * over treelets is made first. */
static status allocate(leaf_file *f) {
    const leaf_geometry *g = f->geometry;
    leaf_directory d = {0};
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++) {
        const uint64_t bytes = g->section_bytes(&f->header, kind),
                       from = g->section_bytes(&f->below->header, kind);
        void *to = g->section(f, kind);
        if (to && bytes > 0)
            memcpy(to, g->section(f->below, kind), bytes < from ? bytes : from);
    }
    return g->lay_out(f, &d);
}

/* ---- Payloads ---- */

/* Where cells move, payload t of a kind that lists no corners is places alone: those of step 0. */
static uint32_t alike(const leaf_layout *l, uint32_t p, const leaf_layout *of, uint32_t set) {
    const uint32_t q = block_blending_alike(l, p, of, set);
    return q == LEAF_NO_TREELET && !l->geometry->noded->listed ? p % l->treelets : q;
}

static hex_code code_of(const hex_treelet *h, uint32_t cell) {
    curved_cell c;
    hex_treelet_cell(h, cell, NULL, &c);
    return hex_code_of(curved_cell_sense(&c));
}

static void make_codes(const leaf_file *f, const leaf_mix *m, const float *const from[2]) {
    hex_treelet step[2], h = hex_treelet_of(f, m->treelet);
    h.topology = m->shared;
    h.places = (const float *)(const void *)m->payload;
    for (int i = 0; i < 2; i++) {
        step[i] = h;
        step[i].places = from[i];
    }
    for (uint32_t cell = 0; cell < h.cells; cell++) {
        const bool any = hex_treelet_code(&step[0], cell) != HEX_NONE &&
                         hex_treelet_code(&step[1], cell) != HEX_NONE;
        hex_treelet_write_code(&h, (float *)(void *)m->payload, cell,
                               any ? code_of(&h, cell) : HEX_NONE);
    }
}

/* Places at both steps, which are not the same. A topology begins with those of step 0. */
static void make_places(const leaf_file *f, const leaf_mix *m, uint32_t bytes) {
    const hex_treelet h = hex_treelet_of(f, m->treelet);
    const float *const from[2] = {m->part[0] ? (const float *)(const void *)m->part[0] : m->shared,
                                  (const float *)(const void *)m->part[1]};
    const size_t coordinates = 3 * (size_t)h.nodes;
    block_blending_mix(m, from[0], 0, coordinates);
    memset(m->payload + coordinates * sizeof(float), 0, bytes - coordinates * sizeof(float));
    if (f->geometry->noded->hexahedra)
        make_codes(f, m, from);
    if (f->geometry->noded->mix)
        f->geometry->noded->mix(&h, from, m->share, (float *)(void *)m->payload);
}

static void make_values(const leaf_file *f, const leaf_mix *m, uint32_t bytes) {
    const size_t nodes = hex_treelet_of(f, m->treelet).nodes;
    block_blending_mix(m, m->part[0], 0, nodes);
    memset(m->payload + nodes * sizeof(float), 0, bytes - nodes * sizeof(float));
}

static void make(const leaf_file *f, uint32_t p, const leaf_mix *m) {
    leaf_block block;
    const uint32_t bytes = hex_treelet_stored_bytes(&f->layout, p, &block);
    if (m->share == 0.0)
        memcpy(m->payload, m->part[0], bytes);
    else if (block == LEAF_BLOCK_VALUES)
        make_values(f, m, bytes);
    else
        make_places(f, m, bytes);
}

const leaf_blending hex_blending = {.blocks = 1 + 2 * (LEAF_BETWEEN_SETS + 1),
                                    .first_set = block_blending_first_set,
                                    .lay_out = lay_out,
                                    .allocate = allocate,
                                    .fill = block_blending_fill,
                                    .set_of = block_blending_set_of,
                                    .alike = alike,
                                    .beside = hex_treelet_beside,
                                    .make = make};
