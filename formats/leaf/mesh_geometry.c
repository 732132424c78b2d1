#include "formats/leaf/mesh_geometry.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/leaf/leaf_place.h"
#include "formats/leaf/mesh_layout.h"
#include "formats/leaf/mesh_verify.h"
#include "formats/mesh/mesh_coder.h"
#include "formats/mesh/mesh_leaf.h"

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
        LEAF_FIELD(h, rectilinear, 0, 0),
        LEAF_FIELD(h, outside, 0, 0),
        LEAF_FIELD(h, fields, 1, LEAF_SETS_MAX),
        LEAF_FIELD(h, steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
        LEAF_FIELD(h, treelet_tets, 1, LEAF_TREELET_TETS_MAX),
        LEAF_FIELD(h, leaf_tets, 1, LEAF_LEAF_TETS_MAX),
        LEAF_FIELD(h, gradients, 0, 1),
        LEAF_FIELD(h, moving, 0, h->steps > 1 ? 1 : 0),
    };
    status st = leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
    return st == ST_OK ? leaf_check_source(path, h) : st;
}

/* Check numbers of things against the number of tets, which bounds them, and to_world. */
static status check_values(const char *path, const leaf_header *h) {
    const struct {
        size_t at;
        const char *name;
        uint64_t value, lo, hi;
    } numbers[] = {
        {offsetof(leaf_header, treelets), "treelets", h->treelets, 1, LEAF_NO_TREELET},
        {offsetof(leaf_header, tets), "tets", h->tets, h->treelets, h->treelets * h->treelet_tets},
        {offsetof(leaf_header, vertices), "vertices", h->vertices, 4, 4 * h->tets},
        {offsetof(leaf_header, flat), "flat tets", h->flat, 0, h->tets},
        {offsetof(leaf_header, inverted), "inverted tets", h->inverted, 0, h->tets},
        {offsetof(leaf_header, non_finite), "values that are NaN or infinite", h->non_finite, 0,
         h->vertices * h->fields * h->steps},
    };
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (numbers[i].value < numbers[i].lo || numbers[i].value > numbers[i].hi)
            return leaf_check_corrupt(path, numbers[i].at, "expected %llu to %llu %s, found %llu",
                                      (unsigned long long)numbers[i].lo,
                                      (unsigned long long)numbers[i].hi, numbers[i].name,
                                      (unsigned long long)numbers[i].value);
    for (int i = 0; i < 12; i++)
        if (h->to_world[i] != (i % 5 == 0))
            return leaf_check_corrupt(path,
                                      offsetof(leaf_header, to_world) + sizeof(double) * (size_t)i,
                                      "expected the identity, found %g", h->to_world[i]);
    return ST_OK;
}

/* Requires fields, steps and treelets in their ranges, so that no product overflows. */
static mesh_layout_blocks blocks_of(const leaf_header *h) {
    return (mesh_layout_blocks){.treelets = (uint32_t)h->treelets,
                                .fields = h->fields,
                                .steps = h->steps,
                                .gradients = h->gradients,
                                .moving = h->moving};
}

static status check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    const mesh_layout_blocks blocks = blocks_of(h);
    if (mesh_layout_payloads(&blocks) >= LEAF_NO_TREELET)
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets),
            "expected less than 2^32 - 1 payloads, found %llu treelets and %u sets",
            (unsigned long long)h->treelets, h->fields * h->steps);
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, treelets),
            "a mesh of %llu treelets has a directory of %llu bytes, which a file of "
            "%llu cannot hold",
            (unsigned long long)h->treelets, (unsigned long long)leaf_check_directory_bytes(h),
            (unsigned long long)h->file_bytes);
    mesh_layout_of(l, &blocks);
    return ST_OK;
}

static status check_rest(const char *path, const leaf_header *h) {
    status st = leaf_check_text(path, h->field, sizeof h->field, offsetof(leaf_header, field));
    if (st != ST_OK)
        return st;
    const size_t bare = offsetof(leaf_header, bare), rest = offsetof(leaf_header, zones);
    st = leaf_check_zero(path, (const char *)h + bare, offsetof(leaf_header, directory) - bare,
                         bare);
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + rest, sizeof *h - rest, rest) : st;
}

/* ---- The directory ---- */

static uint64_t sets(const leaf_header *h) {
    return (uint64_t)h->fields * h->steps;
}

static uint64_t payloads(const leaf_header *h) {
    const mesh_layout_blocks blocks = blocks_of(h);
    return mesh_layout_payloads(&blocks);
}

static bool labels(const leaf_header *h) {
    (void)h;
    return true;
}

static uint64_t section_bytes(const leaf_header *h, uint32_t kind) {
    switch (kind) {
    case LEAF_SECTION_BOUNDS: return h->treelets * (h->moving ? h->steps : 1) * sizeof(float[6]);
    case LEAF_SECTION_COUNTS: return h->treelets * sizeof(uint32_t[4]);
    default: return 0;
    }
}

static status allocate(leaf_file *f) {
    const size_t count = f->layout.treelets;
    mesh_directory *mesh = f->mesh = mem_zalloc(f->m, sizeof *f->mesh);
    if (!mesh)
        return ST_NOMEM;
    mesh->bounds = mem_array(f->m, count * f->layout.places, sizeof *mesh->bounds);
    mesh->counts = mem_array(f->m, count, sizeof *mesh->counts);
    mesh->first_tet = mem_array(f->m, count + 1, sizeof *mesh->first_tet);
    return mesh->bounds && mesh->counts && mesh->first_tet ? ST_OK : ST_NOMEM;
}

static void release(leaf_file *f) {
    if (!f->mesh)
        return;
    mem_free(f->m, f->mesh->bounds);
    mem_free(f->m, f->mesh->counts);
    mem_free(f->m, f->mesh->first_tet);
    mem_free(f->m, f->mesh);
}

static void *section(const leaf_file *f, uint32_t kind) {
    switch (kind) {
    case LEAF_SECTION_BOUNDS: return f->mesh->bounds;
    case LEAF_SECTION_COUNTS: return f->mesh->counts;
    default: return NULL;
    }
}

static status check_counts(const char *path, const leaf_header *h, const leaf_directory *d) {
    uint64_t tets = 0, vertices = 0, most = 0;
    for (uint64_t t = 0; t < h->treelets; t++) {
        const uint32_t *c = d->counts[t];
        const char *fault = mesh_leaf_counts_fault(c, h->treelet_tets, h->leaf_tets);
        if (fault)
            return leaf_check_corrupt(
                path, d->at[LEAF_SECTION_COUNTS - 1] + t * sizeof *d->counts,
                "treelet %llu of %u tets, %u vertices, %u nodes, %u leaves cannot have "
                "%s",
                (unsigned long long)t, c[0], c[1], c[2], c[3], fault);
        tets += c[0];
        vertices += c[1];
        most = c[1] > most ? c[1] : most;
    }
    if (tets != h->tets)
        return leaf_check_corrupt(path, offsetof(leaf_header, tets),
                                  "expected the treelets' %llu tets, found %llu",
                                  (unsigned long long)tets, (unsigned long long)h->tets);
    if (h->vertices < most || h->vertices > vertices)
        return leaf_check_corrupt(
            path, offsetof(leaf_header, vertices),
            "expected %llu to %llu vertices, as the treelets have, found %llu",
            (unsigned long long)most, (unsigned long long)vertices,
            (unsigned long long)h->vertices);
    return ST_OK;
}

/* Make the layout of a mesh. Its counts must have been checked. */
static status init_layout(leaf_file *f) {
    mesh_directory *mesh = f->mesh;
    const mesh_layout_blocks blocks = {.treelets = f->layout.treelets,
                                       .fields = f->header.fields,
                                       .steps = f->header.steps,
                                       .gradients = f->layout.gradient_sets > 0,
                                       .moving = leaf_layout_moves(&f->layout)};
    status st = mesh_layout_init(&f->layout, f->m, &blocks);
    if (st != ST_OK)
        return st;
    leaf_layout_set_counts(&f->layout, (const uint32_t(*)[4])mesh->counts);
    for (uint32_t t = 0; t < f->layout.treelets; t++)
        mesh->first_tet[t + 1] = mesh->first_tet[t] + mesh->counts[t][0];
    return ST_OK;
}

static status lay_out(leaf_file *f, leaf_directory *d) {
    d->bounds = (const float(*)[6])f->mesh->bounds;
    d->counts = (const uint32_t(*)[4])f->mesh->counts;
    status st = check_counts(file_path(f->source), &f->header, d);
    return st == ST_OK ? init_layout(f) : st;
}

static status check_bounds(const char *path, const leaf_header *h, const leaf_layout *l,
                           const leaf_directory *d) {
    char why[LEAF_PLACE_TEXT];
    const status st = leaf_check_bounds(path, h, l, d);
    if (st == ST_OK && !leaf_place_mesh(h->bounds, why))
        return leaf_check_corrupt(path, offsetof(leaf_header, bounds), "%s", why);
    return st;
}

static status check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    unsigned flags = 0;
    for (size_t i = 0; i < (size_t)l->treelets * l->sets; i++) {
        const float *own = d->own[i];
        if (!leaf_check_well_formed((double)own[0], (double)own[1]))
            return leaf_check_corrupt(path, d->at[LEAF_SECTION_OWN - 1] + i * sizeof *d->own,
                                      "element %zu, %g .. %g, is no range", i, (double)own[0],
                                      (double)own[1]);
        if (memcmp(own, d->ranges[i], sizeof *d->own) != 0)
            return leaf_check_corrupt(path, d->at[LEAF_SECTION_RANGES - 1] + i * sizeof *d->ranges,
                                      "expected the own range %g .. %g, found %g .. %g",
                                      (double)own[0], (double)own[1], (double)d->ranges[i][0],
                                      (double)d->ranges[i][1]);
        status st = leaf_check_flags(path, h, d, i);
        if (st != ST_OK)
            return st;
        leaf_check_widen(range, own);
        flags |= d->flags[i];
    }
    status st = leaf_check_union(path, h, range, flags);
    return st == ST_OK ? check_bounds(path, h, l, d) : st;
}

/* ---- Payloads ---- */

/* A run begins with the first treelet's payload in each block. */
static bool begins_run(const leaf_layout *l, uint32_t p) {
    return p % l->treelets == 0;
}

static const char *payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    static const char *const formats[] = {
        [LEAF_BLOCK_TOPOLOGY] = "treelet %u's topology",
        [LEAF_BLOCK_VALUES] = "treelet %u's values of set %u",
        [LEAF_BLOCK_GRADIENTS] = "treelet %u's gradients of set %u",
        [LEAF_BLOCK_POSITIONS] = "treelet %u's positions of step %u"};
    uint32_t index;
    const leaf_block block = leaf_layout_block_of(l, p, &index);
    snprintf(text, LEAF_NAME_MAX, formats[block], p % l->treelets, index);
    return text;
}

/* Without gradients, which smooth shading alone needs. */
static int parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads[LEAF_PARTS_MAX]) {
    const uint32_t place = leaf_layout_place(l, leaf_layout_step(l, set));
    payloads[0] = treelet;
    payloads[1] = leaf_layout_values(l, set, treelet);
    if (place == 0)
        return 2;
    payloads[2] = leaf_layout_positions(l, place, treelet);
    return 3;
}

/* ---- Segments ---- */

/* Segments have one topology: vertices that move at a later step would be in none of them. */
static bool may_grow(const leaf_header *h, const char **why) {
    *why = "its vertices move";
    return !h->moving;
}

static bool same_treelets(const leaf_file *first, const leaf_file *part) {
    const size_t n = first->layout.treelets;
    const mesh_directory *a = first->mesh, *b = part->mesh;
    return memcmp(a->counts, b->counts, n * sizeof *a->counts) == 0 &&
           memcmp(a->bounds, b->bounds, n * sizeof *a->bounds) == 0;
}

static int rows(const leaf_layout *l, leaf_row rows[LEAF_ROWS_MAX]) {
    rows[0] = (leaf_row){leaf_layout_values(l, 0, 0), l->treelets};
    rows[1] = (leaf_row){leaf_layout_gradients(l, 0, 0), l->treelets};
    return l->gradient_sets ? 2 : 1;
}

static const leaf_growth growth = {
    .may = may_grow, .alike = same_treelets, .repeat = mesh_layout_repeat, .rows = rows};

const leaf_geometry mesh_geometry = {.holds_indices = true,
                                     .coarse = true,
                                     .blending = &mesh_blending,
                                     .growth = &growth,
                                     .check_parameters = check_parameters,
                                     .check_values = check_values,
                                     .check_rest = check_rest,
                                     .check_layout = check_layout,
                                     .sets = sets,
                                     .payloads = payloads,
                                     .labels = labels,
                                     .section_bytes = section_bytes,
                                     .allocate = allocate,
                                     .section = section,
                                     .release = release,
                                     .lay_out = lay_out,
                                     .check_directory = check_directory,
                                     .payload_bytes = mesh_layout_payload_bytes,
                                     .begins_run = begins_run,
                                     .series = leaf_layout_block_series,
                                     .payload_name = payload_name,
                                     .parts = parts,
                                     .coder = &mesh_coder,
                                     .verifier = &mesh_verifier};
