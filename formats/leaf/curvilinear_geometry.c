#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/curvilinear_coder.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/leaf/curvilinear_verify.h"
#include "formats/leaf/hex_blending.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_cells.h"

uint32_t curvilinear_place_bytes(const uint32_t cells[3]) {
    const uint32_t codes = (curvilinear_cells(cells) + 3) / 4;
    return leaf_aligned(curvilinear_nodes(cells) * (uint32_t)sizeof(float[3]) +
                        (codes > CURVILINEAR_TAIL ? codes : CURVILINEAR_TAIL));
}

uint32_t curvilinear_value_bytes(const uint32_t cells[3]) {
    return leaf_aligned(curvilinear_nodes(cells) * (uint32_t)sizeof(float));
}

bool curvilinear_layout(leaf_layout *l, uint64_t treelets, uint32_t fields, uint32_t steps,
                        bool moving) {
    return leaf_layout_blocks(l, &curvilinear_geometry, treelets, fields, steps, moving);
}

/* ---- The header ---- */

static status check_parameters(const char *path, const leaf_header *h) {
    const leaf_field fields[] = {
        LEAF_FIELD(h, sample_type, SAMPLE_F32, SAMPLE_F32),
        LEAF_FIELD(h, levels, 1, 1),
        LEAF_FIELD(h, cells_log2, CURVILINEAR_LOG2, CURVILINEAR_LOG2),
        LEAF_FIELD(h, halo, 0, 0),
        LEAF_FIELD(h, block_log2, LEAF_BLOCK_LOG2, LEAF_BLOCK_LOG2),
        LEAF_FIELD(h, rectilinear, 0, 0),
        LEAF_FIELD(h, outside, 0, 0),
        LEAF_FIELD(h, codec, LEAF_CODEC_RAW, LEAF_CODEC_ZSTD),
        LEAF_FIELD(h, fields, 1, LEAF_SETS_MAX),
        LEAF_FIELD(h, steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
        LEAF_FIELD(h, moving, 0, h->steps > 1 ? 1 : 0),
        LEAF_FIELD(h, zones, 1, UINT32_MAX),
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

static uint64_t payloads(const leaf_header *h) {
    return leaf_layout_block_count(h->treelets, h->fields, h->steps, h->moving);
}

static status check_values(const char *path, const leaf_header *h) {
    const status st = leaf_cells_check_values(path, h);
    if (st == ST_OK && (h->zones > h->treelets || payloads(h) >= LEAF_NO_TREELET))
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "%llu treelets are too few for %u zones, or too many",
                                  (unsigned long long)h->treelets, h->zones);
    return st;
}

static status check_rest(const char *path, const leaf_header *h) {
    const struct {
        size_t from, to;
    } zeros[] = {
        {offsetof(leaf_header, dims), offsetof(leaf_header, levels)},
        {offsetof(leaf_header, tets), offsetof(leaf_header, bounds)},
        {offsetof(leaf_header, treelet_tets), offsetof(leaf_header, field)},
        {offsetof(leaf_header, gradients), offsetof(leaf_header, moving)},
        {offsetof(leaf_header, bare), offsetof(leaf_header, directory)},
        {offsetof(leaf_header, reserved), sizeof *h},
    };
    status st = leaf_check_text(path, h->field, sizeof h->field, offsetof(leaf_header, field));
    for (size_t i = 0; st == ST_OK && i < sizeof zeros / sizeof *zeros; i++)
        st = leaf_check_zero(path, (const char *)h + zeros[i].from, zeros[i].to - zeros[i].from,
                             zeros[i].from);
    return st;
}

static status check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets), "a file of %llu bytes cannot hold %llu treelets",
            (unsigned long long)h->file_bytes, (unsigned long long)h->treelets);
    (void)curvilinear_layout(l, h->treelets, h->fields, h->steps, h->moving);
    return ST_OK;
}

/* ---- The directory ---- */

static uint64_t section_bytes(const leaf_header *h, uint32_t kind) {
    return kind == LEAF_SECTION_BOUNDS ? h->treelets * (h->moving ? h->steps : 1) * sizeof(float[6])
           : kind == LEAF_SECTION_ZONES ? h->zones * sizeof(uint32_t[4])
                                        : 0;
}

static status allocate(leaf_file *f) {
    const size_t treelets = f->layout.treelets;
    curvilinear_directory *d = f->besides = mem_zalloc(f->m, sizeof *d);
    if (!d)
        return ST_NOMEM;
    d->bounds = mem_array(f->m, treelets * f->layout.places, sizeof *d->bounds);
    d->zones = mem_array(f->m, f->header.zones, sizeof *d->zones);
    d->counts = mem_array(f->m, treelets, sizeof *d->counts);
    d->where = mem_array(f->m, treelets, sizeof *d->where);
    d->first = mem_array(f->m, treelets + 1, sizeof *d->first);
    return d->bounds && d->zones && d->counts && d->where && d->first ? ST_OK : ST_NOMEM;
}

static void *section(const leaf_file *f, uint32_t kind) {
    const curvilinear_directory *d = curvilinear_directory_of(f);
    return kind == LEAF_SECTION_BOUNDS  ? (void *)d->bounds
           : kind == LEAF_SECTION_ZONES ? (void *)d->zones
                                        : NULL;
}

static void release(leaf_file *f) {
    curvilinear_directory *d = f->besides;
    if (!d)
        return;
    mem_free(f->m, d->bounds);
    mem_free(f->m, d->zones);
    mem_free(f->m, d->counts);
    mem_free(f->m, d->where);
    mem_free(f->m, d->first);
    mem_free(f->m, d);
}

/* The next treelet that is listed. */
typedef struct listing {
    curvilinear_directory *d;
    uint32_t zone, treelet;
} listing;

static void list_treelet(void *ctx, const uint32_t first[3], const uint32_t cells[3]) {
    listing *to = ctx;
    const uint32_t t = to->treelet++;
    for (int a = 0; a < 3; a++) {
        to->d->counts[t][a] = cells[a];
        to->d->where[t].first[a] = first[a];
    }
    to->d->counts[t][3] = 0;
    to->d->where[t].zone = to->zone;
    to->d->first[t + 1] = to->d->first[t] + curvilinear_cells(cells);
}

static status check_zones(const leaf_file *f, const leaf_directory *d) {
    const curvilinear_directory *own = f->besides;
    const uint64_t at = d->at[LEAF_SECTION_ZONES - 1];
    uint64_t left = f->header.treelets;
    for (uint32_t z = 0; z < f->header.zones; z++) {
        const uint32_t *nodes = own->zones[z];
        bool sound = nodes[3] == 0;
        for (int a = 0; a < 3; a++)
            sound = sound && nodes[a] >= 2 && nodes[a] <= CURVILINEAR_NODES_MAX;
        if (!sound)
            return leaf_check_corrupt(file_path(f->source), at + z * sizeof *own->zones,
                                      "zone %u cannot have %u x %u x %u nodes", z, nodes[0],
                                      nodes[1], nodes[2]);
        const uint64_t count = curvilinear_zones_treelets(nodes, left);
        if (count > left || (z + 1 == f->header.zones && count < left))
            return leaf_check_corrupt(file_path(f->source), at + z * sizeof *own->zones,
                                      "the zones do not have %llu treelets",
                                      (unsigned long long)f->header.treelets);
        left -= count;
    }
    return ST_OK;
}

static status lay_out(leaf_file *f, leaf_directory *d) {
    curvilinear_directory *own = f->besides;
    listing to = {own, 0, 0};
    const status st = check_zones(f, d);
    if (st != ST_OK)
        return st;
    own->first[0] = 0;
    for (to.zone = 0; to.zone < f->header.zones; to.zone++)
        curvilinear_zones_walk(own->zones[to.zone], list_treelet, &to);
    d->bounds = (const float(*)[6])own->bounds;
    leaf_layout_set_counts(&f->layout, (const uint32_t(*)[4])own->counts);
    return leaf_layout_init_flat(&f->layout, f->m);
}

/* ---- Payloads ---- */

static const char *payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    uint32_t index;
    const bool values = leaf_layout_block_of(l, p, &index) == LEAF_BLOCK_VALUES;
    snprintf(text, LEAF_NAME_MAX,
             values ? "treelet %u's values of set %u" : "treelet %u's places of step %u",
             p % l->treelets, index);
    return text;
}

static int parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads_of[LEAF_PARTS_MAX]) {
    payloads_of[0] = hex_treelet_places(l, leaf_layout_step(l, set), treelet);
    payloads_of[1] = leaf_layout_values(l, set, treelet);
    return 2;
}

/* ---- Segments ---- */

/* Segments have one place for each node. */
static bool may_grow(const leaf_header *h, const char **why) {
    *why = "its nodes move";
    return !h->moving;
}

static bool same_treelets(const leaf_file *first, const leaf_file *part) {
    const curvilinear_directory *a = first->besides, *b = part->besides;
    const uint32_t zones = first->header.zones;
    return zones == part->header.zones &&
           memcmp(a->zones, b->zones, zones * sizeof *a->zones) == 0 &&
           memcmp(a->bounds, b->bounds, first->layout.treelets * sizeof *a->bounds) == 0;
}

static const leaf_growth growth = {.may = may_grow,
                                   .alike = same_treelets,
                                   .repeat = leaf_layout_block_repeat,
                                   .rows = leaf_layout_block_rows};

/* ---- Cells ---- */

static void count(hex_treelet *h) {
    const uint32_t *cells = h->f->layout.counts[h->id];
    h->nodes = curvilinear_nodes(cells);
    h->cells = curvilinear_cells(cells);
}

static void row_of(const hex_treelet *h, uint32_t cell, uint32_t out[CELL_ROW]) {
    const uint32_t *cells = h->f->layout.counts[h->id], row = cells[0] + 1,
                   plane = row * (cells[1] + 1);
    const uint32_t node = cell % cells[0] + row * (cell / cells[0] % cells[1]) +
                          plane * (cell / (cells[0] * cells[1]));
    for (uint32_t c = 0; c < CELL_ROW; c++) {
        const uint32_t corner = c < HEX_CORNERS ? c : 0;
        out[c] = node + (corner & 1) + (corner >> 1 & 1) * row + (corner >> 2) * plane;
    }
}

static const leaf_noded noded = {.hexahedra = true, .count = count, .row = row_of};

const leaf_geometry curvilinear_geometry = {.coarse = true,
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
                                            .allocate = allocate,
                                            .section = section,
                                            .release = release,
                                            .lay_out = lay_out,
                                            .check_directory = leaf_cells_check_directory,
                                            .payload_bytes = hex_treelet_payload_bytes,
                                            .begins_run = leaf_cells_begins_run,
                                            .series = leaf_layout_block_series,
                                            .payload_name = payload_name,
                                            .parts = parts,
                                            .coder = &curvilinear_coder,
                                            .noded = &noded,
                                            .verifier = &curvilinear_verifier};
