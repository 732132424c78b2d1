#include "formats/grid/chunk_array.h"

#include <endian.h>
#include <stdio.h>
#include <string.h>

#include "formats/grid/slice_folder.h"
#include "formats/input/named_file.h"

enum { CHUNK_LOG2_MAX = 48 }; /* of the numbers of a chunk: more than any memory holds */

bool chunk_array_measure(const chunk_array *a, chunk_shape *out) {
    const zarr_number number = {a->type, a->big_endian};
    uint64_t stride = 1;
    size_t most;
    *out = (chunk_shape){.width = sample_size(a->type)};
    for (int r = 0; r < ORDER_AXES; r++)
        out->along[r] = 1;
    for (int i = 0; i < a->axes; i++) {
        const int axis = a->fortran ? i : a->axes - 1 - i, role = a->role[axis];
        if (role >= 0) {
            out->along[role] = a->chunk[axis];
            out->stride[role] = stride;
        }
        if (__builtin_mul_overflow(stride, (uint64_t)a->chunk[axis], &stride) ||
            stride >> CHUNK_LOG2_MAX)
            return false;
    }
    out->bytes = stride * out->width;
    out->coded = stride * zarr_filters_width(&a->filters, number, &most);
    out->room = stride * most;
    return true;
}

bool chunk_array_cuts(const chunk_array *a, const chunk_shape *s) {
    const size_t slice = s->stride[ORDER_Y] * s->along[ORDER_Y];
    for (int i = 0; i < a->filters.count; i++)
        if (a->filters.of[i].row && s->stride[ORDER_Y] % a->filters.of[i].row)
            return false;
    return slice == s->bytes / s->width && (a->codec == ZARR_RAW || a->codec == ZARR_STREAM);
}

/* ---- one chunk ---- */

/* The rows of a chunk that must be there. */
static uint32_t rows_of(const chunk_array *a, const chunk_shape *s, uint32_t index) {
    const uint64_t first = (uint64_t)index * s->along[ORDER_Y];
    const bool cut = a->rows > first && a->rows - first < s->along[ORDER_Y];
    return cut ? (uint32_t)(a->rows - first) : s->along[ORDER_Y];
}

const char *chunk_array_path(const chunk_array *a, const char *folder,
                             const uint32_t index[ORDER_AXES],
                             char path[CHUNK_FOLDER + CHUNK_NAME]) {
    const size_t room = CHUNK_FOLDER + CHUNK_NAME;
    int length = snprintf(path, room, "%s", folder);
    for (int i = 0; i < a->axes; i++)
        length += snprintf(path + length, room - (size_t)length, "%c%u", i ? a->separator : '/',
                           a->role[i] < 0 ? 0 : index[a->role[i]]);
    return path;
}

/* Check that a chunk's file may be read. */
static status check_file(const chunk_home *in, const char *name) {
    const status st = named_file_check(in->trusted, name, in->follow_links);
    if (st == ST_OK || !in->is_index || named_file_implied(name) != ST_OK)
        return st;
    return status_describe(st,
                           "%s: lies outside of its folder, which was not allowed when this index "
                           "was made of it: convert it again with --follow-links",
                           name);
}

/* Read a chunk that is a file of its own. name: out, the path, for messages. */
static status read_file(mem *m, const chunk_array *a, const chunk_home *in,
                        const uint32_t index[ORDER_AXES], void *to, size_t size, char *name,
                        bool *there, uint64_t *read) {
    (void)chunk_array_path(a, in->path, index, name);
    const status st = check_file(in, name);
    return st == ST_OK ? zarr_chunk_read(m, a->codec, name, to, size, there, read) : st;
}

/* Find a chunk in the table. */
static const chunk_entry *find_entry(const chunk_home *in, const uint32_t index[ORDER_AXES]) {
    size_t at = 0;
    for (int r = ORDER_AXES - 1; r >= 0; r--)
        at = at * in->range.count[r] + index[r] - in->range.first[r];
    return &in->table[at];
}

/* Take from the array what was not applied to this chunk. */
static void skip(const chunk_entry *e, chunk_array *a) {
    zarr_filters *f = &a->filters;
    const int count = f->count;
    unsigned bit = 0;
    for (f->count = 0; bit < (unsigned)count; bit++)
        if (!(e->skipped >> bit & 1))
            f->of[f->count++] = f->of[bit];
    if (a->codec != ZARR_RAW && e->skipped >> bit++ & 1)
        a->codec = ZARR_RAW;
    a->summed &= !(e->skipped >> bit & 1);
}

/* Read a chunk that is bytes of a file. */
static status read_part(mem *m, const chunk_array *a, file *in, const chunk_entry *e, void *to,
                        size_t size, char *name) {
    const uint32_t sum = a->summed ? 4 : 0;
    snprintf(name, CHUNK_FOLDER + CHUNK_NAME, "%s: the chunk at byte %llu", file_path(in),
             (unsigned long long)e->offset);
    if (e->bytes < sum)
        return status_describe(ST_CORRUPT, "%s: %u bytes", name, e->bytes);
    const zarr_part part = {in, e->offset, e->bytes - sum, name};
    return zarr_chunk_read_part(m, a->codec, &part, to, size, a->rows > 0);
}

/* Read a chunk that the table has, of slice z. */
static status read_entry(mem *m, const chunk_array *a, const chunk_home *in, const chunk_entry *e,
                         uint32_t z, void *to, size_t size, char *name, bool *there,
                         uint64_t *read) {
    file *own = NULL;
    *there = e->bytes > 0;
    *read += e->bytes;
    status st = *there && in->files ? slice_folder_open(m, in->files, z, &own) : ST_OK;
    if (st == ST_OK && *there)
        st = read_part(m, a, own ? own : in->in, e, to, size, name);
    file_close(own);
    return st;
}

/* Undo filters, from `coded` into `chunk`. Where all were skipped, `coded` is the chunk. */
static status undo(const chunk_array *a, const char *name, size_t numbers, size_t bytes,
                   void *coded, void *chunk) {
    if (a->filters.count)
        return zarr_filters_undo(&a->filters, name, numbers, coded, chunk);
    memcpy(chunk, coded, bytes);
    return ST_OK;
}

status chunk_array_read(mem *m, const chunk_array *a, const chunk_shape *s, const chunk_home *in,
                        const uint32_t index[ORDER_AXES], void *chunk, void *coded, bool *there,
                        uint64_t *read) {
    char name[CHUNK_FOLDER + CHUNK_NAME];
    const uint32_t rows = rows_of(a, s, index[ORDER_Y]);
    const size_t numbers = s->bytes / s->width / s->along[ORDER_Y] * rows;
    const size_t packed = s->coded / s->along[ORDER_Y] * rows;
    void *to = coded ? coded : chunk;
    chunk_array own = *a;
    const chunk_entry *e = in->table ? find_entry(in, index) : NULL;
    if (e)
        skip(e, &own);
    *there = false;
    status st = e ? read_entry(m, &own, in, e, index[ORDER_Z], to, packed, name, there, read)
                  : read_file(m, a, in, index, to, packed, name, there, read);
    if (st == ST_OK && *there && coded)
        st = undo(&own, name, numbers, numbers * s->width, coded, chunk);
    if (st == ST_OK && *there && a->big_endian != (__BYTE_ORDER == __BIG_ENDIAN))
        sample_swap(a->type, chunk, numbers);
    return st;
}

/* ---- boxes ---- */

uint64_t chunk_array_range(const chunk_shape *s, const uint32_t first[ORDER_AXES],
                           const uint32_t end[ORDER_AXES], chunk_range *out) {
    uint64_t count = 1;
    for (int r = 0; r < ORDER_AXES; r++) {
        out->first[r] = first[r] / s->along[r];
        out->count[r] = (end[r] - 1) / s->along[r] - out->first[r] + 1;
        if (__builtin_mul_overflow(count, (uint64_t)out->count[r], &count))
            count = UINT64_MAX;
    }
    return count;
}

/* Put a row of numbers where they belong, `apart` bytes from one to the next. numbers: the first of
 * them; NULL: they are the fill value. */
static void put_row(const chunk_array *a, const chunk_shape *s, const uint8_t *numbers, uint8_t *to,
                    size_t apart, uint32_t count) {
    const size_t step = numbers ? s->stride[ORDER_X] * s->width : 0;
    if (numbers && step == s->width && apart == s->width) {
        memcpy(to, numbers, count * s->width);
        return;
    }
    if (!numbers)
        numbers = a->fill;
    for (uint32_t i = 0; i < count; i++)
        memcpy(to + i * apart, numbers + i * step, s->width);
}

/* Part of a box that lies in one chunk: first .. end - 1 along each role. */
typedef struct chunk_part {
    uint32_t first[ORDER_AXES], end[ORDER_AXES];
    size_t at; /* its first number in the chunk */
} chunk_part;

static chunk_part part_of(const chunk_shape *s, const uint32_t first[ORDER_AXES],
                          const uint32_t end[ORDER_AXES], const uint32_t index[ORDER_AXES]) {
    chunk_part p = {.at = 0};
    for (int r = 0; r < ORDER_AXES; r++) {
        const uint64_t from = (uint64_t)index[r] * s->along[r], to = from + s->along[r];
        p.first[r] = from > first[r] ? (uint32_t)from : first[r];
        p.end[r] = to < end[r] ? (uint32_t)to : end[r];
        p.at += (p.first[r] - from) * s->stride[r];
    }
    return p;
}

/* Copy what a box has of a chunk. */
static void put_part(const chunk_array *a, const chunk_shape *s, const chunk_part *p,
                     const uint8_t *chunk, const uint32_t first[ORDER_AXES],
                     const uint32_t end[ORDER_AXES], uint8_t *out) {
    const size_t components = end[ORDER_COMPONENT] - first[ORDER_COMPONENT];
    const size_t size[2] = {end[ORDER_X] - first[ORDER_X], end[ORDER_Y] - first[ORDER_Y]};
    const uint32_t count = p->end[ORDER_X] - p->first[ORDER_X];
    for (uint32_t k = p->first[ORDER_Z]; k < p->end[ORDER_Z]; k++)
        for (uint32_t j = p->first[ORDER_Y]; j < p->end[ORDER_Y]; j++)
            for (uint32_t c = p->first[ORDER_COMPONENT]; c < p->end[ORDER_COMPONENT]; c++) {
                const size_t from = p->at + (k - p->first[ORDER_Z]) * s->stride[ORDER_Z] +
                                    (j - p->first[ORDER_Y]) * s->stride[ORDER_Y] +
                                    (c - p->first[ORDER_COMPONENT]) * s->stride[ORDER_COMPONENT];
                const size_t row = (size_t)(k - first[ORDER_Z]) * size[1] + j - first[ORDER_Y];
                const size_t to = (row * size[0] + p->first[ORDER_X] - first[ORDER_X]) * components;
                put_row(a, s, chunk ? chunk + from * s->width : NULL,
                        out + (to + c - first[ORDER_COMPONENT]) * s->width, components * s->width,
                        count);
            }
}

/* Find the next chunk of a box; false behind the last. */
static bool next_chunk(const chunk_shape *s, const uint32_t first[ORDER_AXES],
                       const uint32_t end[ORDER_AXES], uint32_t index[ORDER_AXES]) {
    for (int r = 0; r < ORDER_AXES; r++) {
        if (++index[r] <= (end[r] - 1) / s->along[r])
            return true;
        index[r] = first[r] / s->along[r];
    }
    return false;
}

status chunk_array_gather(const chunk_array *a, const chunk_shape *s,
                          const uint32_t first[ORDER_AXES], const uint32_t end[ORDER_AXES],
                          const chunk_supply *from, void *out) {
    uint32_t index[ORDER_AXES];
    for (int r = 0; r < ORDER_AXES; r++)
        index[r] = first[r] / s->along[r];
    do {
        const chunk_part p = part_of(s, first, end, index);
        const uint8_t *numbers;
        const status st = from->hold(from->ctx, index, &numbers);
        if (st != ST_OK)
            return st;
        put_part(a, s, &p, numbers, first, end, out);
        if (from->release)
            from->release(from->ctx, index);
    } while (next_chunk(s, first, end, index));
    return ST_OK;
}
