#include "formats/leaf/outside_samples.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/file_mark.h"
#include "formats/base/hash.h"
#include "formats/leaf/outside_chunks.h"

/* Rows that lie within a page of each other are read with what lies between them, at most so many
 * bytes at once: the disk would read it anyway. */
enum { NEAR = 4096, AT_ONCE = 64 << 10 };
/* Numbers from chunks are gathered by whole slices of a box, of at most so many bytes together. */
enum { GATHERED = 4 << 20 };

struct outside_samples {
    mem *m;
    sample_place place;
    file *f; /* NULL: the files of slices */
    file_mark mark;
    char *path, *by; /* of the file or folder, and of the treelet file */
    slice_folder slices;
    uint32_t dims[3];
    size_t width;           /* bytes of a stored sample */
    uint64_t stride_y;      /* bytes from one row to the next */
    outside_chunks *chunks; /* NULL: one piece */
};

/* ---- The section ---- */

sample_place outside_samples_place(const leaf_outside *o) {
    return (sample_place){.path = o->path,
                          .offset = o->offset,
                          .big_endian = (o->flags & LEAF_OUTSIDE_BIG_ENDIAN) != 0,
                          .stored = {.type = (sample_type)o->type,
                                     .components = o->components,
                                     .component = o->component,
                                     .colours = (o->flags & LEAF_OUTSIDE_COLOURS) != 0,
                                     .slope = o->slope,
                                     .intercept = o->intercept},
                          .has_missing = (o->flags & LEAF_OUTSIDE_MISSING) != 0,
                          .missing = o->missing};
}

/* ---- Paths ---- */

/* The folder of a path, without links, which ends in "/". If false, errno says why. */
static bool folder_of(const char *path, char folder[PATH_MAX]) {
    char copy[PATH_MAX];
    const char *slash = strrchr(path, '/');
    const size_t length = slash ? (size_t)(slash - path) : 0;
    errno = ENAMETOOLONG;
    if (length + 2 > sizeof copy)
        return false;
    memcpy(copy, path, length);
    snprintf(copy + length, sizeof copy - length, "%s", !slash ? "." : length == 0 ? "/" : "");
    if (!realpath(copy, folder))
        return false;
    const size_t end = strlen(folder);
    errno = ENAMETOOLONG;
    if (end + 2 > PATH_MAX)
        return false;
    if (end > 1)
        memcpy(folder + end, "/", 2);
    return true;
}

/* The way from a folder to a file, both without links. Returns false if it does not fit. */
static bool path_between(const char *folder, const char *target, char out[], size_t size) {
    size_t same = 0, used = 0;
    for (size_t i = 0; folder[i] && folder[i] == target[i]; i++)
        same = folder[i] == '/' ? i + 1 : same;
    for (const char *up = folder + same; (up = strchr(up, '/')); up++) {
        if (used + 4 > size)
            return false;
        memcpy(out + used, "../", 3);
        used += 3;
    }
    return snprintf(out + used, size - used, "%s", target + same) < (int)(size - used);
}

/* The path to open. leaf may be a link: the folder is that of the file itself. */
static char *found_path(mem *m, const char *leaf, const char *path) {
    char real[PATH_MAX], folder[PATH_MAX] = "";
    const char *own = realpath(leaf, real) ? real : leaf;
    if (*path != '/' && !folder_of(own, folder))
        folder[0] = '\0';
    const size_t length = strlen(folder);
    char *found = mem_alloc(m, length + strlen(path) + 1);
    if (!found)
        return NULL;
    memcpy(found, folder, length);
    memcpy(found + length, path, strlen(path) + 1);
    return found;
}

/* ---- The file ---- */

/* Whether the place's file describes chunks that are files beside it. */
static bool is_described(const sample_place *at) {
    return at->chunks && !at->table;
}

/* Fill in what a section says of its file and the samples. */
static void put_samples(const sample_place *at, const file_mark *mark, leaf_outside *out) {
    const stored_samples *s = &at->stored;
    *out = (leaf_outside){.file_bytes = mark->size,
                          .modified_s = mark->modified_s,
                          .modified_ns = (uint32_t)mark->modified_ns,
                          .type = s->type,
                          .offset = at->offset,
                          .components = s->components ? s->components : 1,
                          .component = s->component,
                          .flags = (at->big_endian ? LEAF_OUTSIDE_BIG_ENDIAN : 0) |
                                   (s->colours ? LEAF_OUTSIDE_COLOURS : 0) |
                                   (at->has_missing ? LEAF_OUTSIDE_MISSING : 0),
                          .slope = s->slope,
                          .intercept = s->intercept,
                          .missing = at->has_missing ? at->missing : 0.0};
}

/* The checksum of a small file's bytes. */
static status sum_file(mem *m, file *f, uint64_t *sum) {
    const uint64_t size = file_size(f);
    if (size > OUTSIDE_JSON_MAX)
        return status_describe(ST_CORRUPT, "%s: more than %d bytes", file_path(f),
                               OUTSIDE_JSON_MAX);
    char *bytes = mem_alloc(m, (size_t)size);
    const status st = bytes ? file_read_at(f, 0, bytes, (size_t)size) : ST_NOMEM;
    if (st == ST_OK)
        *sum = hash_bytes(bytes, (size_t)size);
    mem_free(m, bytes);
    return st;
}

/* Look at the file that has or describes the samples. Those of slices have been looked at. */
static status look_at(mem *m, const sample_place *at, leaf_outside *out) {
    file_mark mark = {.size = 0};
    file *f = NULL;
    if (at->slices) {
        put_samples(at, &mark, out);
        return ST_OK;
    }
    status st = file_open(m, at->path, &f);
    if (st == ST_OK)
        st = file_mark_take(f, &mark);
    if (st == ST_OK)
        put_samples(at, &mark, out);
    if (st == ST_OK && is_described(at))
        st = sum_file(m, f, &out->sum);
    file_close(f);
    return st;
}

/* The path without links. Chunks lie beside the file by its name, wherever a link leads from there.
 * If false, errno says why. */
static bool find_target(const sample_place *at, char target[PATH_MAX]) {
    if (!is_described(at))
        return realpath(at->path, target) != NULL;
    const char *name = strrchr(at->path, '/');
    if (!folder_of(at->path, target))
        return false;
    const size_t end = strlen(target);
    errno = ENAMETOOLONG;
    return snprintf(target + end, PATH_MAX - end, "%s", name ? name + 1 : at->path) <
           (int)(PATH_MAX - end);
}

static status describe_chunks(const sample_place *at, const char *target, leaf_outside *out) {
    char folder[PATH_MAX];
    memcpy(folder, target, sizeof folder);
    *strrchr(folder, '/') = '\0';
    return outside_chunks_put(at, folder, out);
}

status outside_samples_describe(mem *m, const sample_place *at, const char *leaf,
                                leaf_outside *out) {
    char folder[PATH_MAX], target[PATH_MAX] = "";
    status st = look_at(m, at, out);
    if (st != ST_OK)
        return st;
    if (!folder_of(leaf, folder))
        return file_failed(errno, leaf, "its folder");
    if (!find_target(at, target))
        return file_failed(errno, at->path, "its path");
    if (at->chunks)
        st = describe_chunks(at, target, out);
    if (st != ST_OK || path_between(folder, target, out->path, sizeof out->path))
        return st;
    return status_describe(ST_UNSUPPORTED, "%s: the path to its input has more than %zu bytes: %s",
                           leaf, sizeof out->path - 1, at->path);
}

static status compare(const outside_samples *s, const char *leaf, const leaf_outside *o) {
    file_mark then = {
        .size = o->file_bytes, .modified_s = o->modified_s, .modified_ns = (int64_t)o->modified_ns};
    /* Of a file that only describes chunks all bytes are compared: its time does not count. */
    if (o->form == LEAF_OUTSIDE_FILES) {
        then.modified_s = s->mark.modified_s;
        then.modified_ns = s->mark.modified_ns;
    }
    return file_mark_compare(&s->mark, &then, s->path, leaf);
}

/* Check that the file which describes the chunks is still the same. */
static status compare_sum(outside_samples *s, const char *leaf, const leaf_outside *o) {
    uint64_t sum = 0;
    if (o->form != LEAF_OUTSIDE_FILES)
        return ST_OK;
    const status st = sum_file(s->m, s->f, &sum);
    if (st != ST_OK || sum == o->sum)
        return st;
    return status_describe(ST_CORRUPT,
                           "%s: is another one than when %s was made of it: convert it again",
                           file_path(s->f), leaf);
}

/* The numbers from chunks are in native byte order, and only those that are taken. */
static status open_chunks(outside_samples *s, const char *leaf, const leaf_outside *o,
                          const chunk_entry *table) {
    const outside_chunks_in in = {s->f, table, s->slices.of ? &s->slices : NULL, s->dims};
    stored_samples *stored = &s->place.stored;
    const status st = compare_sum(s, leaf, o);
    s->place.big_endian = __BYTE_ORDER == __BIG_ENDIAN;
    stored->components = o->component ? 1 : o->components;
    stored->component = 0;
    s->width = stored_samples_bytes(stored);
    return st == ST_OK ? outside_chunks_open(s->m, o, &in, &s->chunks) : st;
}

/* Say whose samples a file that cannot be opened has. */
static status explain(const char *leaf, status st) {
    return st == ST_IO ? status_describe(ST_IO, "%s: its samples lie in another file: %s", leaf,
                                         status_text())
                       : st;
}

static status open_file(outside_samples *s, const char *leaf, const leaf_outside *o) {
    status st = explain(leaf, file_open(s->m, s->path, &s->f));
    if (st == ST_OK)
        st = file_mark_take(s->f, &s->mark);
    return st == ST_OK ? compare(s, leaf, o) : st;
}

static status open_slices(outside_samples *s, const char *leaf, const slice_file *of) {
    s->by = mem_copy_text(s->m, leaf);
    s->slices = (slice_folder){s->path, of, s->dims[2], s->by};
    return s->by ? explain(leaf, slice_folder_check(s->m, &s->slices)) : ST_NOMEM;
}

status outside_samples_open(mem *m, const char *leaf, const leaf_outside *o,
                            const outside_tables *tables, const uint32_t dims[3],
                            outside_samples **out) {
    outside_samples *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (outside_samples){.m = m, .place = outside_samples_place(o)};
    memcpy(s->dims, dims, sizeof s->dims);
    s->width = stored_samples_bytes(&s->place.stored);
    s->stride_y = s->width * dims[0];
    s->path = found_path(m, leaf, o->path);
    status st = !s->path         ? ST_NOMEM
                : tables->slices ? open_slices(s, leaf, tables->slices)
                                 : open_file(s, leaf, o);
    if (st == ST_OK && o->form != LEAF_OUTSIDE_PIECE)
        st = open_chunks(s, leaf, o, tables->chunks);
    if (st != ST_OK) {
        outside_samples_close(s);
        return st;
    }
    s->place.path = s->path;
    *out = s;
    return ST_OK;
}

void outside_samples_close(outside_samples *s) {
    if (!s)
        return;
    outside_chunks_close(s->chunks);
    file_close(s->f);
    mem_free(s->m, s->path);
    mem_free(s->m, s->by);
    mem_free(s->m, s);
}

const char *outside_samples_path(const outside_samples *s) {
    return s->chunks ? outside_chunks_path(s->chunks) : s->path;
}

status outside_samples_changed(const outside_samples *s) {
    return s->f ? file_mark_check(s->f, &s->mark) : ST_OK;
}

/* ---- Boxes ---- */

/* The nodes of a box that exist, and how many of the box come before them. */
typedef struct node_box {
    uint32_t first[3], count[3], before[3];
} node_box;

static node_box nodes_of(const outside_samples *s, const outside_box *b) {
    node_box n;
    for (int a = 0; a < 3; a++) {
        const int64_t at = b->first[a], end = at + b->size[a], dims = s->dims[a];
        n.first[a] = at < 0 ? 0 : (uint32_t)at;
        n.before[a] = at < 0 ? (uint32_t)-at : 0;
        n.count[a] = (uint32_t)(end < dims ? end : dims) - n.first[a];
    }
    return n;
}

/* The bytes from the first sample of so many rows to the last. */
static uint64_t span_of(const outside_samples *s, const node_box *n, uint32_t rows) {
    return (rows - 1) * s->stride_y + n->count[0] * s->width;
}

/* How many rows are read from row y on. */
static uint32_t rows_at_once(const outside_samples *s, const node_box *n, uint32_t y) {
    const uint32_t left = n->count[1] - y, most = AT_ONCE / NEAR;
    if (s->stride_y > NEAR)
        return 1;
    return left < most ? left : most;
}

/* How many slices of a box are gathered at once. */
static uint32_t slices_at_once(const outside_samples *s, const uint32_t size[3]) {
    const size_t slice = (size_t)size[0] * size[1] * s->width;
    const size_t most = GATHERED / slice ? GATHERED / slice : 1;
    return size[2] < most ? size[2] : (uint32_t)most;
}

size_t outside_samples_room(const outside_samples *s, uint32_t side) {
    const size_t row = side * s->width;
    const size_t slice = row * side;
    /* Of smaller boxes more slices may go into as much. */
    if (s->chunks)
        return slice > GATHERED ? slice : slice * side < GATHERED ? slice * side : GATHERED;
    return row > NEAR ? row + AT_ONCE : NEAR + AT_ONCE;
}

uint64_t outside_samples_bytes(const outside_samples *s, const outside_box *b) {
    const node_box n = nodes_of(s, b);
    uint64_t slice = 0;
    if (s->chunks)
        return (uint64_t)n.count[0] * n.count[1] * n.count[2] * s->width;
    for (uint32_t y = 0, rows; y < n.count[1]; y += rows) {
        rows = rows_at_once(s, &n, y);
        slice += span_of(s, &n, rows);
    }
    return slice * n.count[2];
}

bool outside_samples_are_shared(const outside_samples *s, uint32_t side) {
    return s->chunks && outside_chunks_are_wide(s->chunks, side);
}

/* Copy the first and the last item of a run that has gaps before and behind it into these. */
static void repeat_ends(char *items, size_t bytes, uint32_t all, uint32_t before, uint32_t count) {
    for (uint32_t i = 0; i < before; i++)
        memcpy(items + i * bytes, items + before * bytes, bytes);
    for (uint32_t i = before + count; i < all; i++)
        memcpy(items + i * bytes, items + (before + count - 1) * bytes, bytes);
}

/* Convert a row. at: its byte, for messages. */
static status take_row(const outside_samples *s, void *in, void *out, size_t count, uint64_t at) {
    if (sample_place_take(&s->place, in, out, count))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: byte %llu: a number that no conversion takes",
                           file_path(s->f), (unsigned long long)at);
}

/* Read a slice of nodes, and convert it to a slice of a box of this size. */
static status load_slice(outside_samples *s, const node_box *n, const uint32_t size[3], uint32_t z,
                         char *room, char *slice) {
    const size_t width = sample_size(sample_place_type(&s->place)), row = size[0] * width;
    const uint64_t at = s->place.offset + (n->first[2] + z) * s->stride_y * s->dims[1] +
                        n->first[1] * s->stride_y + n->first[0] * s->width;
    for (uint32_t y = 0, rows; y < n->count[1]; y += rows) {
        const uint64_t from = at + y * s->stride_y;
        rows = rows_at_once(s, n, y);
        status st = file_read_at(s->f, from, room, (size_t)span_of(s, n, rows));
        for (uint32_t i = 0; i < rows && st == ST_OK; i++) {
            char *to = slice + (n->before[1] + y + i) * row;
            st = take_row(s, room + i * s->stride_y, to + n->before[0] * width, n->count[0],
                          from + i * s->stride_y);
            repeat_ends(to, width, size[0], n->before[0], n->count[0]);
        }
        if (st != ST_OK)
            return st;
    }
    repeat_ends(slice, row, size[1], n->before[1], n->count[1]);
    return ST_OK;
}

/* Convert a gathered slice of nodes to a slice of a box of this size. */
static status take_slice(const outside_samples *s, const node_box *n, const uint32_t size[3],
                         uint32_t z, char *numbers, char *slice) {
    const size_t width = sample_size(sample_place_type(&s->place)), row = size[0] * width;
    for (uint32_t y = 0; y < n->count[1]; y++) {
        char *to = slice + (n->before[1] + y) * row;
        if (!sample_place_take(&s->place, numbers + (size_t)y * n->count[0] * s->width,
                               to + n->before[0] * width, n->count[0]))
            return status_describe(
                ST_CORRUPT,
                "%s: the samples from %u, %u, %u on have a number that no conversion "
                "takes",
                outside_samples_path(s), n->first[0], n->first[1] + y, n->first[2] + z);
        repeat_ends(to, width, size[0], n->before[0], n->count[0]);
    }
    repeat_ends(slice, row, size[1], n->before[1], n->count[1]);
    return ST_OK;
}

/* The slices of a box that exist, from chunks. samples: of the first one. */
static status load_chunks(outside_samples *s, const node_box *n, const uint32_t size[3],
                          size_t slice, char *room, char *samples, uint64_t *read) {
    const size_t gathered = (size_t)n->count[0] * n->count[1] * s->width;
    const uint32_t most = slices_at_once(s, n->count);
    status st = ST_OK;
    for (uint32_t z = 0, count; z < n->count[2] && st == ST_OK; z += count) {
        const uint32_t left = n->count[2] - z;
        count = left < most ? left : most;
        const uint32_t from[3] = {n->first[0], n->first[1], n->first[2] + z};
        st = outside_chunks_load(s->chunks, from, (uint32_t[3]){n->count[0], n->count[1], count},
                                 room, read);
        for (uint32_t i = 0; i < count && st == ST_OK; i++)
            st = take_slice(s, n, size, z + i, room + i * gathered, samples + (z + i) * slice);
    }
    return st;
}

/* The same from a file in one piece. */
static status load_piece(outside_samples *s, const node_box *n, const uint32_t size[3],
                         size_t slice, char *room, char *samples) {
    status st = ST_OK;
    for (uint32_t z = 0; z < n->count[2] && st == ST_OK; z++)
        st = load_slice(s, n, size, z, room, samples + z * slice);
    return st;
}

status outside_samples_load(outside_samples *s, const outside_box *b, void *room, void *samples,
                            uint64_t *read) {
    const node_box n = nodes_of(s, b);
    const size_t slice =
        (size_t)b->size[0] * b->size[1] * sample_size(sample_place_type(&s->place));
    char *first = (char *)samples + n.before[2] * slice;
    *read += s->chunks ? 0 : outside_samples_bytes(s, b);
    const status st = s->chunks ? load_chunks(s, &n, b->size, slice, room, first, read)
                                : load_piece(s, &n, b->size, slice, room, first);
    if (st == ST_OK)
        repeat_ends(samples, slice, b->size[2], n.before[2], n.count[2]);
    return st;
}

const char *outside_samples_print(const outside_samples *s, const outside_box *b,
                                  char text[OUTSIDE_SAMPLES_TEXT]) {
    const node_box n = nodes_of(s, b);
    const uint32_t last = n.first[2] + n.count[2] - 1;
    char chunks[OUTSIDE_CHUNKS_TEXT];
    if (s->slices.of)
        snprintf(text, OUTSIDE_SAMPLES_TEXT, "%s: a file from %s to %s", outside_samples_path(s),
                 s->slices.of[n.first[2]].name, s->slices.of[last].name);
    else if (s->chunks)
        snprintf(text, OUTSIDE_SAMPLES_TEXT, "%s: %s", outside_samples_path(s),
                 outside_chunks_print(s->chunks, n.first, n.count, chunks));
    else
        snprintf(text, OUTSIDE_SAMPLES_TEXT, "%s", outside_samples_path(s));
    return text;
}

uint64_t outside_samples_sum(const void *samples, size_t bytes) {
    const uint64_t sum = hash_bytes(samples, bytes);
    return sum ? sum : 1;
}
