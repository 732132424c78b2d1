#include "formats/leaf/grid_geometry.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "formats/base/sample.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/slice_folder.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/implied_payload.h"
#include "formats/leaf/leaf_place.h"

/* ---- The header ---- */

static status check_parameters(const char *path, const leaf_header *h) {
    const bool heights = h->kind == LEAF_KIND_HEIGHTS;
    const bool one = h->codec == LEAF_CODEC_ZSTD && h->fields == 1 && h->steps == 1;
    const leaf_field fields[] = {
        LEAF_FIELD(h, cells_log2, LEAF_CELLS_LOG2_MIN, LEAF_CELLS_LOG2_MAX),
        LEAF_FIELD(h, halo, 0, 1),
        LEAF_FIELD(h, block_log2, LEAF_BLOCK_LOG2, LEAF_BLOCK_LOG2),
        LEAF_FIELD(h, rectilinear, 0, !heights),
        LEAF_FIELD(h, outside, 0, one && !heights ? LEAF_IN_SLICES : 0),
        LEAF_FIELD(h, dims[1], heights ? 2 : 0, heights ? 2 : UINT32_MAX),
        LEAF_FIELD(h, bare, 0, h->levels > 1),
        LEAF_FIELD(h, outside_chunks, 0, h->outside ? UINT32_MAX : 0),
        LEAF_FIELD(h, fields, 1, LEAF_SETS_MAX),
        LEAF_FIELD(h, steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
    };
    status st = leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
    /* An input of integers with a value for missing data is also stored as f32, where NaN stands
     * for it. */
    return st == ST_OK && h->sample_type != SAMPLE_F32 ? leaf_check_source(path, h) : st;
}

static status check_values(const char *path, const leaf_header *h) {
    const uint64_t samples = (uint64_t)h->dims[0] * h->dims[1] * h->dims[2];
    if ((double)h->non_finite > (double)samples * h->fields * h->steps ||
        (h->non_finite && h->sample_type != SAMPLE_F32))
        return leaf_check_corrupt(path, offsetof(leaf_header, non_finite),
                                  "%llu samples cannot be NaN or infinite",
                                  (unsigned long long)h->non_finite);
    char why[LEAF_PLACE_TEXT];
    if (!leaf_place_grid(h->to_world, why))
        return leaf_check_corrupt(path, offsetof(leaf_header, to_world), "%s", why);
    return ST_OK;
}

static status check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    status st = leaf_layout_levels(l, h->dims, h->cells_log2, h->halo, (sample_type)h->sample_type);
    if (st != ST_OK)
        return status_describe(st, "%s: byte %zu: %s", path, offsetof(leaf_header, dims),
                               status_text());
    if (h->levels != l->levels)
        return leaf_check_corrupt(path, offsetof(leaf_header, levels),
                                  "expected %u levels, found %u", l->levels, h->levels);
    if (h->treelets != l->treelets)
        return leaf_check_corrupt(path, offsetof(leaf_header, treelets),
                                  "expected %u treelets, found %llu", l->treelets,
                                  (unsigned long long)h->treelets);
    if (!leaf_layout_repeat(l, h->fields, h->steps, h->codec != LEAF_CODEC_RAW))
        return leaf_check_corrupt(
            path, offsetof(leaf_header, fields),
            "expected less than 2^32 - 1 payloads, found %u treelets, %u fields and %u steps",
            l->treelets, h->fields, h->steps);
    if (!leaf_check_may_hold(h))
        return leaf_check_corrupt(path, offsetof(leaf_header, dims),
                                  "a grid of %u x %u x %u has a directory of %llu bytes, "
                                  "which a file of %llu cannot hold",
                                  h->dims[0], h->dims[1], h->dims[2],
                                  (unsigned long long)leaf_check_directory_bytes(h),
                                  (unsigned long long)h->file_bytes);
    return ST_OK;
}

static status check_rest(const char *path, const leaf_header *h) {
    const size_t tets = offsetof(leaf_header, tets), field = offsetof(leaf_header, field);
    const size_t gradients = offsetof(leaf_header, gradients), bare = offsetof(leaf_header, bare);
    const size_t rest = offsetof(leaf_header, zones);
    status st = leaf_check_zero(path, (const char *)h + tets, field - tets, tets);
    if (st == ST_OK)
        st = leaf_check_text(path, h->field, sizeof h->field, field);
    if (st == ST_OK)
        st = leaf_check_zero(path, (const char *)h + gradients, bare - gradients, gradients);
    return st == ST_OK ? leaf_check_zero(path, (const char *)h + rest, sizeof *h - rest, rest) : st;
}

/* ---- The directory ---- */

static uint64_t sets(const leaf_header *h) {
    return (uint64_t)h->fields * h->steps;
}

/* The treelets above level 0, each with a shell below it. */
static uint64_t shells(const leaf_header *h) {
    leaf_layout l;
    if (h->codec == LEAF_CODEC_RAW || leaf_layout_levels(&l, h->dims, h->cells_log2, h->halo,
                                                         (sample_type)h->sample_type) != ST_OK)
        return 0;
    return l.level[0].first;
}

static uint64_t payloads(const leaf_header *h) {
    return (h->treelets + shells(h)) * sets(h);
}

static bool labels(const leaf_header *h) {
    (void)h;
    return true;
}

static uint64_t section_bytes(const leaf_header *h, uint32_t kind) {
    if (kind == LEAF_SECTION_DEVIATIONS)
        return deviation_bytes(h);
    if (kind == LEAF_SECTION_OUTSIDE && h->outside)
        return sizeof(leaf_outside);
    if (kind == LEAF_SECTION_CHUNKS)
        return h->outside_chunks * sizeof(chunk_entry);
    if (kind == LEAF_SECTION_SLICES)
        return h->outside == LEAF_IN_SLICES ? h->dims[2] * sizeof(slice_file) : 0;
    if (kind == LEAF_SECTION_BASES)
        return h->codec != LEAF_CODEC_RAW && leaf_is_behind(h) ? payloads(h) * sizeof(uint32_t) : 0;
    if (kind != LEAF_SECTION_AXES || !h->rectilinear)
        return 0;
    return ((uint64_t)h->dims[0] + h->dims[1] + h->dims[2]) * sizeof(double);
}

/* leaf_file reads the axes itself. */
static status allocate(leaf_file *f) {
    const uint32_t chunks = f->header.outside_chunks, slices = f->header.dims[2];
    const bool in_slices = f->header.outside == LEAF_IN_SLICES;
    if (f->header.outside && !(f->outside = mem_zalloc(f->m, sizeof *f->outside)))
        return ST_NOMEM;
    if (chunks && !(f->chunks = mem_array(f->m, chunks, sizeof *f->chunks)))
        return ST_NOMEM;
    if (in_slices && !(f->slices = mem_array(f->m, slices, sizeof *f->slices)))
        return ST_NOMEM;
    return ST_OK;
}

static void *section(const leaf_file *f, uint32_t kind) {
    return kind == LEAF_SECTION_OUTSIDE  ? (void *)f->outside
           : kind == LEAF_SECTION_CHUNKS ? (void *)f->chunks
           : kind == LEAF_SECTION_SLICES ? (void *)f->slices
                                         : NULL;
}

static void release(leaf_file *f) {
    mem_free(f->m, f->outside);
    mem_free(f->m, f->chunks);
    mem_free(f->m, f->slices);
}

static status lay_out(leaf_file *f, leaf_directory *d) {
    const leaf_header *h = &f->header;
    (void)d;
    status st = leaf_layout_init(&f->layout, f->m, h->dims, h->cells_log2, h->halo,
                                 (sample_type)h->sample_type);
    /* Cannot fail: check_layout() has checked it. */
    (void)leaf_layout_repeat(&f->layout, h->fields, h->steps, h->codec != LEAF_CODEC_RAW);
    f->layout.outside = h->outside > 0;
    if (h->bare)
        leaf_layout_bare(&f->layout);
    return st;
}

/* Whether samples of this type can have this range. */
static bool of_type(sample_type type, const float range[2]) {
    static const float limits[][2] = {[SAMPLE_U8] = {0, 255},
                                      [SAMPLE_I8] = {-128, 127},
                                      [SAMPLE_U16] = {0, 65535},
                                      [SAMPLE_I16] = {-32768, 32767}};
    if (type == SAMPLE_F32 || range[0] > range[1])
        return true;
    return range[0] >= limits[type][0] && range[1] <= limits[type][1] &&
           range[0] == floorf(range[0]) && range[1] == floorf(range[1]);
}

/* Check one treelet's own and merged range in a set. Merged ranges are compared by value, so that
 * -0 equals 0. */
static status check_ranges(const char *path, const leaf_layout *l, const leaf_directory *d,
                           uint32_t set, uint32_t t) {
    const size_t first = leaf_layout_samples(l, set, 0);
    const float *own = d->own[first + t], *merged = d->ranges[first + t];
    uint64_t entry = (first + t) * sizeof(float[2]);
    if (!leaf_check_well_formed((double)own[0], (double)own[1]) || !of_type(l->type, own))
        return leaf_check_corrupt(path, d->at[LEAF_SECTION_OWN - 1] + entry,
                                  "treelet %u's own range %g .. %g is none of %s samples", t,
                                  (double)own[0], (double)own[1], sample_name(l->type));
    float lo = own[0], hi = own[1];
    uint32_t child = l->first_child[t];
    for (unsigned n = (unsigned)__builtin_popcount(leaf_layout_children(l, t)); n > 0;
         n--, child++) {
        lo = fminf(lo, d->ranges[first + child][0]);
        hi = fmaxf(hi, d->ranges[first + child][1]);
    }
    if (merged[0] != lo || merged[1] != hi)
        return leaf_check_corrupt(
            path, d->at[LEAF_SECTION_RANGES - 1] + entry,
            "expected treelet %u's merged range to be its own and its children's %g .. "
            "%g, found %g .. %g",
            t, (double)lo, (double)hi, (double)merged[0], (double)merged[1]);
    return ST_OK;
}

/* Check that payload p, whose samples lie outside, has their checksum, or is implied. */
static status check_outside(const char *path, const leaf_layout *l, const leaf_directory *d,
                            uint32_t p) {
    if (!leaf_layout_is_outside(l, p) || d->checksums[p] ||
        implied_payload_may(d->own[p], d->flags[p]))
        return ST_OK;
    return leaf_check_corrupt(path, d->at[LEAF_SECTION_CHECKSUMS - 1] + p * sizeof(uint64_t),
                              "expected the checksum of treelet %u's samples, found 0", p);
}

/* Check that a treelet without samples has no range of its own and no flags: element p. */
static status check_bare(const char *path, const leaf_layout *l, const leaf_directory *d,
                         uint32_t p) {
    const float *own = d->own[p];
    const uint32_t t = p % l->treelets;
    if (!leaf_layout_is_bare(l, t))
        return ST_OK;
    if (own[0] <= own[1])
        return leaf_check_corrupt(
            path, d->at[LEAF_SECTION_OWN - 1] + p * sizeof(float[2]),
            "expected no own range of treelet %u, whose level has no samples, found %g .. %g", t,
            (double)own[0], (double)own[1]);
    if (d->flags[p])
        return leaf_check_corrupt(
            path, d->at[LEAF_SECTION_FLAGS - 1] + p,
            "expected no flags of treelet %u, whose level has no samples, found 0x%02x", t,
            d->flags[p]);
    return ST_OK;
}

static status check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                              const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    unsigned level0_flags = 0;
    for (uint32_t p = l->sets * l->treelets; p-- > 0;) {
        const uint32_t t = p % l->treelets;
        status st = check_ranges(path, l, d, p / l->treelets, t);
        if (st == ST_OK)
            st = leaf_check_flags(path, h, d, p);
        if (st == ST_OK)
            st = check_outside(path, l, d, p);
        if (st == ST_OK)
            st = check_bare(path, l, d, p);
        if (st != ST_OK)
            return st;
        if (l->level_of[t] == 0) {
            leaf_check_widen(range, d->own[p]);
            level0_flags |= d->flags[p];
        }
    }
    return leaf_check_union(path, h, range, level0_flags);
}

/* ---- Payloads ---- */

static uint32_t payload_bytes(const leaf_layout *l, uint32_t p) {
    uint32_t set, parent;
    if (leaf_layout_is_shell(l, p, &set, &parent))
        return (uint32_t)(leaf_layout_shell_samples(l, parent) * sample_size(l->type));
    return leaf_layout_payload(l, p % l->treelets).bytes;
}

/* A run begins with the child in octant 0, which every parent has. */
static bool begins_run(const leaf_layout *l, uint32_t p) {
    const uint32_t *place = l->place[p % l->treelets];
    return p < l->sets * l->treelets && !((place[0] | place[1] | place[2]) & 1);
}

static leaf_series series(const leaf_layout *l, uint32_t p) {
    const uint32_t shells = l->sets * l->treelets;
    return p < shells ? leaf_series_of(p, 0, l->treelets) : leaf_series_of(p, shells, l->shells);
}

/* A shell has no bytes if nobody needs it: there is one child, or all are implied. */
static bool is_needless(const leaf_layout *l, uint32_t set, uint32_t parent,
                        const uint64_t *sizes) {
    const uint32_t first = leaf_layout_samples(l, set, l->first_child[parent]);
    const uint32_t children = (uint32_t)__builtin_popcount(leaf_layout_children(l, parent));
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < children; i++)
        bytes |= sizes[first + i];
    return children == 1 || !bytes;
}

static bool may_be_empty(const leaf_layout *l, uint32_t p, const leaf_directory *d, bool *must) {
    uint32_t set, parent;
    const bool shell = leaf_layout_is_shell(l, p, &set, &parent);
    *must = shell ? is_needless(l, set, parent, d->sizes)
                  : leaf_layout_is_outside(l, p) || leaf_layout_is_bare(l, p % l->treelets);
    if (*must || shell)
        return *must;
    return implied_payload_may(d->own[p], d->flags[p]);
}

static const char *payload_name(const leaf_layout *l, uint32_t p, char text[LEAF_NAME_MAX]) {
    uint32_t set, parent;
    if (leaf_layout_is_shell(l, p, &set, &parent))
        snprintf(text, LEAF_NAME_MAX, "the shell below treelet %u, of set %u", parent, set);
    else if (l->sets == 1)
        snprintf(text, LEAF_NAME_MAX, "treelet %u's payload", p);
    else
        snprintf(text, LEAF_NAME_MAX, "treelet %u's payload of set %u", p % l->treelets,
                 p / l->treelets);
    return text;
}

static int parts(const leaf_layout *l, uint32_t set, uint32_t treelet,
                 uint32_t payloads[LEAF_PARTS_MAX]) {
    payloads[0] = leaf_layout_samples(l, set, treelet);
    if (!l->shells || treelet == 0)
        return 1;
    payloads[1] = leaf_layout_shell(l, set, leaf_layout_parent(l, treelet));
    return 2;
}

/* ---- Segments ---- */

static bool may_grow(const leaf_header *h, const char **why) {
    *why = "its samples lie in another file";
    return !h->outside;
}

static bool same_axes(const leaf_file *first, const leaf_file *part) {
    size_t nodes = 0;
    for (int a = 0; a < 3; a++)
        nodes += first->header.dims[a];
    return memcmp(part->axis[0], first->axis[0], nodes * sizeof *first->axis[0]) == 0;
}

static bool repeat(leaf_layout *l, uint32_t steps) {
    return leaf_layout_repeat(l, l->sets / l->steps, steps, l->coded);
}

static int rows(const leaf_layout *l, leaf_row rows[LEAF_ROWS_MAX]) {
    rows[0] = (leaf_row){0, l->treelets};
    rows[1] = (leaf_row){l->sets * l->treelets, l->shells};
    return 2;
}

static const leaf_growth growth = {
    .may = may_grow, .alike = same_axes, .repeat = repeat, .rows = rows};

const leaf_geometry grid_geometry = {.holds_indices = false,
                                     .growth = &growth,
                                     .blending = &grid_blending,
                                     .has_map = true,
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
                                     .payload_bytes = payload_bytes,
                                     .begins_run = begins_run,
                                     .series = series,
                                     .payload_name = payload_name,
                                     .parts = parts,
                                     .may_be_empty = may_be_empty,
                                     .implies = implied_payload_is,
                                     .imply = implied_payload_fill};
