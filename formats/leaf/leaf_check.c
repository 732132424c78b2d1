#include "formats/leaf/leaf_check.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/sample.h"
#include "formats/leaf/histogram.h"
#include "formats/mesh/mesh_leaf.h"

__attribute__((format(printf, 3, 4))) static status corrupt(const char *path, uint64_t at,
                                                            const char *fmt, ...) {
    char text[STATUS_TEXT_MAX / 2];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(ST_CORRUPT, "%s: byte %llu: %s", path, (unsigned long long)at, text);
}

/* ---- header ---- */

uint64_t leaf_header_checksum(const leaf_header *h) {
    leaf_header copy = *h;
    copy.checksum = 0;
    return hash_bytes(&copy, sizeof copy);
}

hash_id leaf_header_id(const leaf_header *h, const leaf_section *table) {
    struct {
        leaf_header header;
        leaf_section table[LEAF_SECTIONS_MAX];
    } all;
    uint32_t sections = h->sections < LEAF_SECTIONS_MAX ? h->sections : LEAF_SECTIONS_MAX;
    all.header = *h;
    all.header.id[0] = all.header.id[1] = 0;
    all.header.checksum = 0;
    memcpy(all.table, table, sections * sizeof *table);
    return hash_identity(&all, sizeof all.header + sections * sizeof *table);
}

static status check_frame(const char *path, const leaf_header *h, uint64_t file_bytes) {
    if (memcmp(h->magic, LEAF_MAGIC, sizeof h->magic) != 0)
        return corrupt(path, 0, "expected the mark of a treelet file; this is none");
    if (h->version != LEAF_VERSION)
        return status_describe(
            ST_UNSUPPORTED, "%s: a treelet file of version %u, where this program reads version %d",
            path, h->version, LEAF_VERSION);
    if (h->checksum != leaf_header_checksum(h))
        return corrupt(path, offsetof(leaf_header, checksum),
                       "expected the header's checksum %016llx, found %016llx",
                       (unsigned long long)leaf_header_checksum(h),
                       (unsigned long long)h->checksum);
    if (h->file_bytes != file_bytes)
        return corrupt(path, offsetof(leaf_header, file_bytes),
                       "expected the file to have %llu bytes, found %llu",
                       (unsigned long long)h->file_bytes, (unsigned long long)file_bytes);
    return ST_OK;
}

/* A field that must lie in [lo, hi]; outside, it may be a later version's, hence ST_UNSUPPORTED. */
static status check_field(const char *path, size_t at, const char *name, uint32_t value,
                          uint32_t lo, uint32_t hi) {
    if (value >= lo && value <= hi)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: byte %zu: expected %s from %u to %u, found %u",
                           path, at, name, lo, hi, value);
}

typedef struct field_limits {
    size_t at;
    const char *name;
    uint32_t value, lo, hi;
} field_limits;

#define FIELD(name, lo, hi) \
    { offsetof(leaf_header, name), #name, h->name, lo, hi }

static status check_fields(const char *path, const field_limits *fields, size_t count) {
    for (size_t i = 0; i < count; i++) {
        status st = check_field(path, fields[i].at, fields[i].name, fields[i].value, fields[i].lo,
                                fields[i].hi);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status check_grid_parameters(const char *path, const leaf_header *h) {
    const field_limits fields[] = {
        FIELD(cells_log2, LEAF_CELLS_LOG2_MIN, LEAF_CELLS_LOG2_MAX),
        FIELD(halo, 0, 1),
        FIELD(block_log2, LEAF_BLOCK_LOG2, LEAF_BLOCK_LOG2),
        FIELD(rectilinear, 0, 1),
        FIELD(fields, 1, 1),
        FIELD(steps, 1, 1),
    };
    return check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

static status check_mesh_parameters(const char *path, const leaf_header *h) {
    const field_limits fields[] = {
        FIELD(sample_type, SAMPLE_F32, SAMPLE_F32),
        FIELD(dims[0], 0, 0),
        FIELD(dims[1], 0, 0),
        FIELD(dims[2], 0, 0),
        FIELD(levels, 1, 1),
        FIELD(cells_log2, 0, 0),
        FIELD(halo, 0, 0),
        FIELD(block_log2, 0, 0),
        FIELD(rectilinear, 0, 0),
        FIELD(fields, 1, LEAF_SETS_MAX),
        FIELD(steps, 1, LEAF_SETS_MAX / (h->fields ? h->fields : 1)),
        FIELD(treelet_tets, 1, LEAF_TREELET_TETS_MAX),
        FIELD(leaf_tets, 1, LEAF_LEAF_TETS_MAX),
        FIELD(gradients, 0, 1),
        FIELD(moving, 0, h->steps > 1 ? 1 : 0),
    };
    return check_fields(path, fields, sizeof fields / sizeof fields[0]);
}

static status check_parameters(const char *path, const leaf_header *h) {
    const field_limits fields[] = {
        FIELD(kind, LEAF_KIND_GRID, LEAF_KIND_MESH),
        FIELD(sample_type, SAMPLE_U8, SAMPLE_F32),
        FIELD(source_type, SAMPLE_U8, SAMPLE_F64),
        FIELD(run_align_log2, 6, LEAF_RUN_ALIGN_LOG2_MAX),
        FIELD(codec, LEAF_CODEC_RAW, LEAF_CODEC_ZSTD),
        FIELD(sections, 1, LEAF_SECTIONS_MAX),
    };
    status st = check_fields(path, fields, sizeof fields / sizeof fields[0]);
    if (st == ST_OK)
        st = h->kind == LEAF_KIND_MESH ? check_mesh_parameters(path, h)
                                       : check_grid_parameters(path, h);
    if (st != ST_OK)
        return st;
    /* Integers with a value for no data are stored as f32, too, which has NaN for it. */
    const bool any = h->kind == LEAF_KIND_GRID && h->sample_type == SAMPLE_F32;
    if (!any && sample_stored((sample_type)h->source_type) != (sample_type)h->sample_type)
        return corrupt(path, offsetof(leaf_header, source_type),
                       "expected a type that is stored as %s, found %s",
                       sample_name((sample_type)h->sample_type),
                       sample_name((sample_type)h->source_type));
    return ST_OK;
}
#undef FIELD

/* True when a range is ordered and finite, or the empty range. */
static bool well_formed(double lo, double hi) {
    return (isfinite(lo) && isfinite(hi) && lo <= hi) ||
           (lo == (double)INFINITY && hi == -(double)INFINITY);
}

static status check_grid_values(const char *path, const leaf_header *h) {
    uint64_t samples = (uint64_t)h->dims[0] * h->dims[1] * h->dims[2];
    if (h->non_finite > samples || (h->non_finite && h->sample_type != SAMPLE_F32))
        return corrupt(path, offsetof(leaf_header, non_finite),
                       "%llu samples cannot be NaN or infinite", (unsigned long long)h->non_finite);
    const double *w = h->to_world;
    for (int i = 0; i < 12; i++)
        if (!isfinite(w[i]))
            return corrupt(path, offsetof(leaf_header, to_world) + sizeof *w * (size_t)i,
                           "expected a finite number");
    double det = w[0] * (w[5] * w[10] - w[6] * w[9]) - w[1] * (w[4] * w[10] - w[6] * w[8]) +
                 w[2] * (w[4] * w[9] - w[5] * w[8]);
    if (!(fabs(det) > 0))
        return corrupt(path, offsetof(leaf_header, to_world), "expected an invertible matrix");
    return ST_OK;
}

/* What says how many there are of something that there cannot be more of than tets. */
static status check_mesh_values(const char *path, const leaf_header *h) {
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
            return corrupt(path, numbers[i].at, "expected %llu to %llu %s, found %llu",
                           (unsigned long long)numbers[i].lo, (unsigned long long)numbers[i].hi,
                           numbers[i].name, (unsigned long long)numbers[i].value);
    for (int i = 0; i < 12; i++)
        if (h->to_world[i] != (i % 5 == 0))
            return corrupt(path, offsetof(leaf_header, to_world) + sizeof(double) * (size_t)i,
                           "expected the identity, found %g", h->to_world[i]);
    return ST_OK;
}

static status check_values(const char *path, const leaf_header *h) {
    if (!well_formed(h->value_min, h->value_max))
        return corrupt(path, offsetof(leaf_header, value_min),
                       "expected an ordered range, found %g .. %g", h->value_min, h->value_max);
    if (!(h->rounding_error >= 0))
        return corrupt(path, offsetof(leaf_header, rounding_error), "expected 0 or more, found %g",
                       h->rounding_error);
    return h->kind == LEAF_KIND_MESH ? check_mesh_values(path, h) : check_grid_values(path, h);
}

static status check_zero(const char *path, const void *bytes, size_t size, uint64_t at) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        if (b[i])
            return corrupt(path, at + i, "expected 0 in a reserved place, found %u", b[i]);
    return ST_OK;
}

/* Text ends with a NUL, and nothing hides behind it. */
static status check_text(const char *path, const char *text, size_t size, uint64_t at) {
    size_t length = strnlen(text, size);
    if (length == size)
        return corrupt(path, at, "expected a text that ends within %zu bytes", size);
    return check_zero(path, text + length, size - length, at + length);
}

/* From what only meshes have to the end of the page. */
static status check_rest(const char *path, const leaf_header *h) {
    const size_t mesh = offsetof(leaf_header, tets);
    if (h->kind != LEAF_KIND_MESH)
        return check_zero(path, (const char *)h + mesh, sizeof *h - mesh, mesh);
    status st = check_text(path, h->field, sizeof h->field, offsetof(leaf_header, field));
    return st == ST_OK
               ? check_zero(path, h->reserved, sizeof h->reserved, offsetof(leaf_header, reserved))
               : st;
}

status leaf_check_header(const char *path, const leaf_header *h, uint64_t file_bytes) {
    status st = check_frame(path, h, file_bytes);
    if (st == ST_OK)
        st = check_parameters(path, h);
    if (st == ST_OK)
        st = check_values(path, h);
    if (st == ST_OK)
        st = check_text(path, h->name, sizeof h->name, offsetof(leaf_header, name));
    if (st == ST_OK)
        st = check_text(path, h->provenance, sizeof h->provenance,
                        offsetof(leaf_header, provenance));
    if (st == ST_OK)
        st = check_zero(path, &h->reserved0, sizeof h->reserved0, offsetof(leaf_header, reserved0));
    return st == ST_OK ? check_rest(path, h) : st;
}

static uint64_t directory_bytes(const leaf_header *h) {
    uint64_t bytes = 0;
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++)
        if (!leaf_section_optional(kind))
            bytes += leaf_section_bytes(h, kind);
    return bytes;
}

static status check_grid_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    status st = leaf_layout_levels(l, h->dims, h->cells_log2, h->halo, (sample_type)h->sample_type);
    if (st != ST_OK)
        return status_describe(st, "%s: byte %zu: %s", path, offsetof(leaf_header, dims),
                               status_text());
    if (h->levels != l->levels)
        return corrupt(path, offsetof(leaf_header, levels), "expected %u levels, found %u",
                       l->levels, h->levels);
    if (h->treelets != l->treelets)
        return corrupt(path, offsetof(leaf_header, treelets), "expected %u treelets, found %llu",
                       l->treelets, (unsigned long long)h->treelets);
    if (directory_bytes(h) > h->file_bytes)
        return corrupt(path, offsetof(leaf_header, dims),
                       "a grid of %u x %u x %u has a directory of %llu bytes, "
                       "which a file of %llu cannot hold",
                       h->dims[0], h->dims[1], h->dims[2], (unsigned long long)directory_bytes(h),
                       (unsigned long long)h->file_bytes);
    return ST_OK;
}

/* fields, steps and treelets are in their ranges, so that no product overflows. */
static leaf_blocks blocks_of(const leaf_header *h) {
    return (leaf_blocks){.treelets = (uint32_t)h->treelets,
                         .fields = h->fields,
                         .steps = h->steps,
                         .gradients = h->gradients,
                         .moving = h->moving};
}

static status check_mesh_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    const leaf_blocks blocks = blocks_of(h);
    if (leaf_blocks_payloads(&blocks) >= LEAF_NO_TREELET)
        return corrupt(path, offsetof(leaf_header, treelets),
                       "expected less than 2^32 - 1 payloads, found %llu treelets and %u sets",
                       (unsigned long long)h->treelets, h->fields * h->steps);
    if (directory_bytes(h) > h->file_bytes)
        return corrupt(path, offsetof(leaf_header, treelets),
                       "a mesh of %llu treelets has a directory of %llu bytes, which a file of "
                       "%llu cannot hold",
                       (unsigned long long)h->treelets, (unsigned long long)directory_bytes(h),
                       (unsigned long long)h->file_bytes);
    leaf_layout_mesh(l, &blocks);
    return ST_OK;
}

status leaf_check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    return h->kind == LEAF_KIND_MESH ? check_mesh_layout(path, h, l)
                                     : check_grid_layout(path, h, l);
}

/* ---- sections ---- */

bool leaf_section_optional(uint32_t kind) {
    return kind == LEAF_SECTION_HISTOGRAMS || kind == LEAF_SECTION_FIELDS ||
           kind == LEAF_SECTION_TIMES || kind == LEAF_SECTION_COARSE;
}

uint64_t leaf_section_bytes(const leaf_header *h, uint32_t kind) {
    const bool mesh = h->kind == LEAF_KIND_MESH;
    const leaf_blocks blocks = blocks_of(h);
    const uint64_t sets = mesh ? (uint64_t)h->fields * h->steps : 1;
    const uint64_t payloads = mesh ? leaf_blocks_payloads(&blocks) : h->treelets;
    switch (kind) {
    case LEAF_SECTION_RANGES:
    case LEAF_SECTION_OWN: return h->treelets * sets * sizeof(float[2]);
    case LEAF_SECTION_FLAGS: return h->treelets * sets;
    case LEAF_SECTION_OFFSETS:
    case LEAF_SECTION_SIZES:
    case LEAF_SECTION_CHECKSUMS: return payloads * sizeof(uint64_t);
    case LEAF_SECTION_AXES:
        return h->rectilinear ? ((uint64_t)h->dims[0] + h->dims[1] + h->dims[2]) * sizeof(double)
                              : 0;
    case LEAF_SECTION_BOUNDS:
        return mesh ? h->treelets * (h->moving ? h->steps : 1) * sizeof(float[6]) : 0;
    case LEAF_SECTION_COUNTS: return mesh ? h->treelets * sizeof(uint32_t[4]) : 0;
    case LEAF_SECTION_FIELDS: return mesh ? h->fields * sizeof(char[64]) : 0;
    case LEAF_SECTION_TIMES: return mesh && h->steps > 1 ? h->steps * sizeof(double) : 0;
    case LEAF_SECTION_COARSE: return mesh ? sets * sizeof(leaf_part) : 0;
    case LEAF_SECTION_HISTOGRAMS: return sets <= LEAF_HISTOGRAMS_MAX ? sets * sizeof(histogram) : 0;
    default: return 0;
    }
}

/* One entry: its kind, and that it lies right behind `end`. */
static status check_section(const char *path, const leaf_header *h, const leaf_section *s,
                            uint64_t entry, uint64_t *end) {
    const bool histograms = s->kind == LEAF_SECTION_HISTOGRAMS && s->version == 1;
    bool known = (s->kind >= 1 && s->kind <= LEAF_SECTION_LAST) || histograms;
    if (!known && !(s->kind & LEAF_SECTION_ANCILLARY))
        return status_describe(
            ST_UNSUPPORTED, "%s: byte %llu: a section of kind %u, which this program does not know",
            path, (unsigned long long)entry, s->kind);
    if (known && s->version != 1)
        return status_describe(
            ST_UNSUPPORTED,
            "%s: byte %llu: section %u of version %u, where this program reads version 1", path,
            (unsigned long long)entry + offsetof(leaf_section, version), s->kind, s->version);
    const uint64_t offset = leaf_layout_aligned(*end, LEAF_ALIGN_LOG2);
    if (s->offset != offset)
        return corrupt(path, entry + offsetof(leaf_section, offset),
                       "expected section %u at byte %llu, found %llu", s->kind,
                       (unsigned long long)offset, (unsigned long long)s->offset);
    uint64_t expected = known ? leaf_section_bytes(h, s->kind) : s->bytes;
    if (s->bytes != expected || !s->bytes)
        return corrupt(path, entry + offsetof(leaf_section, bytes),
                       "expected section %u to have %llu bytes, found %llu", s->kind,
                       (unsigned long long)expected, (unsigned long long)s->bytes);
    if (s->offset > h->file_bytes || s->bytes > h->file_bytes - s->offset)
        return corrupt(path, entry + offsetof(leaf_section, bytes),
                       "section %u ends behind the file's end", s->kind);
    *end = s->offset + s->bytes;
    return ST_OK;
}

status leaf_check_sections(const char *path, const leaf_header *h, const leaf_section *table,
                           uint64_t *end) {
    hash_id id = leaf_header_id(h, table);
    if (id.lo != h->id[0] || id.hi != h->id[1])
        return corrupt(path, offsetof(leaf_header, id),
                       "expected the id %016llx%016llx, found %016llx%016llx",
                       (unsigned long long)id.hi, (unsigned long long)id.lo,
                       (unsigned long long)h->id[1], (unsigned long long)h->id[0]);
    *end = LEAF_HEADER_BYTES + (uint64_t)h->sections * sizeof *table;
    for (uint32_t i = 0; i < h->sections; i++) {
        uint64_t entry = LEAF_HEADER_BYTES + (uint64_t)i * sizeof *table;
        status st = check_section(path, h, &table[i], entry, end);
        if (st != ST_OK)
            return st;
        for (uint32_t j = 0; j < i; j++)
            if (table[j].kind == table[i].kind)
                return corrupt(path, entry, "a second section of kind %u", table[i].kind);
    }
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++) {
        bool found = false;
        for (uint32_t i = 0; i < h->sections; i++)
            found |= table[i].kind == kind;
        if (!found && !leaf_section_optional(kind) && leaf_section_bytes(h, kind))
            return corrupt(path, LEAF_HEADER_BYTES, "expected a section of kind %u, found none",
                           kind);
    }
    return ST_OK;
}

/* ---- directory ---- */

/* Payload p, when the one before it ends at `end`. */
static status check_payload(const char *path, const leaf_header *h, const leaf_layout *l,
                            const leaf_directory *d, uint32_t p, uint64_t end) {
    const uint64_t at = leaf_layout_payload_at(l, p, end, h->run_align_log2);
    const uint64_t entry = (uint64_t)p * sizeof(uint64_t);
    const uint64_t bytes = leaf_layout_payload_bytes(l, p), size = d->sizes[p];
    char name[LEAF_NAME_MAX];
    if (d->offsets[p] != at)
        return corrupt(path, d->at[LEAF_SECTION_OFFSETS - 1] + entry,
                       "expected %s at byte %llu, found %llu", leaf_layout_payload_name(l, p, name),
                       (unsigned long long)at, (unsigned long long)d->offsets[p]);
    if (!size || size > bytes || (h->codec == LEAF_CODEC_RAW && size != bytes))
        return corrupt(path, d->at[LEAF_SECTION_SIZES - 1] + entry,
                       "expected %s to have %s%llu bytes, found %llu",
                       leaf_layout_payload_name(l, p, name),
                       h->codec == LEAF_CODEC_RAW ? "" : "at most ", (unsigned long long)bytes,
                       (unsigned long long)size);
    if (at > h->file_bytes || size > h->file_bytes - at)
        return corrupt(path, d->at[LEAF_SECTION_SIZES - 1] + entry, "%s ends behind the file's end",
                       leaf_layout_payload_name(l, p, name));
    return ST_OK;
}

/* Coarse grids follow one another from `end` on; it becomes where the last one ends. */
static status check_parts(const char *path, const leaf_header *h, const leaf_directory *d,
                          uint64_t *end) {
    const uint64_t run = (uint64_t)1 << h->run_align_log2;
    for (uint32_t set = 0; set < h->fields * h->steps; set++) {
        const leaf_part *part = &d->parts[set];
        const uint64_t entry = d->at[LEAF_SECTION_COARSE - 1] + set * sizeof *part;
        if (!part->offset && !part->bytes && !part->id[0] && !part->id[1])
            continue;
        if (part->offset != *end)
            return corrupt(path, entry,
                           "expected the coarse grid of set %u at byte %llu, found %llu", set,
                           (unsigned long long)*end, (unsigned long long)part->offset);
        if (part->bytes < LEAF_HEADER_BYTES || part->bytes % run || part->offset > h->file_bytes ||
            part->bytes > h->file_bytes - part->offset)
            return corrupt(path, entry + offsetof(leaf_part, bytes),
                           "a coarse grid of %llu bytes cannot be in this file",
                           (unsigned long long)part->bytes);
        *end = part->offset + part->bytes;
    }
    return ST_OK;
}

static status check_payloads(const char *path, const leaf_header *h, const leaf_layout *l,
                             const leaf_directory *d) {
    uint64_t end = d->end, sum = 0;
    for (uint32_t p = 0; p < l->payloads; p++) {
        status st = check_payload(path, h, l, d, p, end);
        if (st != ST_OK)
            return st;
        end = d->offsets[p] + d->sizes[p];
        sum += d->sizes[p];
    }
    end = leaf_layout_aligned(end, h->run_align_log2);
    status st = d->parts ? check_parts(path, h, d, &end) : ST_OK;
    if (st != ST_OK)
        return st;
    if (end != h->file_bytes)
        return corrupt(path, offsetof(leaf_header, file_bytes),
                       "expected a file of %llu bytes after its last payload%s, found %llu",
                       (unsigned long long)end, d->parts ? " and its coarse grids" : "",
                       (unsigned long long)h->file_bytes);
    if (sum != h->payload_bytes)
        return corrupt(path, offsetof(leaf_header, payload_bytes),
                       "expected %llu bytes of payloads, found %llu", (unsigned long long)sum,
                       (unsigned long long)h->payload_bytes);
    return ST_OK;
}

/* What integer samples can have as their range. */
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

/* One treelet's own and merged range. A merged range is compared by value, so that -0 and 0 are the
 * same. */
static status check_ranges(const char *path, const leaf_layout *l, const leaf_directory *d,
                           uint32_t t) {
    const float *own = d->own[t], *merged = d->ranges[t];
    uint64_t entry = (uint64_t)t * sizeof(float[2]);
    if (!well_formed((double)own[0], (double)own[1]) || !of_type(l->type, own))
        return corrupt(path, d->at[LEAF_SECTION_OWN - 1] + entry,
                       "treelet %u's own range %g .. %g is none of %s samples", t, (double)own[0],
                       (double)own[1], sample_name(l->type));
    float lo = own[0], hi = own[1];
    uint32_t child = l->first_child[t];
    for (unsigned n = (unsigned)__builtin_popcount(leaf_layout_children(l, t)); n > 0;
         n--, child++) {
        lo = fminf(lo, d->ranges[child][0]);
        hi = fmaxf(hi, d->ranges[child][1]);
    }
    if (merged[0] != lo || merged[1] != hi)
        return corrupt(path, d->at[LEAF_SECTION_RANGES - 1] + entry,
                       "expected treelet %u's merged range to be its own and its children's %g .. "
                       "%g, found %g .. %g",
                       t, (double)lo, (double)hi, (double)merged[0], (double)merged[1]);
    return ST_OK;
}

static status check_flags(const char *path, const leaf_header *h, const leaf_directory *d,
                          size_t element) {
    const uint8_t flags = d->flags[element];
    if (!(flags & ~(unsigned)LEAF_FLAG_NON_FINITE) && (!flags || h->non_finite))
        return ST_OK;
    return corrupt(path, d->at[LEAF_SECTION_FLAGS - 1] + element,
                   "treelet %zu cannot have the flags 0x%02x", element, flags);
}

/* What the header says of all values against what treelets say: their range, and that there are
 * non-finite ones. */
static status check_union(const char *path, const leaf_header *h, const double range[2],
                          unsigned flags) {
    if (h->value_min != range[0] || h->value_max != range[1])
        return corrupt(path, offsetof(leaf_header, value_min),
                       "expected the treelets' value range %g .. %g, found %g .. %g", range[0],
                       range[1], h->value_min, h->value_max);
    if (h->non_finite && !flags)
        return corrupt(path, offsetof(leaf_header, non_finite),
                       "%llu samples are NaN or infinite, but no treelet says so",
                       (unsigned long long)h->non_finite);
    return ST_OK;
}

static void widen(double range[2], const float own[2]) {
    range[0] = fmin(range[0], (double)own[0]);
    range[1] = fmax(range[1], (double)own[1]);
}

static status check_grid_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                   const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    unsigned level0_flags = 0;
    for (uint32_t t = l->treelets; t-- > 0;) {
        status st = check_ranges(path, l, d, t);
        if (st == ST_OK)
            st = check_flags(path, h, d, t);
        if (st != ST_OK)
            return st;
        if (l->level_of[t] == 0) {
            widen(range, d->own[t]);
            level0_flags |= d->flags[t];
        }
    }
    return check_union(path, h, range, level0_flags);
}

/* ---- directory of a mesh ---- */

status leaf_check_counts(const char *path, const leaf_header *h, const leaf_directory *d) {
    uint64_t tets = 0, vertices = 0, most = 0;
    for (uint64_t t = 0; t < h->treelets; t++) {
        const uint32_t *c = d->counts[t];
        const char *fault = mesh_leaf_counts_fault(c, h->treelet_tets, h->leaf_tets);
        if (fault)
            return corrupt(path, d->at[LEAF_SECTION_COUNTS - 1] + t * sizeof *d->counts,
                           "treelet %llu of %u tets, %u vertices, %u nodes, %u leaves cannot have "
                           "%s",
                           (unsigned long long)t, c[0], c[1], c[2], c[3], fault);
        tets += c[0];
        vertices += c[1];
        most = c[1] > most ? c[1] : most;
    }
    if (tets != h->tets)
        return corrupt(path, offsetof(leaf_header, tets),
                       "expected the treelets' %llu tets, found %llu", (unsigned long long)tets,
                       (unsigned long long)h->tets);
    if (h->vertices < most || h->vertices > vertices)
        return corrupt(path, offsetof(leaf_header, vertices),
                       "expected %llu to %llu vertices, as the treelets have, found %llu",
                       (unsigned long long)most, (unsigned long long)vertices,
                       (unsigned long long)h->vertices);
    return ST_OK;
}

static status check_bounds(const char *path, const leaf_header *h, const leaf_layout *l,
                           const leaf_directory *d) {
    const size_t count = l->treelets * (size_t)(1 + l->moved_steps);
    for (int a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            const float *b = d->bounds[i];
            if (!isfinite(b[a]) || !isfinite(b[a + 3]) || b[a] > b[a + 3])
                return corrupt(path, d->at[LEAF_SECTION_BOUNDS - 1] + i * sizeof *d->bounds,
                               "treelet %zu's bounds along %c at step %zu, %g .. %g, are none",
                               i % l->treelets, "xyz"[a], i / l->treelets, (double)b[a],
                               (double)b[a + 3]);
            lo = fminf(lo, b[a]);
            hi = fmaxf(hi, b[a + 3]);
        }
        if (h->bounds[a] != lo || h->bounds[a + 3] != hi)
            return corrupt(path, offsetof(leaf_header, bounds),
                           "expected the treelets' bounds along %c, %g .. %g, found %g .. %g",
                           "xyz"[a], (double)lo, (double)hi, (double)h -> bounds[a],
                           (double)h -> bounds[a + 3]);
    }
    return ST_OK;
}

static status check_mesh_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                                   const leaf_directory *d) {
    double range[2] = {(double)INFINITY, -(double)INFINITY};
    unsigned flags = 0;
    for (size_t i = 0; i < (size_t)l->treelets * l->sets; i++) {
        const float *own = d->own[i];
        if (!well_formed((double)own[0], (double)own[1]))
            return corrupt(path, d->at[LEAF_SECTION_OWN - 1] + i * sizeof *d->own,
                           "element %zu, %g .. %g, is no range", i, (double)own[0], (double)own[1]);
        if (memcmp(own, d->ranges[i], sizeof *d->own) != 0)
            return corrupt(path, d->at[LEAF_SECTION_RANGES - 1] + i * sizeof *d->ranges,
                           "expected the own range %g .. %g, found %g .. %g", (double)own[0],
                           (double)own[1], (double)d->ranges[i][0], (double)d->ranges[i][1]);
        status st = check_flags(path, h, d, i);
        if (st != ST_OK)
            return st;
        widen(range, own);
        flags |= d->flags[i];
    }
    status st = check_union(path, h, range, flags);
    return st == ST_OK ? check_bounds(path, h, l, d) : st;
}

status leaf_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                            const leaf_directory *d) {
    status st = check_payloads(path, h, l, d);
    if (st != ST_OK)
        return st;
    return l->sets ? check_mesh_directory(path, h, l, d) : check_grid_directory(path, h, l, d);
}

status leaf_check_names(const char *path, const leaf_header *h, const char (*names)[64],
                        uint64_t at) {
    for (uint32_t i = 0; i < h->fields; i++) {
        status st = check_text(path, names[i], sizeof names[i], at + i * sizeof names[i]);
        if (st != ST_OK)
            return st;
    }
    if (memcmp(names[0], h->field, sizeof h->field) == 0)
        return ST_OK;
    return corrupt(path, at, "expected the header's first field \"%s\", found \"%s\"", h->field,
                   names[0]);
}

status leaf_check_axis(const char *path, const double *axis, uint32_t count, uint64_t at) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(axis[i]) || (i > 0 && axis[i] <= axis[i - 1]))
            return corrupt(path, at + i * sizeof *axis,
                           "expected strictly increasing coordinates, found %g", axis[i]);
    return ST_OK;
}
