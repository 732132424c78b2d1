#include "formats/leaf/leaf_check.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/sample.h"
#include "formats/leaf/histogram.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_order.h"

status leaf_check_corrupt(const char *path, uint64_t at, const char *fmt, ...) {
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
    all.header.last = 0;
    all.header.segments = 0;
    memcpy(all.table, table, sections * sizeof *table);
    return hash_identity(&all, sizeof all.header + sections * sizeof *table);
}

static status check_frame(const char *path, const leaf_header *h, uint64_t file_bytes) {
    if (memcmp(h->magic, LEAF_MAGIC, sizeof h->magic) != 0)
        return leaf_check_corrupt(
            path, 0,
            "expected the mark of a treelet file; leafcast convert makes one of other formats");
    if (h->version != LEAF_VERSION)
        return status_describe(
            ST_UNSUPPORTED, "%s: a treelet file of version %u, where this program reads version %d",
            path, h->version, LEAF_VERSION);
    if (h->checksum != leaf_header_checksum(h))
        return leaf_check_corrupt(path, offsetof(leaf_header, checksum),
                                  "expected the header's checksum %016llx, found %016llx",
                                  (unsigned long long)leaf_header_checksum(h),
                                  (unsigned long long)h->checksum);
    if (h->file_bytes != file_bytes)
        return leaf_check_corrupt(path, offsetof(leaf_header, file_bytes),
                                  "expected the file to have %llu bytes, found %llu",
                                  (unsigned long long)h->file_bytes,
                                  (unsigned long long)file_bytes);
    return ST_OK;
}

/* Check a field that must lie in [lo, hi]. A value outside may be a later version's, hence
 * ST_UNSUPPORTED. */
static status check_field(const char *path, size_t at, const char *name, uint32_t value,
                          uint32_t lo, uint32_t hi) {
    if (value >= lo && value <= hi)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: byte %zu: expected %s from %u to %u, found %u",
                           path, at, name, lo, hi, value);
}

status leaf_check_fields(const char *path, const leaf_field *fields, size_t count) {
    for (size_t i = 0; i < count; i++) {
        status st = check_field(path, fields[i].at, fields[i].name, fields[i].value, fields[i].lo,
                                fields[i].hi);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status check_parameters(const char *path, const leaf_header *h) {
    const leaf_field fields[] = {
        LEAF_FIELD(h, sample_type, SAMPLE_U8, SAMPLE_F32),
        LEAF_FIELD(h, source_type, SAMPLE_U8, SAMPLE_I64),
        LEAF_FIELD(h, run_align_log2, 6, LEAF_RUN_ALIGN_LOG2_MAX),
        LEAF_FIELD(h, codec, LEAF_CODEC_RAW, LEAF_CODEC_ZSTD),
        LEAF_FIELD(h, sections, 1, LEAF_SECTIONS_MAX),
    };
    const leaf_geometry *g = leaf_geometry_of(h->kind);
    if (!g)
        return status_describe(
            ST_UNSUPPORTED, "%s: byte %zu: a geometry of kind %u, which this program does not know",
            path, offsetof(leaf_header, kind), h->kind);
    status st = leaf_check_fields(path, fields, sizeof fields / sizeof fields[0]);
    return st == ST_OK ? g->check_parameters(path, h) : st;
}

status leaf_check_source(const char *path, const leaf_header *h) {
    if (sample_stored((sample_type)h->source_type) == (sample_type)h->sample_type)
        return ST_OK;
    return leaf_check_corrupt(
        path, offsetof(leaf_header, source_type), "expected a type that is stored as %s, found %s",
        sample_name((sample_type)h->sample_type), sample_name((sample_type)h->source_type));
}

bool leaf_check_well_formed(double lo, double hi) {
    return (isfinite(lo) && isfinite(hi) && lo <= hi) ||
           (lo == (double)INFINITY && hi == -(double)INFINITY);
}

static status check_values(const char *path, const leaf_header *h) {
    if (!leaf_check_well_formed(h->value_min, h->value_max))
        return leaf_check_corrupt(path, offsetof(leaf_header, value_min),
                                  "expected an ordered range, found %g .. %g", h->value_min,
                                  h->value_max);
    if (!(h->rounding_error >= 0))
        return leaf_check_corrupt(path, offsetof(leaf_header, rounding_error),
                                  "expected 0 or more, found %g", h->rounding_error);
    return leaf_geometry_of(h->kind)->check_values(path, h);
}

status leaf_check_zero(const char *path, const void *bytes, size_t size, uint64_t at) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        if (b[i])
            return leaf_check_corrupt(path, at + i, "expected 0 in a reserved place, found %u",
                                      b[i]);
    return ST_OK;
}

status leaf_check_text(const char *path, const char *text, size_t size, uint64_t at) {
    size_t length = strnlen(text, size);
    if (length == size)
        return leaf_check_corrupt(path, at, "expected a text that ends within %zu bytes", size);
    return leaf_check_zero(path, text + length, size - length, at + length);
}

/* Check where the directory is. Its sections' places say the rest. */
static status check_directory_place(const char *path, const leaf_header *h) {
    const uint64_t table = h->sections * sizeof(leaf_section);
    if (!h->directory || (h->directory % LEAF_ALIGN == 0 && h->directory >= LEAF_HEADER_BYTES &&
                          h->directory < h->file_bytes && table <= h->file_bytes - h->directory))
        return ST_OK;
    return leaf_check_corrupt(path, offsetof(leaf_header, directory),
                              "expected a directory within the file, found it at byte %llu",
                              (unsigned long long)h->directory);
}

/* Check what the header says of segments. The file's length, and the headers of the others, say the
 * rest. */
static status check_segment(const char *path, const leaf_header *h) {
    const uint64_t sets = ((uint64_t)h->steps_before + h->steps) * h->fields;
    const leaf_growth *growth = leaf_geometry_of(h->kind)->growth;
    const char *why;
    if (leaf_has_segments(h) && !growth)
        return status_describe(ST_UNSUPPORTED, "%s: byte %zu: a file of this kind cannot grow",
                               path, offsetof(leaf_header, segments));
    if (leaf_has_segments(h) && !growth->may(h, &why))
        return leaf_check_corrupt(path, offsetof(leaf_header, segments),
                                  "a file that grows, but %s", why);
    const bool first = h->segments > 1 ? h->last >= h->file_bytes : !h->last;
    if (h->steps_before ? h->segments || h->last || !h->directory || sets > LEAF_SETS_MAX
                        : h->before || !first || h->segments > LEAF_SETS_MAX)
        return leaf_check_corrupt(path, offsetof(leaf_header, last),
                                  "expected the place of a segment, found %u of %u steps before, "
                                  "the last at byte %llu",
                                  h->segments, h->steps_before, (unsigned long long)h->last);
    return ST_OK;
}

status leaf_check_header(const char *path, const leaf_header *h, uint64_t file_bytes) {
    status st = check_frame(path, h, file_bytes);
    if (st == ST_OK)
        st = check_parameters(path, h);
    if (st == ST_OK)
        st = check_values(path, h);
    if (st == ST_OK)
        st = leaf_check_text(path, h->name, sizeof h->name, offsetof(leaf_header, name));
    if (st == ST_OK)
        st = leaf_check_text(path, h->provenance, sizeof h->provenance,
                             offsetof(leaf_header, provenance));
    if (st == ST_OK)
        st = leaf_geometry_of(h->kind)->check_rest(path, h);
    if (st == ST_OK)
        st = check_directory_place(path, h);
    return st == ST_OK ? check_segment(path, h) : st;
}

uint64_t leaf_check_directory_bytes(const leaf_header *h) {
    uint64_t bytes = 0;
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++)
        if (!leaf_section_optional(kind))
            bytes += leaf_section_bytes(h, kind);
    return bytes;
}

bool leaf_check_may_hold(const leaf_header *h) {
    enum { MOST_RATIO = 1024 };
    const uint64_t bytes = leaf_check_directory_bytes(h);
    return (h->directory ? bytes / MOST_RATIO : bytes) <= h->file_bytes;
}

status leaf_check_layout(const char *path, const leaf_header *h, leaf_layout *l) {
    return leaf_geometry_of(h->kind)->check_layout(path, h, l);
}

/* ---- sections ---- */

bool leaf_section_ancillary(uint32_t kind) {
    return kind > LEAF_SECTION_ANCILLARY && kind <= (LEAF_SECTION_ANCILLARY | LEAF_ANCILLARY_LAST);
}

bool leaf_section_optional(uint32_t kind) {
    return leaf_section_ancillary(kind) || kind == LEAF_SECTION_FIELDS ||
           kind == LEAF_SECTION_TIMES || kind == LEAF_SECTION_COARSE || kind == LEAF_SECTION_SAME ||
           kind == LEAF_SECTION_BASES;
}

/* Whether steps may have times: there are several, or others may come. */
static bool has_times(const leaf_header *h) {
    return h->steps > 1 || leaf_has_segments(h);
}

uint64_t leaf_section_bytes(const leaf_header *h, uint32_t kind) {
    const leaf_geometry *g = leaf_geometry_of(h->kind);
    const uint64_t sets = g ? g->sets(h) : 0;
    if (!g)
        return 0;
    switch (kind) {
    case LEAF_SECTION_RANGES:
    case LEAF_SECTION_OWN: return h->treelets * sets * sizeof(float[2]);
    case LEAF_SECTION_FLAGS: return h->treelets * sets;
    case LEAF_SECTION_OFFSETS:
    case LEAF_SECTION_SIZES:
    case LEAF_SECTION_CHECKSUMS: return g->payloads(h) * sizeof(uint64_t);
    case LEAF_SECTION_SAME: return leaf_is_behind(h) ? g->payloads(h) * sizeof(uint32_t) : 0;
    case LEAF_SECTION_FIELDS: return g->labels(h) ? h->fields * sizeof(char[64]) : 0;
    case LEAF_SECTION_TIMES: return g->labels(h) && has_times(h) ? h->steps * sizeof(double) : 0;
    case LEAF_SECTION_HISTOGRAMS: return sets <= LEAF_HISTOGRAMS_MAX ? sets * sizeof(histogram) : 0;
    case LEAF_SECTION_WORLD: return sizeof(world_frame);
    case LEAF_SECTION_COARSE:
        return g->coarse && !leaf_has_segments(h) ? sets * sizeof(leaf_part) : 0;
    default: return g->section_bytes(h, kind);
    }
}

/* Check one entry: its kind and size, and that its section lies right behind `end`. */
static status check_section(const char *path, const leaf_header *h, const leaf_section *s,
                            uint64_t entry, uint64_t *end) {
    const bool readable = s->version == LEAF_SECTION_PLAIN || s->version == LEAF_SECTION_ZSTD;
    const bool known = (s->kind >= 1 && s->kind <= LEAF_SECTION_LAST) ||
                       (leaf_section_ancillary(s->kind) && readable);
    if (!known && !(s->kind & LEAF_SECTION_ANCILLARY))
        return status_describe(
            ST_UNSUPPORTED, "%s: byte %llu: a section of kind %u, which this program does not know",
            path, (unsigned long long)entry, s->kind);
    if (known && !readable)
        return status_describe(
            ST_UNSUPPORTED,
            "%s: byte %llu: section %u of version %u, where this program reads versions 1 and 2",
            path, (unsigned long long)entry + offsetof(leaf_section, version), s->kind, s->version);
    const uint64_t offset = leaf_layout_aligned(*end, LEAF_ALIGN_LOG2);
    if (s->offset != offset)
        return leaf_check_corrupt(path, entry + offsetof(leaf_section, offset),
                                  "expected section %u at byte %llu, found %llu", s->kind,
                                  (unsigned long long)offset, (unsigned long long)s->offset);
    const uint64_t content = known ? leaf_section_bytes(h, s->kind) : s->bytes;
    const bool packed = known && s->version == LEAF_SECTION_ZSTD;
    if (packed && (!h->directory || !content || s->bytes >= content))
        return leaf_check_corrupt(path, entry + offsetof(leaf_section, version),
                                  "section %u cannot be a frame of %llu bytes", s->kind,
                                  (unsigned long long)s->bytes);
    const bool of_series = s->kind == LEAF_SECTION_SAME || s->kind == LEAF_SECTION_BASES;
    const uint64_t expected = packed ? s->bytes : of_series && !h->directory ? 0 : content;
    if (s->bytes != expected || !s->bytes)
        return leaf_check_corrupt(path, entry + offsetof(leaf_section, bytes),
                                  "expected section %u to have %llu bytes, found %llu", s->kind,
                                  (unsigned long long)expected, (unsigned long long)s->bytes);
    if (s->offset > h->file_bytes || s->bytes > h->file_bytes - s->offset)
        return leaf_check_corrupt(path, entry + offsetof(leaf_section, bytes),
                                  "section %u ends behind the file's end", s->kind);
    *end = s->offset + s->bytes;
    return ST_OK;
}

status leaf_check_sections(const char *path, const leaf_header *h, const leaf_section *table,
                           uint64_t *end) {
    hash_id id = leaf_header_id(h, table);
    if (id.lo != h->id[0] || id.hi != h->id[1])
        return leaf_check_corrupt(path, offsetof(leaf_header, id),
                                  "expected the id %016llx%016llx, found %016llx%016llx",
                                  (unsigned long long)id.hi, (unsigned long long)id.lo,
                                  (unsigned long long)h->id[1], (unsigned long long)h->id[0]);
    *end = leaf_table_at(h) + (uint64_t)h->sections * sizeof *table;
    for (uint32_t i = 0; i < h->sections; i++) {
        uint64_t entry = leaf_table_at(h) + (uint64_t)i * sizeof *table;
        status st = check_section(path, h, &table[i], entry, end);
        if (st != ST_OK)
            return st;
        for (uint32_t j = 0; j < i; j++)
            if (table[j].kind == table[i].kind)
                return leaf_check_corrupt(path, entry, "a second section of kind %u",
                                          table[i].kind);
    }
    for (uint32_t kind = 1; kind <= LEAF_SECTION_LAST; kind++) {
        bool found = false;
        for (uint32_t i = 0; i < h->sections; i++)
            found |= table[i].kind == kind;
        if (!found && !leaf_section_optional(kind) && leaf_section_bytes(h, kind))
            return leaf_check_corrupt(path, leaf_table_at(h),
                                      "expected a section of kind %u, found none", kind);
    }
    return ST_OK;
}

/* ---- directory ---- */

/* Whether payload p may have no bytes, and whether it must have none. */
static bool may_be_empty(const leaf_layout *l, const leaf_directory *d, uint32_t p, bool *must) {
    *must = false;
    return l->geometry->may_be_empty && l->geometry->may_be_empty(l, p, d, must);
}

/* Check that a payload without bytes has no checksum, unless it has samples outside. */
static status check_no_checksum(const char *path, const leaf_layout *l, const leaf_directory *d,
                                uint32_t p) {
    char name[LEAF_NAME_MAX];
    if (!d->checksums[p] || leaf_layout_is_outside(l, p))
        return ST_OK;
    return leaf_check_corrupt(path, d->at[LEAF_SECTION_CHECKSUMS - 1] + p * sizeof(uint64_t),
                              "expected 0 as the checksum of %s, which has no bytes, found %016llx",
                              leaf_layout_payload_name(l, p, name),
                              (unsigned long long)d->checksums[p]);
}

/* The payload that an entry of SAME or BASES leads to from p, if that has bytes of its own and
 * comes from an earlier set; else LEAF_NO_TREELET. */
static uint32_t led_to(const leaf_layout *l, const leaf_directory *d, uint32_t p, uint32_t entry) {
    const leaf_series s = leaf_layout_series(l, p);
    if (entry > s.at)
        return LEAF_NO_TREELET;
    const uint32_t q = leaf_series_payload(&s, entry - 1);
    return d->sizes[q] && !(d->links.same && d->links.same[q]) ? q : LEAF_NO_TREELET;
}

/* Whether an entry of SAME or BASES leads to an earlier segment. What lies there is checked where
 * segments become one file. */
static bool leads_before(const leaf_header *h, const leaf_layout *l, uint32_t entry) {
    return entry & LEAF_LINK_BEFORE &&
           (entry ^ LEAF_LINK_BEFORE) < (uint64_t)h->steps_before * (l->sets / l->steps);
}

/* Check that payload p has the bytes of another, and stands where that does. */
static status check_same(const char *path, const leaf_header *h, const leaf_layout *l,
                         const leaf_directory *d, uint32_t p) {
    char name[LEAF_NAME_MAX];
    if (leads_before(h, l, d->links.same[p]) && !d->offsets[p] &&
        !(d->links.bases && d->links.bases[p]))
        return ST_OK;
    const uint32_t q = led_to(l, d, p, d->links.same[p]);
    if (q != LEAF_NO_TREELET && d->offsets[p] == d->offsets[q] && d->sizes[p] == d->sizes[q] &&
        d->checksums[p] == d->checksums[q] && !(d->links.bases && d->links.bases[p]))
        return ST_OK;
    return leaf_check_corrupt(path, d->at[LEAF_SECTION_SAME - 1] + p * sizeof *d->links.same,
                              "%s cannot be the same as that of set %u",
                              leaf_layout_payload_name(l, p, name), d->links.same[p] - 1);
}

/* Check that a reader comes from payload p to a whole code, by a few bases. */
static status check_base(const char *path, const leaf_header *h, const leaf_layout *l,
                         const leaf_directory *d, uint32_t p) {
    uint32_t q = p;
    char name[LEAF_NAME_MAX];
    for (int codes = 1;
         q != LEAF_NO_TREELET && d->links.bases[q] && !leads_before(h, l, d->links.bases[q]);
         codes++)
        q = codes < LEAF_CHAIN_MAX ? led_to(l, d, q, d->links.bases[q]) : LEAF_NO_TREELET;
    if (q != LEAF_NO_TREELET && d->sizes[p])
        return ST_OK;
    return leaf_check_corrupt(path, d->at[LEAF_SECTION_BASES - 1] + p * sizeof *d->links.bases,
                              "%s cannot have the base of set %u",
                              leaf_layout_payload_name(l, p, name), d->links.bases[p] - 1);
}

/* Check payload p, and advance *place. */
static status check_payload(const char *path, const leaf_header *h, const leaf_layout *l,
                            const leaf_directory *d, uint32_t p, leaf_placing *place) {
    const bool same = d->links.same && d->links.same[p];
    const uint64_t next = leaf_placing_next(place, l, p, same ? 0 : d->sizes[p], h->run_align_log2);
    const uint64_t at = same ? d->offsets[p] : next;
    const uint64_t entry = (uint64_t)p * sizeof(uint64_t);
    const uint64_t bytes = leaf_layout_stored(l, p), size = d->sizes[p];
    char name[LEAF_NAME_MAX];
    bool empty;
    if (d->offsets[p] != at)
        return leaf_check_corrupt(path, d->at[LEAF_SECTION_OFFSETS - 1] + entry,
                                  "expected %s at byte %llu, found %llu",
                                  leaf_layout_payload_name(l, p, name), (unsigned long long)at,
                                  (unsigned long long)d->offsets[p]);
    if (may_be_empty(l, d, p, &empty) && !size)
        return check_no_checksum(path, l, d, p);
    if (empty)
        return leaf_check_corrupt(path, d->at[LEAF_SECTION_SIZES - 1] + entry,
                                  "expected %s to have no bytes, found %llu",
                                  leaf_layout_payload_name(l, p, name), (unsigned long long)size);
    if (!size || size > bytes || (h->codec == LEAF_CODEC_RAW && size != bytes))
        return leaf_check_corrupt(path, d->at[LEAF_SECTION_SIZES - 1] + entry,
                                  "expected %s to have %s%llu bytes, found %llu",
                                  leaf_layout_payload_name(l, p, name),
                                  h->codec == LEAF_CODEC_RAW ? "" : "at most ",
                                  (unsigned long long)bytes, (unsigned long long)size);
    const bool elsewhere = same && leads_before(h, l, d->links.same[p]);
    if (!elsewhere && (at > h->file_bytes || size > h->file_bytes - at))
        return leaf_check_corrupt(path, d->at[LEAF_SECTION_SIZES - 1] + entry,
                                  "%s ends behind the file's end",
                                  leaf_layout_payload_name(l, p, name));
    return same ? check_same(path, h, l, d, p) : ST_OK;
}

/* Check that coarse grids follow one another from *end on; *end becomes where the last one ends. */
static status check_parts(const char *path, const leaf_header *h, const leaf_directory *d,
                          uint64_t *end) {
    const uint64_t run = (uint64_t)1 << h->run_align_log2;
    for (uint32_t set = 0; set < h->fields * h->steps; set++) {
        const leaf_part *part = &d->parts[set];
        const uint64_t entry = d->at[LEAF_SECTION_COARSE - 1] + set * sizeof *part;
        if (!part->offset && !part->bytes && !part->id[0] && !part->id[1])
            continue;
        if (part->offset != *end)
            return leaf_check_corrupt(
                path, entry, "expected the coarse grid of set %u at byte %llu, found %llu", set,
                (unsigned long long)*end, (unsigned long long)part->offset);
        if (part->bytes < LEAF_HEADER_BYTES || part->bytes % run || part->offset > h->file_bytes ||
            part->bytes > h->file_bytes - part->offset)
            return leaf_check_corrupt(path, entry + offsetof(leaf_part, bytes),
                                      "a coarse grid of %llu bytes cannot be in this file",
                                      (unsigned long long)part->bytes);
        *end = part->offset + part->bytes;
    }
    return ST_OK;
}

/* Check where payloads end, and that the directory follows them if it does not lie before. *end:
 * where both end. */
static status check_payloads_end(const char *path, const leaf_header *h, const leaf_directory *d,
                                 uint64_t payloads, uint64_t *end) {
    const uint64_t table = leaf_layout_aligned(payloads, LEAF_ALIGN_LOG2);
    *end = leaf_layout_aligned(h->directory ? d->end : payloads, h->run_align_log2);
    if (!h->directory || h->directory == table)
        return ST_OK;
    return leaf_check_corrupt(path, offsetof(leaf_header, directory),
                              "expected the directory behind the payloads, at byte %llu, found it "
                              "at %llu",
                              (unsigned long long)table, (unsigned long long)h->directory);
}

static status check_payloads(const char *path, const leaf_header *h, const leaf_layout *l,
                             const leaf_directory *d) {
    leaf_placing place = {.end = leaf_payloads_at(h, d->end)};
    uint64_t sum = 0, end;
    for (leaf_order o = leaf_order_begin(l); o.p < l->payloads; leaf_order_next(&o, l)) {
        status st = check_payload(path, h, l, d, o.p, &place);
        if (st == ST_OK && d->links.bases && d->links.bases[o.p])
            st = check_base(path, h, l, d, o.p);
        if (st != ST_OK)
            return st;
        sum += d->links.same && d->links.same[o.p] ? 0 : d->sizes[o.p];
    }
    status st = check_payloads_end(path, h, d, place.end, &end);
    if (st != ST_OK)
        return st;
    st = d->parts ? check_parts(path, h, d, &end) : ST_OK;
    if (st != ST_OK)
        return st;
    if (end != h->file_bytes)
        return leaf_check_corrupt(
            path, offsetof(leaf_header, file_bytes),
            "expected a file of %llu bytes after its last payload%s, found %llu",
            (unsigned long long)end, d->parts ? " and its coarse grids" : "",
            (unsigned long long)h->file_bytes);
    if (sum != h->payload_bytes)
        return leaf_check_corrupt(path, offsetof(leaf_header, payload_bytes),
                                  "expected %llu bytes of payloads, found %llu",
                                  (unsigned long long)sum, (unsigned long long)h->payload_bytes);
    return ST_OK;
}

status leaf_check_flags(const char *path, const leaf_header *h, const leaf_directory *d,
                        size_t element) {
    const uint8_t flags = d->flags[element];
    if (!(flags & ~(unsigned)LEAF_FLAG_NON_FINITE) && (!flags || h->non_finite))
        return ST_OK;
    return leaf_check_corrupt(path, d->at[LEAF_SECTION_FLAGS - 1] + element,
                              "treelet %zu cannot have the flags 0x%02x", element, flags);
}

status leaf_check_union(const char *path, const leaf_header *h, const double range[2],
                        unsigned flags) {
    if (h->value_min != range[0] || h->value_max != range[1])
        return leaf_check_corrupt(path, offsetof(leaf_header, value_min),
                                  "expected the treelets' value range %g .. %g, found %g .. %g",
                                  range[0], range[1], h->value_min, h->value_max);
    if (h->non_finite && !flags)
        return leaf_check_corrupt(path, offsetof(leaf_header, non_finite),
                                  "%llu samples are NaN or infinite, but no treelet says so",
                                  (unsigned long long)h->non_finite);
    return ST_OK;
}

void leaf_check_widen(double range[2], const float own[2]) {
    range[0] = fmin(range[0], (double)own[0]);
    range[1] = fmax(range[1], (double)own[1]);
}

status leaf_check_directory(const char *path, const leaf_header *h, const leaf_layout *l,
                            const leaf_directory *d) {
    status st = check_payloads(path, h, l, d);
    if (st != ST_OK)
        return st;
    return l->geometry->check_directory(path, h, l, d);
}

status leaf_check_axis(const char *path, const double *axis, uint32_t count, uint64_t at) {
    for (uint32_t i = 0; i < count; i++)
        if (!isfinite(axis[i]) || (i > 0 && axis[i] <= axis[i - 1]))
            return leaf_check_corrupt(path, at + i * sizeof *axis,
                                      "expected strictly increasing coordinates, found %g",
                                      axis[i]);
    return ST_OK;
}

status leaf_check_world(const char *path, const leaf_header *h, const world_frame *f, uint64_t at) {
    const uint32_t most = leaf_geometry_of(h->kind)->has_map ? WORLD_AXES - 1 : WORLD_UNTOLD;
    if (f->axes > most)
        return leaf_check_corrupt(path, at, "expected axes of number 0 to %u, found %u", most,
                                  f->axes);
    if (!world_frame_is_told(f))
        return leaf_check_corrupt(path, at, "expected axes or units, found nothing but zeros");
    status st = leaf_check_zero(path, &f->reserved0, sizeof f->reserved0,
                                at + offsetof(world_frame, reserved0));
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = leaf_check_text(path, f->unit[a], sizeof f->unit[a],
                             at + offsetof(world_frame, unit) + (size_t)a * sizeof f->unit[a]);
    if (st == ST_OK)
        st = leaf_check_text(path, f->time_unit, sizeof f->time_unit,
                             at + offsetof(world_frame, time_unit));
    return st == ST_OK ? leaf_check_zero(path, f->reserved, sizeof f->reserved,
                                         at + offsetof(world_frame, reserved))
                       : st;
}

status leaf_check_bounds(const char *path, const leaf_header *h, const leaf_layout *l,
                         const leaf_directory *d) {
    const size_t count = (size_t)l->treelets * l->places;
    for (int a = 0; a < 3; a++) {
        float lo = INFINITY, hi = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            const float *b = d->bounds[i];
            if (!isfinite(b[a]) || !isfinite(b[a + 3]) || b[a] > b[a + 3])
                return leaf_check_corrupt(
                    path, d->at[LEAF_SECTION_BOUNDS - 1] + i * sizeof *d->bounds,
                    "treelet %zu's bounds along %c at step %zu, %g .. %g, are none",
                    i % l->treelets, "xyz"[a], i / l->treelets, (double)b[a], (double)b[a + 3]);
            lo = fminf(lo, b[a]);
            hi = fmaxf(hi, b[a + 3]);
        }
        if (h->bounds[a] != lo || h->bounds[a + 3] != hi)
            return leaf_check_corrupt(
                path, offsetof(leaf_header, bounds),
                "expected the treelets' bounds along %c, %g .. %g, found %g .. %g", "xyz"[a],
                (double)lo, (double)hi, (double)h -> bounds[a], (double)h -> bounds[a + 3]);
    }
    return ST_OK;
}
