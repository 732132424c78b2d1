#include "formats/leaf/listed_geometry.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_place.h"

/* ---- The header ---- */

static const leaf_noded *noded_of(const leaf_header *h) {
    return leaf_geometry_of(h->kind)->noded;
}

status listed_check_parameters(const char *path, const leaf_header *h) {
    const leaf_field fields[] = {
        LEAF_FIELD(h, sample_type, SAMPLE_F32, SAMPLE_F32),
        LEAF_FIELD(h, source_type, SAMPLE_F32, SAMPLE_F64),
        LEAF_FIELD(h, dims[0], 0, 0),
        LEAF_FIELD(h, dims[1], 0, 0),
        LEAF_FIELD(h, dims[2], 0, 0),
        LEAF_FIELD(h, levels, 1, 1),
        LEAF_FIELD(h, cells_log2, 0, 0),
        LEAF_FIELD(h, halo, 0, 0),
        LEAF_FIELD(h, block_log2, 0, 0),
        LEAF_FIELD(h, codec, LEAF_CODEC_RAW, LEAF_CODEC_ZSTD),
        LEAF_FIELD(h, rectilinear, 0, 0),
        LEAF_FIELD(h, outside, 0, 0),
        LEAF_FIELD(h, fields, 1, LEAF_SETS_MAX),
        LEAF_FIELD(h, steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
        LEAF_FIELD(h, treelet_tets, 1, noded_of(h)->cells_max),
        LEAF_FIELD(h, leaf_tets, 0, 0),
        LEAF_FIELD(h, gradients, 0, 0),
        LEAF_FIELD(h, moving, 0, h->steps > 1 ? 1 : 0),
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

uint64_t listed_payloads(const leaf_header *h) {
    return leaf_layout_block_count(h->treelets, h->fields, h->steps, h->moving);
}

status listed_check_values(const char *path, const leaf_header *h) {
    const status st = leaf_cells_check_values(path, h);
    if (st != ST_OK)
        return st;
    if (listed_payloads(h) >= LEAF_NO_TREELET)
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "%llu treelets are too many", (unsigned long long)h->treelets);
    const uint64_t most = h->treelets * h->treelet_tets;
    if (h->tets < h->treelets || h->tets > most || h->vertices < noded_of(h)->nodes_least ||
        h->vertices > noded_of(h)->nodes_each * most || h->flat > h->tets || h->inverted)
        return leaf_check_corrupt(path, offsetof(leaf_header, tets),
                                  "%llu treelets cannot have %llu cells, %llu of them folded, and "
                                  "%llu nodes",
                                  (unsigned long long)h->treelets, (unsigned long long)h->tets,
                                  (unsigned long long)h->flat, (unsigned long long)h->vertices);
    return ST_OK;
}

status listed_check_rest(const char *path, const leaf_header *h) {
    const size_t bare = offsetof(leaf_header, bare), rest = offsetof(leaf_header, zones);
    status st = leaf_check_text(path, h->field, sizeof h->field, offsetof(leaf_header, field));
    if (st == ST_OK)
        st = leaf_check_zero(path, (const char *)h + bare, offsetof(leaf_header, directory) - bare,
                             bare);
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + rest, sizeof *h - rest, rest) : st;
}

status listed_check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets), "a file of %llu bytes cannot hold %llu treelets",
            (unsigned long long)h->file_bytes, (unsigned long long)h->treelets);
    (void)leaf_layout_blocks(l, leaf_geometry_of(h->kind), h->treelets, h->fields, h->steps,
                             h->moving);
    return ST_OK;
}

/* ---- The directory ---- */

uint64_t listed_section_bytes(const leaf_header *h, uint32_t kind) {
    return kind == LEAF_SECTION_BOUNDS ? h->treelets * (h->moving ? h->steps : 1) * sizeof(float[6])
           : kind == LEAF_SECTION_COUNTS ? h->treelets * sizeof(uint32_t[4])
                                         : 0;
}

status listed_lay_out(leaf_file *f, leaf_directory *d) {
    leaf_cells_directory *own = f->besides;
    const leaf_header *h = &f->header;
    d->bounds = (const float(*)[6])own->bounds;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const char *fault = noded_of(h)->counts_fault(own->counts[t], h->treelet_tets);
        if (fault)
            return leaf_check_corrupt(file_path(f->source),
                                      d->at[LEAF_SECTION_COUNTS - 1] + t * sizeof *own->counts,
                                      "treelet %u of %u cells and %u nodes cannot have %s", t,
                                      own->counts[t][0], own->counts[t][1], fault);
        own->first[t + 1] = own->first[t] + own->counts[t][0];
    }
    if (own->first[f->layout.treelets] != h->tets)
        return leaf_check_corrupt(file_path(f->source), offsetof(leaf_header, tets),
                                  "expected the treelets' %llu cells, found %llu",
                                  (unsigned long long)own->first[f->layout.treelets],
                                  (unsigned long long)h->tets);
    leaf_layout_set_counts(&f->layout, (const uint32_t(*)[4])own->counts);
    return leaf_layout_init_flat(&f->layout, f->m);
}

status listed_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d) {
    char why[LEAF_PLACE_TEXT];
    const status st = leaf_cells_check_directory(path, h, l, d);
    if (st == ST_OK && !leaf_place_mesh(h->bounds, why))
        return leaf_check_corrupt(path, offsetof(leaf_header, bounds), "%s", why);
    return st;
}

/* ---- Payloads ---- */

const char *listed_payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    static const char *const formats[] = {[LEAF_BLOCK_TOPOLOGY] = "treelet %u's topology",
                                          [LEAF_BLOCK_VALUES] = "treelet %u's values of set %u",
                                          [LEAF_BLOCK_POSITIONS] =
                                              "treelet %u's positions of step %u"};
    uint32_t index;
    const leaf_block block = leaf_layout_block_of(l, p, &index);
    snprintf(text, LEAF_NAME_MAX, formats[block], p % l->treelets, index);
    return text;
}

int listed_parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads_of[LEAF_PARTS_MAX]) {
    const uint32_t place = leaf_layout_place(l, leaf_layout_step(l, set));
    payloads_of[0] = treelet;
    payloads_of[1] = leaf_layout_values(l, set, treelet);
    if (place == 0)
        return 2;
    payloads_of[2] = leaf_layout_positions(l, place, treelet);
    return 3;
}

/* ---- Segments ---- */

/* Segments have one topology: nodes that move at a later step would be in none of them. */
static bool may_grow(const leaf_header *h, const char **why) {
    *why = "its nodes move";
    return !h->moving;
}

static bool same_treelets(const leaf_file *first, const leaf_file *part) {
    const size_t n = first->layout.treelets;
    const leaf_cells_directory *a = leaf_cells_directory_of(first),
                               *b = leaf_cells_directory_of(part);
    return memcmp(a->counts, b->counts, n * sizeof *a->counts) == 0 &&
           memcmp(a->bounds, b->bounds, n * sizeof *a->bounds) == 0;
}

const leaf_growth listed_growth = {.may = may_grow,
                                   .alike = same_treelets,
                                   .repeat = leaf_layout_block_repeat,
                                   .rows = leaf_layout_block_rows};
