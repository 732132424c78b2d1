/* leaf_check_outside.c - whether the sections on samples in other files make sense. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>

#include "formats/base/sample.h"
#include "formats/grid/slice_folder.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/outside_chunks.h"
#include "formats/leaf/outside_samples.h"

/* Bytes of all samples outside; UINT64_MAX: more than any file has. */
static uint64_t bytes_outside(const leaf_header *h, const sample_place *p) {
    uint64_t bytes = stored_samples_bytes(&p->stored);
    for (int a = 0; a < 3; a++)
        if (__builtin_mul_overflow(bytes, (uint64_t)h->dims[a], &bytes))
            return UINT64_MAX;
    return bytes;
}

/* Check what section OUTSIDE says of chunks, whose numbers are in range. */
static status check_chunks(const char *path, const leaf_outside *o, uint64_t at) {
    const uint32_t unnamed = LEAF_CHUNKS_FORTRAN | LEAF_CHUNKS_SUMMED | LEAF_CHUNKS_CUT;
    const char *expected = outside_chunks_fault(o);
    if (expected)
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, chunk), "expected %s",
                                  expected);
    const bool in_files = o->form == LEAF_OUTSIDE_FILES;
    if (o->offset || (in_files && o->file_bytes > OUTSIDE_JSON_MAX))
        return leaf_check_corrupt(path, at, "chunks are described in a file of at most %d bytes",
                                  OUTSIDE_JSON_MAX);
    if (in_files && o->chunk_flags & LEAF_CHUNKS_CUT)
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, chunk_flags),
                                  "expected whole files of chunks");
    if (o->form == LEAF_OUTSIDE_SLICES && (o->file_bytes || o->modified_s || o->modified_ns))
        return leaf_check_corrupt(path, at, "expected nothing about one file");
    if (!in_files && (o->sum || o->levels_up || o->chunk_flags & ~unnamed))
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, chunk_flags),
                                  "expected nothing about files of chunks");
    return leaf_check_zero(path, &o->filter[o->filters],
                           (LEAF_CHUNK_FILTERS - o->filters) * sizeof *o->filter,
                           at + offsetof(leaf_outside, filter) + o->filters * sizeof *o->filter);
}

/* Check the ranges of the numbers that section OUTSIDE has of an axis and of a filter. */
static status check_axis_of_chunks(const char *path, const leaf_outside *o, size_t at, uint32_t i) {
    const leaf_filter *f = &o->filter[i];
    const size_t filter = at + offsetof(leaf_outside, filter) + i * sizeof *f;
    const bool used = i < o->filters, rows = f->kind == ZARR_FILTER_ROWS + 1;
    const leaf_field fields[] = {
        {at + offsetof(leaf_outside, chunk) + i * sizeof *o->chunk, "chunk", o->chunk[i], 0,
         INT32_MAX},
        {at + offsetof(leaf_outside, role) + i * sizeof *o->role, "role", o->role[i], 0,
         ORDER_AXES},
        {filter, "kind", f->kind, used, used ? ZARR_FILTER_KINDS : 0},
        {filter + offsetof(leaf_filter, type), "type", f->type, used, used ? SAMPLE_I64 : 0},
        {filter + offsetof(leaf_filter, coded_type), "coded_type", f->coded_type, used,
         used ? SAMPLE_I64 : 0},
        {filter + offsetof(leaf_filter, flags), "flags", f->flags, 0,
         LEAF_FILTER_BIG_ENDIAN | LEAF_FILTER_BIG_CODED},
        {filter + offsetof(leaf_filter, row), "row", f->row, rows, rows ? INT32_MAX : 0},
    };
    return leaf_check_fields(path, fields, sizeof fields / sizeof *fields);
}

/* Check the ranges of the numbers that section OUTSIDE has of chunks. */
static status check_chunk_fields(const char *path, const leaf_outside *o, uint64_t at) {
    const size_t base = (size_t)at, form = offsetof(leaf_outside, form);
    const leaf_field fields[] = {
        {base + form, "form", o->form, LEAF_OUTSIDE_PIECE, LEAF_OUTSIDE_FORM_LAST},
        {base + offsetof(leaf_outside, axes), "axes", o->axes, 3, LEAF_CHUNK_AXES},
        {base + offsetof(leaf_outside, chunk_flags), "chunk_flags", o->chunk_flags, 0,
         LEAF_CHUNKS_FORTRAN | LEAF_CHUNKS_SLASH | LEAF_CHUNKS_LINKS | LEAF_CHUNKS_SUMMED |
             LEAF_CHUNKS_CUT},
        {base + offsetof(leaf_outside, codec), "codec", o->codec, ZARR_RAW, ZARR_LZF},
        {base + offsetof(leaf_outside, filters), "filters", o->filters, 0, LEAF_CHUNK_FILTERS},
        {base + offsetof(leaf_outside, step), "step", o->step, 0, INT32_MAX},
        {base + offsetof(leaf_outside, reserved1), "reserved", o->reserved1, 0, 0},
    };
    if (o->form == LEAF_OUTSIDE_PIECE)
        return leaf_check_zero(path, (const char *)o + form, sizeof *o - form, at + form);
    status st = leaf_check_fields(path, fields, sizeof fields / sizeof *fields);
    for (uint32_t i = 0; i < LEAF_CHUNK_AXES && st == ST_OK; i++)
        st = check_axis_of_chunks(path, o, base, i);
    return st == ST_OK ? leaf_check_zero(path, o->reserved2, sizeof o->reserved2,
                                         at + offsetof(leaf_outside, reserved2))
                       : st;
}

/* Check what the numbers of section OUTSIDE say together. */
static status check_place(const char *path, const leaf_header *h, const leaf_outside *o,
                          uint64_t at) {
    const sample_place p = outside_samples_place(o);
    const uint64_t bytes = bytes_outside(h, &p);
    if (!isfinite(o->slope) || !isfinite(o->intercept))
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, slope),
                                  "expected a finite slope and intercept, found %g and %g",
                                  o->slope, o->intercept);
    if (!*o->path)
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, path), "expected a path");
    if (sample_place_type(&p) != (sample_type)h->sample_type)
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, type),
                                  "samples there become %s, and cannot be %s here",
                                  sample_name(sample_place_type(&p)),
                                  sample_name((sample_type)h->sample_type));
    if (o->form != LEAF_OUTSIDE_PIECE)
        return check_chunks(path, o, at);
    if (o->offset > o->file_bytes || bytes > o->file_bytes - o->offset)
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, offset),
                                  "the samples end behind the end of their file");
    return ST_OK;
}

status leaf_check_outside(const char *path, const leaf_header *h, const leaf_outside *o,
                          uint64_t at) {
    const size_t base = (size_t)at;
    const leaf_field fields[] = {
        {base + offsetof(leaf_outside, modified_ns), "modified_ns", o->modified_ns, 0, 999999999},
        {base + offsetof(leaf_outside, type), "type", o->type, SAMPLE_U8, SAMPLE_I64},
        {base + offsetof(leaf_outside, components), "components", o->components, 1,
         STORED_SAMPLES_COMPONENTS},
        {base + offsetof(leaf_outside, component), "component", o->component, 0, o->components},
        {base + offsetof(leaf_outside, flags), "flags", o->flags, 0,
         LEAF_OUTSIDE_BIG_ENDIAN | LEAF_OUTSIDE_COLOURS | LEAF_OUTSIDE_MISSING},
    };
    status st = leaf_check_fields(path, fields, sizeof fields / sizeof *fields);
    if (st == ST_OK)
        st = leaf_check_zero(path, &o->reserved0, sizeof o->reserved0,
                             at + offsetof(leaf_outside, reserved0));
    if (st == ST_OK)
        st = leaf_check_zero(path, o->reserved, sizeof o->reserved,
                             at + offsetof(leaf_outside, reserved));
    if (st == ST_OK)
        st = leaf_check_text(path, o->path, sizeof o->path, at + offsetof(leaf_outside, path));
    if (st == ST_OK)
        st = check_chunk_fields(path, o, at);
    if (st == ST_OK)
        st = check_place(path, h, o, at);
    const bool in_slices = o->form == LEAF_OUTSIDE_SLICES;
    if (st == ST_OK && in_slices != (h->outside == LEAF_IN_SLICES))
        return leaf_check_corrupt(path, at + offsetof(leaf_outside, form),
                                  "expected form %d, and no other, where each slice has a file",
                                  LEAF_OUTSIDE_SLICES);
    const uint64_t chunks = st == ST_OK && (in_slices || o->form == LEAF_OUTSIDE_TABLE)
                                ? outside_chunks_count(o, h->dims)
                                : 0;
    if (st == ST_OK && chunks != h->outside_chunks)
        return leaf_check_corrupt(path, offsetof(leaf_header, outside_chunks),
                                  "expected %llu chunks in a table, found %u",
                                  (unsigned long long)chunks, h->outside_chunks);
    return st;
}

status leaf_check_slices(const char *path, const leaf_header *h, const slice_file *slices,
                         uint64_t at) {
    for (uint32_t z = 0; z < h->dims[2]; z++) {
        const char *expected = slice_folder_fault(&slices[z]);
        if (expected)
            return leaf_check_corrupt(path, at + z * sizeof *slices, "expected %s", expected);
    }
    return ST_OK;
}

status leaf_check_chunks(const char *path, const leaf_header *h, const leaf_outside *o,
                         const chunk_entry *chunks, const slice_file *slices, uint64_t at) {
    const uint32_t a_slice = slices ? outside_chunks_in_slice(o, h->dims) : 0;
    for (uint32_t i = 0; i < h->outside_chunks; i++) {
        const chunk_entry *e = &chunks[i];
        const uint64_t bytes = slices ? slices[i / a_slice % h->dims[2]].bytes : o->file_bytes;
        const char *expected = outside_chunks_entry_fault(o, bytes, e);
        if (expected)
            return leaf_check_corrupt(path, at + i * sizeof *e,
                                      "expected %s, found %u at byte %llu", expected, e->bytes,
                                      (unsigned long long)e->offset);
    }
    return ST_OK;
}
