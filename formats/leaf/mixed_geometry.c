#include "formats/leaf/mixed_geometry.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/curved/curved_cell.h"
#include "formats/leaf/hex_blending.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_place.h"
#include "formats/leaf/mixed_coder.h"
#include "formats/leaf/mixed_verify.h"

mixed_shape mixed_shape_of(const uint32_t counts[4]) {
    mixed_shape s = {.cells = counts[0],
                     .nodes = counts[1],
                     .quadratic = counts[2],
                     .width = counts[2] ? CELL_ROW : HEX_CORNERS};
    s.codes_at = s.nodes * (uint32_t)sizeof(float[3]);
    s.place_bytes = s.rows_at = leaf_aligned(s.codes_at + (s.cells + 3) / 4);
    s.topology_bytes = s.rows_at + leaf_aligned(mixed_rows_bytes(&s));
    s.value_bytes = leaf_aligned(s.nodes * (uint32_t)sizeof(float));
    return s;
}

const char *mixed_counts_fault(const uint32_t counts[4], uint32_t treelet_cells) {
    if (counts[0] < 1 || counts[0] > treelet_cells)
        return "so many cells";
    if (counts[2] > counts[0] || (counts[2] && counts[0] > MIXED_QUADRATIC_MAX))
        return "so many quadratic tets";
    if (counts[1] < 4 || counts[1] > (counts[2] ? CELL_ROW : HEX_CORNERS) * counts[0])
        return "so many nodes";
    return counts[3] ? "more than cells and nodes" : NULL;
}

void mixed_widen(const mixed_shape *s, const uint16_t *rows, const float *of_nodes, float *least,
                 float *greatest) {
    for (uint32_t i = 0; s->quadratic && i < s->cells; i++) {
        uint32_t row[CELL_ROW];
        float v[QUADRATIC_NODES], lo, hi, odd = 0.0F;
        mixed_row(s, rows, i, row);
        if (!cell_row_is_quadratic(row))
            continue;
        for (int n = 0; n < QUADRATIC_NODES; n++) {
            v[n] = of_nodes[row[n]];
            odd += v[n] - v[n]; /* NaN unless it is finite */
        }
        if (odd != 0.0F)
            continue;
        curved_quadratic_limits(v, &lo, &hi);
        *least = lo < *least ? lo : *least;
        *greatest = hi > *greatest ? hi : *greatest;
    }
}

bool mixed_layout(leaf_layout *l, uint64_t treelets, uint32_t fields, uint32_t steps, bool moving) {
    return leaf_layout_blocks(l, &mixed_geometry, treelets, fields, steps, moving);
}

/* ---- The header ---- */

static status check_parameters(const char *path, const leaf_header *h) {
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
        LEAF_FIELD(h, treelet_tets, 1, MIXED_CELLS_MAX),
        LEAF_FIELD(h, leaf_tets, 0, 0),
        LEAF_FIELD(h, gradients, 0, 0),
        LEAF_FIELD(h, moving, 0, h->steps > 1 ? 1 : 0),
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

static uint64_t payloads(const leaf_header *h) {
    return leaf_layout_block_count(h->treelets, h->fields, h->steps, h->moving);
}

static status check_values(const char *path, const leaf_header *h) {
    const status st = leaf_cells_check_values(path, h);
    if (st != ST_OK)
        return st;
    if (payloads(h) >= LEAF_NO_TREELET)
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "%llu treelets are too many", (unsigned long long)h->treelets);
    const uint64_t most = h->treelets * h->treelet_tets;
    if (h->tets < h->treelets || h->tets > most || h->vertices < 4 ||
        h->vertices > CELL_ROW * most || h->flat > h->tets || h->inverted)
        return leaf_check_corrupt(path, offsetof(leaf_header, tets),
                                  "%llu treelets cannot have %llu cells, %llu of them folded, and "
                                  "%llu nodes",
                                  (unsigned long long)h->treelets, (unsigned long long)h->tets,
                                  (unsigned long long)h->flat, (unsigned long long)h->vertices);
    return ST_OK;
}

static status check_rest(const char *path, const leaf_header *h) {
    const size_t bare = offsetof(leaf_header, bare), rest = offsetof(leaf_header, zones);
    status st = leaf_check_text(path, h->field, sizeof h->field, offsetof(leaf_header, field));
    if (st == ST_OK)
        st = leaf_check_zero(path, (const char *)h + bare, offsetof(leaf_header, directory) - bare,
                             bare);
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + rest, sizeof *h - rest, rest) : st;
}

static status check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets), "a file of %llu bytes cannot hold %llu treelets",
            (unsigned long long)h->file_bytes, (unsigned long long)h->treelets);
    (void)mixed_layout(l, h->treelets, h->fields, h->steps, h->moving);
    return ST_OK;
}

/* ---- The directory ---- */

static uint64_t section_bytes(const leaf_header *h, uint32_t kind) {
    return kind == LEAF_SECTION_BOUNDS ? h->treelets * (h->moving ? h->steps : 1) * sizeof(float[6])
           : kind == LEAF_SECTION_COUNTS ? h->treelets * sizeof(uint32_t[4])
                                         : 0;
}

static status lay_out(leaf_file *f, leaf_directory *d) {
    leaf_cells_directory *own = f->besides;
    const leaf_header *h = &f->header;
    d->bounds = (const float(*)[6])own->bounds;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const char *fault = mixed_counts_fault(own->counts[t], h->treelet_tets);
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

static status check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d) {
    char why[LEAF_PLACE_TEXT];
    const status st = leaf_cells_check_directory(path, h, l, d);
    if (st == ST_OK && !leaf_place_mesh(h->bounds, why))
        return leaf_check_corrupt(path, offsetof(leaf_header, bounds), "%s", why);
    return st;
}

/* ---- Payloads ---- */

static const char *payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    static const char *const formats[] = {[LEAF_BLOCK_TOPOLOGY] = "treelet %u's topology",
                                          [LEAF_BLOCK_VALUES] = "treelet %u's values of set %u",
                                          [LEAF_BLOCK_POSITIONS] =
                                              "treelet %u's positions of step %u"};
    uint32_t index;
    const leaf_block block = leaf_layout_block_of(l, p, &index);
    snprintf(text, LEAF_NAME_MAX, formats[block], p % l->treelets, index);
    return text;
}

static int parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
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
    const leaf_cells_directory *a = mixed_directory_of(first), *b = mixed_directory_of(part);
    return memcmp(a->counts, b->counts, n * sizeof *a->counts) == 0 &&
           memcmp(a->bounds, b->bounds, n * sizeof *a->bounds) == 0;
}

static const leaf_growth growth = {.may = may_grow,
                                   .alike = same_treelets,
                                   .repeat = leaf_layout_block_repeat,
                                   .rows = leaf_layout_block_rows};

/* ---- Cells ---- */

static void count(hex_treelet *h) {
    const mixed_shape s = mixed_shape_of(h->f->layout.counts[h->id]);
    h->nodes = s.nodes;
    h->cells = s.cells;
}

static void row_of(const hex_treelet *h, uint32_t cell, uint32_t row[CELL_ROW]) {
    const mixed_shape s = mixed_shape_of(h->f->layout.counts[h->id]);
    mixed_row(&s, mixed_rows(&s, h->topology), cell, row);
}

static const leaf_hexes hexes = {true, count, row_of};

const leaf_geometry mixed_geometry = {.coarse = true,
                                      .blending = &hex_blending,
                                      .growth = &growth,
                                      .check_parameters = check_parameters,
                                      .check_values = check_values,
                                      .check_rest = check_rest,
                                      .check_layout = check_layout,
                                      .sets = leaf_cells_sets,
                                      .payloads = payloads,
                                      .labels = leaf_cells_labels,
                                      .section_bytes = section_bytes,
                                      .allocate = leaf_cells_allocate,
                                      .section = leaf_cells_section,
                                      .release = leaf_cells_release,
                                      .lay_out = lay_out,
                                      .check_directory = check_directory,
                                      .payload_bytes = hex_treelet_payload_bytes,
                                      .begins_run = leaf_cells_begins_run,
                                      .series = leaf_layout_block_series,
                                      .payload_name = payload_name,
                                      .parts = parts,
                                      .coder = &mixed_coder,
                                      .hexes = &hexes,
                                      .verifier = &mixed_verifier};
