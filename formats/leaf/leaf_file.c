#include "formats/leaf/leaf_file.h"

#include <assert.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include <zstd.h>

#include "formats/base/hash.h"
#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_order.h"
#include "formats/leaf/leaf_place.h"
#include "formats/leaf/live_samples.h"
#include "formats/leaf/outside_samples.h"

_Static_assert(
    __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
    "treelet files are little endian and read as they are; swap here for other machines");

/* State needed only while opening. */
typedef struct opening {
    leaf_file *f;
    const leaf_header *first; /* instead of the file's own; or NULL */
    leaf_section table[LEAF_SECTIONS_MAX];
    uint64_t end;                   /* where the sections end */
    uint64_t at[LEAF_SECTION_LAST]; /* file offset of known section k: at[k - 1] */
} opening;

static status check_gap(leaf_file *f, uint64_t from, uint64_t to) {
    unsigned char bytes[512];
    while (from < to) {
        size_t size = to - from < sizeof bytes ? (size_t)(to - from) : sizeof bytes;
        status st = file_read_at(f->source, from, bytes, size);
        if (st != ST_OK)
            return st;
        for (size_t i = 0; i < size; i++)
            if (bytes[i])
                return status_describe(
                    ST_CORRUPT, "%s: byte %llu: expected 0 between sections, found %u",
                    file_path(f->source), (unsigned long long)(from + i), bytes[i]);
        from += size;
    }
    return ST_OK;
}

/* Read the first header. That of a file that grows may be written meanwhile: then it is read again.
 * *sound: whether it is whole at last, as far as such a file's. */
static status read_first(file *source, leaf_header *h, bool *sound) {
    enum { TRIES = 10 };
    status st = ST_OK;
    *sound = false;
    for (int i = 0; i < TRIES && st == ST_OK && !*sound; i++) {
        st = file_read_at(source, 0, h, sizeof *h);
        *sound = !h->segments || h->checksum == leaf_header_checksum(h);
    }
    return st;
}

static status read_header(const opening *o) {
    bool sound;
    const status st = read_first(o->f->source, &o->f->header, &sound);
    if (o->first)
        o->f->header = *o->first;
    return st;
}

static status read_head(opening *o) {
    leaf_file *f = o->f;
    const char *path = file_path(f->source);
    const leaf_header *h = &f->header;
    uint64_t bytes = file_size(f->source);
    status st = read_header(o);
    /* Behind the first segment may be others, and what is being written. */
    if (st == ST_OK && h->segments && h->file_bytes < bytes)
        bytes = h->file_bytes;
    if (st == ST_OK)
        st = leaf_check_header(path, h, bytes);
    if (st == ST_OK)
        f->geometry = leaf_geometry_of(f->header.kind);
    if (st == ST_OK)
        st = leaf_check_layout(path, &f->header, &f->layout);
    if (st == ST_OK)
        st = file_read_at(f->source, leaf_table_at(&f->header), o->table,
                          f->header.sections * sizeof *o->table);
    if (st == ST_OK)
        st = leaf_check_sections(path, &f->header, o->table, &o->end);
    return st;
}

static status check_sum(const leaf_file *f, const leaf_section *s, uint64_t sum) {
    if (sum == s->checksum)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: byte %llu: section %u has the checksum %016llx, expected %016llx",
                           file_path(f->source), (unsigned long long)s->offset, s->kind,
                           (unsigned long long)sum, (unsigned long long)s->checksum);
}

static status read_plain(leaf_file *f, const leaf_section *s, void *into) {
    status st = file_read_at(f->source, s->offset, into, (size_t)s->bytes);
    return st == ST_OK ? check_sum(f, s, hash_bytes(into, (size_t)s->bytes)) : st;
}

static status read_section(leaf_file *f, const leaf_section *s, void *into) {
    if (s->version == LEAF_SECTION_PLAIN)
        return read_plain(f, s, into);
    const size_t bytes = (size_t)leaf_section_bytes(&f->header, s->kind);
    void *frame = mem_alloc(f->m, (size_t)s->bytes);
    status st = frame ? read_plain(f, s, frame) : ST_NOMEM;
    if (st == ST_OK && ZSTD_decompress(into, bytes, frame, (size_t)s->bytes) != bytes)
        st = leaf_check_corrupt(file_path(f->source), s->offset,
                                "section %u does not decompress to %zu bytes", s->kind, bytes);
    mem_free(f->m, frame);
    return st;
}

/* Read the coordinates of all axes from one section into one block, which axis[0] owns. */
static status read_axes(leaf_file *f, const leaf_section *s) {
    const uint32_t *dims = f->header.dims;
    size_t count = (size_t)dims[0] + dims[1] + dims[2];
    f->axis[0] = mem_array(f->m, count, sizeof *f->axis[0]);
    if (!f->axis[0])
        return ST_NOMEM;
    f->axis[1] = f->axis[0] + dims[0];
    f->axis[2] = f->axis[1] + dims[1];
    if (!s) {
        for (int a = 0; a < 3; a++)
            for (uint32_t i = 0; i < dims[a]; i++)
                f->axis[a][i] = i;
        return ST_OK;
    }
    status st = read_section(f, s, f->axis[0]);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = leaf_check_axis(file_path(f->source), f->axis[a], dims[a],
                             s->offset + (uint64_t)(f->axis[a] - f->axis[0]) * sizeof(double));
    char why[LEAF_PLACE_TEXT];
    for (int a = 0; a < 3 && st == ST_OK; a++)
        if (!leaf_place_axis(f->header.to_world, a, f->axis[a], dims[a], why))
            st = leaf_check_corrupt(file_path(f->source), s->offset, "%s", why);
    return st;
}

/* Check a section of a later kind, which may be skipped. If it is damaged, the file is refused all
 * the same. */
static status check_ancillary(leaf_file *f, const leaf_section *s) {
    void *bytes = mem_alloc(f->m, (size_t)s->bytes);
    if (!bytes)
        return ST_NOMEM;
    status st = read_plain(f, s, bytes);
    mem_free(f->m, bytes);
    return st;
}

/* Read histograms, and check that each is sound in itself; leaf_verify() counts again. */
static status read_histograms(leaf_file *f, const leaf_section *s) {
    const size_t count = (size_t)leaf_section_bytes(&f->header, s->kind) / sizeof *f->histograms;
    f->histograms = mem_array(f->m, count, sizeof *f->histograms);
    if (!f->histograms)
        return ST_NOMEM;
    status st = read_section(f, s, f->histograms);
    for (size_t i = 0; st == ST_OK && i < count; i++) {
        const char *fault = histogram_fault(&f->histograms[i]);
        if (fault)
            st = status_describe(
                ST_CORRUPT, "%s: byte %llu: histogram %zu has %s", file_path(f->source),
                (unsigned long long)(s->offset + i * sizeof *f->histograms), i, fault);
    }
    return st;
}

/* Read deviations; leaf_verify() compares the levels again. */
static status read_deviations(leaf_file *f, const leaf_section *s) {
    f->deviations = mem_alloc(f->m, (size_t)leaf_section_bytes(&f->header, s->kind));
    return f->deviations ? read_section(f, s, f->deviations) : ST_NOMEM;
}

static status read_world(leaf_file *f, const leaf_section *s) {
    status st = read_section(f, s, &f->frame);
    if (st == ST_OK)
        st = leaf_check_world(file_path(f->source), &f->header, &f->frame, s->offset);
    for (int a = 0; st == ST_OK && a < 3; a++)
        text_name(f->frame.unit[a], sizeof f->frame.unit[a], f->frame.unit[a]);
    text_name(f->frame.time_unit, sizeof f->frame.time_unit, f->frame.time_unit);
    return st;
}

/* Allocate names and times, with defaults for a file that has none. */
static status allocate_labels(leaf_file *f) {
    f->names = mem_array(f->m, f->header.fields, sizeof *f->names);
    f->times = mem_array(f->m, f->header.steps, sizeof *f->times);
    if (!f->names || !f->times)
        return ST_NOMEM;
    memcpy(f->names[0], f->header.field, sizeof *f->names);
    for (uint32_t s = 0; s < f->header.steps; s++)
        f->times[s] = s;
    return ST_OK;
}

/* ranges: elements of RANGES, OWN and FLAGS. */
static status allocate_arrays(leaf_file *f, size_t ranges) {
    const size_t payloads = f->layout.payloads;
    f->ranges = mem_array(f->m, ranges, sizeof *f->ranges);
    f->own = mem_array(f->m, ranges, sizeof *f->own);
    f->flags = mem_array(f->m, ranges, sizeof *f->flags);
    f->offsets = mem_array(f->m, payloads, sizeof *f->offsets);
    f->sizes = mem_array(f->m, payloads, sizeof *f->sizes);
    f->checksums = mem_array(f->m, payloads, sizeof *f->checksums);
    const bool whole = f->ranges && f->own && f->flags && f->offsets && f->sizes && f->checksums;
    return whole ? ST_OK : ST_NOMEM;
}

static status allocate_directory(leaf_file *f) {
    status st = allocate_arrays(f, (size_t)f->layout.treelets * f->geometry->sets(&f->header));
    if (st == ST_OK)
        st = allocate_labels(f);
    return st == ST_OK ? f->geometry->allocate(f) : st;
}

status leaf_file_allocate_changing(leaf_file *f) {
    f->names = mem_array(f->m, f->header.fields, sizeof *f->names);
    f->times = mem_array(f->m, f->layout.sets, sizeof *f->times);
    f->versions = mem_array(f->m, f->layout.sets, sizeof *f->versions);
    const bool whole = f->names && f->times && f->versions;
    return whole ? allocate_arrays(f, (size_t)f->layout.treelets * f->layout.sets) : ST_NOMEM;
}

/* Allocate and read section SAME or BASES. */
static status read_links(leaf_file *f, const leaf_section *s, const uint32_t **out) {
    uint32_t *links = mem_array(f->m, f->layout.payloads, sizeof *links);
    *out = links;
    return links ? read_section(f, s, links) : ST_NOMEM;
}

/* The kind decides that the section may be there, and its size. */
static status read_coarse(leaf_file *f, const leaf_section *s) {
    f->coarse = mem_array(f->m, f->layout.sets, sizeof *f->coarse);
    return f->coarse ? read_section(f, s, f->coarse) : ST_NOMEM;
}

static status read_sections(opening *o) {
    leaf_file *f = o->f;
    void *arrays[LEAF_SECTION_LAST + 1] = {
        [LEAF_SECTION_RANGES] = f->ranges, [LEAF_SECTION_OWN] = f->own,
        [LEAF_SECTION_FLAGS] = f->flags,   [LEAF_SECTION_OFFSETS] = f->offsets,
        [LEAF_SECTION_SIZES] = f->sizes,   [LEAF_SECTION_CHECKSUMS] = f->checksums,
        [LEAF_SECTION_FIELDS] = f->names,  [LEAF_SECTION_TIMES] = f->times,
    };
    for (uint32_t kind = LEAF_SECTION_AXES; kind <= LEAF_SECTION_LAST; kind++)
        if (!arrays[kind])
            arrays[kind] = f->geometry->section(f, kind);
    uint64_t end = leaf_table_at(&f->header) + f->header.sections * sizeof *o->table;
    const leaf_section *axes = NULL;
    for (uint32_t i = 0; i < f->header.sections; i++) {
        const leaf_section *s = &o->table[i];
        status st = check_gap(f, end, s->offset);
        if (st != ST_OK)
            return st;
        end = s->offset + s->bytes;
        if (s->kind <= LEAF_SECTION_LAST)
            o->at[s->kind - 1] = s->offset;
        if (s->version > LEAF_SECTION_ZSTD ||
            (s->kind > LEAF_SECTION_LAST && !leaf_section_ancillary(s->kind)))
            st = check_ancillary(f, s);
        else if (s->kind == LEAF_SECTION_HISTOGRAMS)
            st = read_histograms(f, s);
        else if (s->kind == LEAF_SECTION_DEVIATIONS)
            st = read_deviations(f, s);
        else if (s->kind == LEAF_SECTION_WORLD)
            st = read_world(f, s);
        else if (s->kind == LEAF_SECTION_SAME)
            st = read_links(f, s, &f->links.same);
        else if (s->kind == LEAF_SECTION_BASES)
            st = read_links(f, s, &f->links.bases);
        else if (s->kind == LEAF_SECTION_COARSE)
            st = read_coarse(f, s);
        else if (s->kind == LEAF_SECTION_AXES)
            axes = s;
        else
            st = read_section(f, s, arrays[s->kind]);
        if (st != ST_OK)
            return st;
    }
    return read_axes(f, axes);
}

static status check_names(const char *path, const leaf_header *h, const char (*names)[64],
                          uint64_t at) {
    for (uint32_t i = 0; i < h->fields; i++) {
        status st = leaf_check_text(path, names[i], sizeof names[i], at + i * sizeof names[i]);
        if (st != ST_OK)
            return st;
    }
    if (memcmp(names[0], h->field, sizeof h->field) == 0)
        return ST_OK;
    return leaf_check_corrupt(path, at, "expected the header's first field \"%s\", found \"%s\"",
                              h->field, names[0]);
}

/* Check names and times, where the file has them. */
static status check_labels(leaf_file *f, const leaf_directory *d) {
    const char *path = file_path(f->source);
    const uint64_t names = d->at[LEAF_SECTION_FIELDS - 1], times = d->at[LEAF_SECTION_TIMES - 1];
    f->has_times = times > 0;
    status st = ST_OK;
    if (names)
        st = check_names(path, &f->header, (const char(*)[64])f->names, names);
    for (uint32_t i = 0; i < f->header.fields; i++)
        text_name(f->names[i], sizeof *f->names, f->names[i]);
    return st == ST_OK && times ? leaf_check_axis(path, f->times, f->header.steps, times) : st;
}

/* Check that codes are valid, and 0 for bricks without cells. */
static status check_deviations(const opening *o) {
    const leaf_file *f = o->f;
    size_t brick;
    if (deviation_sound(&f->layout, f->deviations, &brick))
        return ST_OK;
    for (uint32_t i = 0; i < f->header.sections; i++)
        if (o->table[i].kind == LEAF_SECTION_DEVIATIONS)
            return leaf_check_corrupt(
                file_path(f->source), o->table[i].offset + brick * sizeof *f->deviations,
                "expected the deviation of %s, found %04x",
                f->deviations[brick] > DEVIATION_UNKNOWN ? "a brick" : "a brick without cells",
                f->deviations[brick]);
    return ST_OK;
}

static status check_directory(const opening *o) {
    leaf_file *f = o->f;
    const char *path = file_path(f->source);
    leaf_directory d = {
        .ranges = (const float(*)[2])f->ranges,
        .own = (const float(*)[2])f->own,
        .flags = f->flags,
        .offsets = f->offsets,
        .sizes = f->sizes,
        .checksums = f->checksums,
        .links = f->links,
        .end = o->end,
    };
    memcpy(d.at, o->at, sizeof d.at);
    d.parts = f->coarse;
    status st = check_labels(f, &d);
    if (st == ST_OK)
        st = f->geometry->lay_out(f, &d);
    if (st == ST_OK)
        st = leaf_check_directory(path, &f->header, &f->layout, &d);
    return st == ST_OK && f->deviations ? check_deviations(o) : st;
}

/* Make names safe to print and to put into JSON, whoever wrote the file. */
static void clean_names(leaf_file *f, const char *path) {
    leaf_header *h = &f->header;
    text_name(h->name, sizeof h->name, h->name);
    memcpy(f->name, h->name, sizeof f->name);
    if (!*f->name)
        text_file_name(f->name, sizeof f->name, path);
    text_name(h->field, sizeof h->field, h->field);
    text_name(h->provenance, sizeof h->provenance, h->provenance);
}

static status read_directory(opening *o) {
    leaf_file *f = o->f;
    status st = file_mark_take(f->source, &f->mark);
    if (st == ST_OK)
        st = read_head(o);
    if (st == ST_OK)
        st = allocate_directory(f);
    if (st == ST_OK)
        st = read_sections(o);
    if (st == ST_OK)
        st = check_directory(o);
    return st == ST_OK ? check_gap(f, leaf_payloads_at(&f->header, o->end),
                                   f->offsets[leaf_order_begin(&f->layout).p])
                       : st;
}

/* Open the file that has the samples of level 0. path: of the treelet file. */
static status open_outside(const opening *o, const char *path) {
    leaf_file *f = o->f;
    const uint64_t at = o->at[LEAF_SECTION_OUTSIDE - 1];
    status st = leaf_check_outside(file_path(f->source), &f->header, f->outside, at);
    if (st == ST_OK && f->slices)
        st = leaf_check_slices(file_path(f->source), &f->header, f->slices,
                               o->at[LEAF_SECTION_SLICES - 1]);
    if (st == ST_OK && f->chunks)
        st = leaf_check_chunks(file_path(f->source), &f->header, f->outside, f->chunks, f->slices,
                               o->at[LEAF_SECTION_CHUNKS - 1]);
    if (st == ST_OK && file_descriptor(f->source) < 0)
        st = status_describe(ST_UNSUPPORTED,
                             "%s: its samples lie in another file: it cannot be opened from memory",
                             path);
    const outside_tables tables = {f->chunks, f->slices};
    return st == ST_OK
               ? outside_samples_open(f->m, path, f->outside, &tables, f->header.dims, &f->samples)
               : st;
}

/* Open a file without segments, or one of them; consumes source. path: gives the name to show, if
 * the header has none, and the folder from which another file is named. */
static status open_alone(mem *m, file *source, const leaf_header *first, const char *path,
                         leaf_file **out) {
    leaf_file *f = mem_zalloc(m, sizeof *f);
    if (!f) {
        file_close(source);
        return ST_NOMEM;
    }
    f->m = m;
    f->source = source;
    opening o = {.f = f, .first = first};
    status st = read_directory(&o);
    if (st == ST_OK && f->outside)
        st = open_outside(&o, path);
    if (st != ST_OK) {
        leaf_file_close(f);
        return st;
    }
    clean_names(f, path);
    memcpy(f->first_id, f->header.id, sizeof f->first_id);
    const uint32_t last = leaf_order_last(&f->layout);
    const uint64_t before = f->offsets[last] + f->sizes[last];
    f->directory_end = o.end;
    f->directory_bytes = o.end - leaf_table_at(&f->header) + LEAF_HEADER_BYTES;
    f->payloads_end =
        leaf_layout_aligned(f->header.directory ? o.end : before, f->header.run_align_log2);
    *out = f;
    return ST_OK;
}

/* The same of a whole file. */
static status open_source(mem *m, file *source, const leaf_header *first, const char *path,
                          leaf_file **out) {
    leaf_file *f = NULL;
    status st = open_alone(m, source, first, path, &f);
    if (st == ST_OK && f->header.steps_before)
        st = leaf_check_corrupt(file_path(f->source), offsetof(leaf_header, steps_before),
                                "expected a whole file, found a segment of one");
    if (st == ST_OK && f->header.segments)
        st = leaf_file_join(f);
    if (st != ST_OK) {
        leaf_file_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

status leaf_file_open_part(mem *m, const leaf_file *f, uint64_t offset, uint64_t bytes,
                           leaf_file **out) {
    file *source = NULL;
    const status st = file_open_part(m, f->source, offset, bytes, &source);
    return st == ST_OK ? open_alone(m, source, NULL, file_path(f->source), out) : st;
}

status leaf_file_open_segment(mem *m, const leaf_file *f, const leaf_segment *s, leaf_file **out) {
    leaf_header head;
    const status st = file_read_at(f->source, s->base, &head, sizeof head);
    return st == ST_OK ? leaf_file_open_part(m, f, s->base, head.file_bytes, out) : st;
}

status leaf_file_open_as(mem *m, const char *path, const char *as, leaf_file **out) {
    file *source = NULL;
    status st = file_open(m, path, &source);
    return st == ST_OK ? open_source(m, source, NULL, as, out) : st;
}

status leaf_file_open_first(mem *m, const char *path, const leaf_header *first, leaf_file **out) {
    file *source = NULL;
    status st = file_open(m, path, &source);
    return st == ST_OK ? open_source(m, source, first, path, out) : st;
}

status leaf_file_open(mem *m, const char *path, leaf_file **out) {
    return leaf_file_open_as(m, path, path, out);
}

status leaf_file_open_memory(mem *m, const char *name, const void *bytes, size_t size,
                             leaf_file **out) {
    file *source = NULL;
    status st = file_open_memory(m, name, bytes, size, &source);
    return st == ST_OK ? open_source(m, source, NULL, name, out) : st;
}

/* Whether a file that was written to still begins with what was opened, and may have grown. */
static bool has_grown(const leaf_file *f, const leaf_header *head) {
    const bool more = head->segments > f->header.segments;
    return head->segments &&
           (more || (head->segments == f->header.segments && head->last == f->header.last)) &&
           memcmp(head->id, f->first_id, sizeof head->id) == 0;
}

/* Whether all segments that are known are still there. */
static bool is_whole(const leaf_file *f) {
    struct stat now;
    return fstat(file_descriptor(f->source), &now) == 0 && now.st_size >= 0 &&
           (uint64_t)now.st_size >= f->header.file_bytes;
}

/* Find that a file which was written to has grown, or say again what has changed. */
static status check_growth(const leaf_file *f, status st) {
    leaf_header head;
    status_note note;
    bool sound;
    status_note_take(&note, st);
    if (file_offset(f->source) != 0)
        return st;
    st = read_first(f->source, &head, &sound);
    if (st == ST_IO)
        return st;
    return st == ST_OK && sound && has_grown(f, &head) && is_whole(f)
               ? file_mark_check_name(f->source, &f->mark)
               : status_note_raise(&note);
}

status leaf_file_changed(const leaf_file *f) {
    if (f->below)
        return leaf_file_changed(f->below);
    status st = file_mark_check(f->source, &f->mark);
    if (st == ST_CORRUPT)
        st = check_growth(f, st);
    return st == ST_OK && f->samples ? outside_samples_changed(f->samples) : st;
}

void leaf_file_close(leaf_file *f) {
    if (!f)
        return;
    leaf_layout_release(&f->layout);
    mem_free(f->m, f->ranges);
    mem_free(f->m, f->own);
    mem_free(f->m, f->flags);
    mem_free(f->m, f->offsets);
    mem_free(f->m, f->sizes);
    mem_free(f->m, f->checksums);
    mem_free(f->m, (void *)(uintptr_t)f->links.same);
    mem_free(f->m, (void *)(uintptr_t)f->links.bases);
    mem_free(f->m, f->segments);
    mem_free(f->m, f->histograms);
    mem_free(f->m, f->deviations);
    mem_free(f->m, f->coarse);
    mem_free(f->m, f->axis[0]);
    mem_free(f->m, f->names);
    mem_free(f->m, f->times);
    mem_free(f->m, f->versions);
    mem_free(f->m, f->step_bounds);
    mem_free(f->m, f->between);
    outside_samples_close(f->samples);
    live_samples_destroy(f->live);
    if (f->geometry)
        f->geometry->release(f);
    file_close(f->source);
    if (f->owns_below)
        leaf_file_close(f->below);
    mem_free(f->m, f);
}

bool leaf_file_is_raw(const leaf_file *f, uint32_t p) {
    return !f->layout.coded && f->sizes[p] == leaf_layout_payload_bytes(&f->layout, p);
}

status leaf_file_check(const leaf_file *f, uint32_t p, const void *stored) {
    uint64_t sum = hash_bytes(stored, (size_t)f->sizes[p]);
    char name[LEAF_NAME_MAX];
    if (sum == f->checksums[p])
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: byte %llu: %s of %llu bytes has the checksum %016llx, expected "
                           "%016llx",
                           file_path(f->source), (unsigned long long)f->offsets[p],
                           leaf_layout_payload_name(&f->layout, p, name),
                           (unsigned long long)f->sizes[p], (unsigned long long)sum,
                           (unsigned long long)f->checksums[p]);
}

bool leaf_file_has_bytes(const leaf_file *f, uint32_t p) {
    return f->sizes[p] > 0;
}

bool leaf_file_is_outside(const leaf_file *f, uint32_t p) {
    return leaf_layout_is_outside(&f->layout, p) && f->checksums[p];
}

bool leaf_file_is_bare(const leaf_file *f, uint32_t p) {
    const leaf_layout *l = &f->layout;
    return f->header.bare && p < l->sets * l->treelets && leaf_layout_is_bare(l, p % l->treelets);
}

bool leaf_file_is_implied(const leaf_file *f, uint32_t p) {
    return !leaf_file_has_bytes(f, p) && !leaf_file_is_outside(f, p) && !leaf_file_is_bare(f, p);
}

uint32_t leaf_file_home(const leaf_file *f, uint32_t p) {
    return leaf_layout_home(&f->layout, &f->links, p);
}

/* Whether the siblings of treelet t share the same in two sets. */
static bool same_shell(const leaf_file *f, uint32_t t, uint32_t a, uint32_t b) {
    const leaf_layout *l = &f->layout;
    if (!l->shells || t == 0)
        return true;
    const uint32_t parent = leaf_layout_parent(l, t);
    return leaf_file_home(f, leaf_layout_shell(l, a, parent)) ==
           leaf_file_home(f, leaf_layout_shell(l, b, parent));
}

bool leaf_file_same(const leaf_file *f, uint32_t p, uint32_t q) {
    const uint32_t n = f->layout.treelets;
    return p == q || (leaf_file_has_bytes(f, p) && leaf_file_home(f, p) == leaf_file_home(f, q) &&
                      same_shell(f, p % n, p / n, q / n));
}

int leaf_file_chain(const leaf_file *f, uint32_t p, uint32_t chain[LEAF_CHAIN_MAX]) {
    return leaf_layout_chain(&f->layout, &f->links, p, chain);
}

uint64_t leaf_file_stored(const leaf_file *f, uint32_t p) {
    uint32_t chain[LEAF_CHAIN_MAX];
    uint64_t bytes = 0;
    for (int i = leaf_file_chain(f, p, chain); i-- > 0;)
        bytes += f->sizes[chain[i]];
    return bytes;
}

status leaf_file_check_level(const leaf_file *f, uint32_t level) {
    if (level < f->layout.sampled)
        return ST_OK;
    if (!f->header.bare)
        return status_describe(ST_USAGE, "level of detail %u: there are 0 to %u", level,
                               f->layout.levels - 1);
    return status_describe(ST_USAGE,
                           "level of detail %u: %s has samples of level 0 alone, as `leafcast "
                           "convert --levels 1' made it",
                           level, file_path(f->source));
}

status leaf_file_fetch(leaf_file *f, uint32_t p, void *stored) {
    status st = file_read_at(f->source, f->offsets[p], stored, (size_t)f->sizes[p]);
    return st == ST_OK ? leaf_file_check(f, p, stored) : st;
}

bool leaf_file_holds_indices(const leaf_file *f) {
    return f->geometry->holds_indices;
}

const char *leaf_file_field_name(const leaf_file *f, uint32_t field) {
    return field < f->header.fields ? f->names[field] : "";
}

double leaf_file_step_time(const leaf_file *f, uint32_t step) {
    return step < f->header.steps ? f->times[step] : (double)step;
}

status leaf_file_find_field(const leaf_file *f, const char *name, uint32_t *field) {
    const uint32_t fields = f->header.fields;
    int64_t number = 0;
    for (*field = 0; *field < fields; ++*field)
        if (strcmp(leaf_file_field_name(f, *field), name) == 0)
            return ST_OK;
    if (num_int(name, "field", 0, (int64_t)fields - 1, &number) == ST_OK) {
        *field = (uint32_t)number;
        return ST_OK;
    }
    char list[512] = "";
    for (uint32_t i = 0; i < fields && strlen(list) + 80 < sizeof list; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "",
                 leaf_file_field_name(f, i));
    return status_describe(ST_USAGE,
                           "no field is called \"%s\", nor has that number; there are %u: %s", name,
                           fields, list);
}
