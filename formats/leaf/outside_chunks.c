#include "formats/leaf/outside_chunks.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "formats/grid/chunk_cache.h"

struct outside_chunks {
    mem *m;
    chunk_array array;
    chunk_cache *cache;
    char *path;                           /* of their folder, or file */
    bool in_file;                         /* all of them in one */
    uint32_t step, first_number, numbers; /* those of a sample that are taken */
};

/* ---- the section ---- */

/* The axes' roles in a section, which are numbers from 1, are ORDER_X .. ORDER_STEP. */
_Static_assert(ORDER_X == 0 && ORDER_Y == 1 && ORDER_Z == 2 && ORDER_COMPONENT == 3 &&
                   ORDER_STEP == 4 && CHUNK_AXES == (int)LEAF_CHUNK_AXES &&
                   ZARR_FILTERS == (int)LEAF_CHUNK_FILTERS,
               "sections store them");

static leaf_filter filter_of(const zarr_filter *f) {
    return (leaf_filter){.kind = (uint32_t)f->kind + 1,
                         .element = f->element,
                         .type = f->plain.type,
                         .coded_type = f->coded.type,
                         .flags = (f->plain.big_endian ? LEAF_FILTER_BIG_ENDIAN : 0) |
                                  (f->coded.big_endian ? LEAF_FILTER_BIG_CODED : 0),
                         .scale = f->scale,
                         .offset = f->offset,
                         .row = f->row};
}

static zarr_filter filter_from(const leaf_filter *f) {
    return (zarr_filter){
        .kind = (int)f->kind - 1,
        .element = f->element,
        .plain = {(sample_type)f->type, (f->flags & LEAF_FILTER_BIG_ENDIAN) != 0},
        .coded = {(sample_type)f->coded_type, (f->flags & LEAF_FILTER_BIG_CODED) != 0},
        .scale = f->scale,
        .offset = f->offset,
        .row = f->row};
}

/* Returns how far above a folder the trusted one is; 0 where it is none of those above. Both are
 * without links. */
static uint32_t levels_between(const char *trusted, const char *folder) {
    const size_t length = strlen(trusted);
    uint32_t levels = 0;
    if (strncmp(folder, trusted, length) != 0 || (folder[length] && folder[length] != '/'))
        return 0;
    for (const char *at = folder + length; *at; at++)
        levels += *at == '/';
    return levels;
}

status outside_chunks_put(const sample_place *at, const char *folder, leaf_outside *out) {
    const chunk_array *a = at->chunks;
    char trusted[PATH_MAX];
    chunk_shape shape;
    if (!chunk_array_measure(a, &shape) || shape.room > OUTSIDE_CHUNK_MAX)
        return status_describe(ST_UNSUPPORTED,
                               "%s: --in-place takes chunks of at most %llu bytes, unpacked",
                               at->path, (unsigned long long)OUTSIDE_CHUNK_MAX);
    out->form = at->slices  ? LEAF_OUTSIDE_SLICES
                : at->table ? LEAF_OUTSIDE_TABLE
                            : LEAF_OUTSIDE_FILES;
    out->axes = (uint32_t)a->axes;
    out->chunk_flags = (a->fortran ? LEAF_CHUNKS_FORTRAN : 0) |
                       (a->separator == '/' ? LEAF_CHUNKS_SLASH : 0) |
                       (at->follow_links ? LEAF_CHUNKS_LINKS : 0) |
                       (a->summed ? LEAF_CHUNKS_SUMMED : 0) | (a->rows ? LEAF_CHUNKS_CUT : 0);
    out->codec = a->codec;
    out->filters = (uint32_t)a->filters.count;
    out->step = at->step;
    if (at->trusted && realpath(at->trusted, trusted))
        out->levels_up = levels_between(trusted, folder);
    memcpy(out->fill, a->fill, sizeof out->fill);
    for (int i = 0; i < a->axes; i++) {
        out->chunk[i] = a->chunk[i];
        out->role[i] = (uint32_t)(a->role[i] + 1);
    }
    for (int i = 0; i < a->filters.count; i++)
        out->filter[i] = filter_of(&a->filters.of[i]);
    return ST_OK;
}

chunk_array outside_chunks_array(const leaf_outside *o, const uint32_t dims[3]) {
    chunk_array a = {.axes = (int)o->axes,
                     .fortran = (o->chunk_flags & LEAF_CHUNKS_FORTRAN) != 0,
                     .separator = o->chunk_flags & LEAF_CHUNKS_SLASH ? '/' : '.',
                     .type = (sample_type)o->type,
                     .big_endian = (o->flags & LEAF_OUTSIDE_BIG_ENDIAN) != 0,
                     .codec = (zarr_codec)o->codec,
                     .summed = (o->chunk_flags & LEAF_CHUNKS_SUMMED) != 0,
                     .filters = {.count = (int)o->filters}};
    memcpy(a.fill, o->fill, sizeof a.fill);
    a.rows = o->chunk_flags & LEAF_CHUNKS_CUT && dims ? dims[1] : 0;
    for (int i = 0; i < a.axes; i++) {
        a.chunk[i] = o->chunk[i];
        a.role[i] = (int)o->role[i] - 1;
    }
    for (int i = 0; i < a.filters.count; i++)
        a.filters.of[i] = filter_from(&o->filter[i]);
    return a;
}

/* Returns whether each role has one axis at most, and those that are needed have one. */
static bool roles_suit(const leaf_outside *o) {
    uint32_t count[ORDER_AXES + 1] = {0};
    for (uint32_t i = 0; i < o->axes; i++)
        count[o->role[i]]++;
    for (int r = 1; r <= ORDER_AXES; r++)
        if (count[r] > 1 || (r <= 3 && !count[r]))
            return false;
    return (count[ORDER_COMPONENT + 1] || o->components == 1) &&
           (count[ORDER_STEP + 1] || o->step == 0);
}

const char *outside_chunks_fault(const leaf_outside *o) {
    const chunk_array a = outside_chunks_array(o, NULL);
    chunk_shape shape;
    for (uint32_t i = 0; i < LEAF_CHUNK_AXES; i++)
        if (i < o->axes ? !o->chunk[i] : o->chunk[i] || o->role[i])
            return "a size of chunks for each axis, and no more";
    if (!roles_suit(o))
        return "an axis each for x, y, z, and for what else is there";
    if (!zarr_filters_sound(&a.filters, (zarr_number){a.type, a.big_endian}))
        return "filters that can be undone";
    if (!chunk_array_measure(&a, &shape) || shape.room > OUTSIDE_CHUNK_MAX)
        return "chunks of at most 2^32 bytes";
    if (o->form == LEAF_OUTSIDE_SLICES && shape.along[ORDER_Z] != 1)
        return "chunks of one slice each";
    if (o->chunk_flags & LEAF_CHUNKS_CUT && !chunk_array_cuts(&a, &shape))
        return "chunks that can lack rows";
    return NULL;
}

const char *outside_chunks_entry_fault(const leaf_outside *o, uint64_t bytes,
                                       const chunk_entry *e) {
    if (!e->bytes)
        return e->offset || e->skipped ? "nothing of a chunk that is not there" : NULL;
    if (e->offset > bytes || e->bytes > bytes - e->offset)
        return "a chunk in its file";
    return e->skipped >> (o->filters + 2) ? "filters that there are" : NULL;
}

/* ---- boxes ---- */

/* Numbers of nodes, by roles. */
typedef struct number_box {
    uint32_t first[ORDER_AXES], end[ORDER_AXES];
} number_box;

static uint32_t first_number(const leaf_outside *o) {
    return o->component ? o->component - 1 : 0;
}

static uint32_t numbers_taken(const leaf_outside *o) {
    return o->component ? 1 : o->components;
}

/* The chunks of a whole grid; UINT64_MAX: more. */
static uint64_t find_range(const leaf_outside *o, const uint32_t dims[3], chunk_range *range) {
    const chunk_array a = outside_chunks_array(o, dims);
    const uint32_t first[ORDER_AXES] = {0, 0, 0, first_number(o), o->step};
    const uint32_t end[ORDER_AXES] = {dims[0], dims[1], dims[2],
                                      first[ORDER_COMPONENT] + numbers_taken(o), o->step + 1};
    chunk_shape s;
    (void)chunk_array_measure(&a, &s);
    return chunk_array_range(&s, first, end, range);
}

uint64_t outside_chunks_count(const leaf_outside *o, const uint32_t dims[3]) {
    chunk_range range;
    return find_range(o, dims, &range);
}

uint32_t outside_chunks_in_slice(const leaf_outside *o, const uint32_t dims[3]) {
    chunk_range range;
    (void)find_range(o, dims, &range);
    return range.count[ORDER_X] * range.count[ORDER_Y];
}

static number_box box_of(const outside_chunks *c, const uint32_t at[3], const uint32_t count[3]) {
    return (number_box){{at[0], at[1], at[2], c->first_number, c->step},
                        {at[0] + count[0], at[1] + count[1], at[2] + count[2],
                         c->first_number + c->numbers, c->step + 1}};
}

/* ---- reading ---- */

/* Cut so many names from the end of a path. */
static void cut_names(char *path, uint32_t count) {
    for (char *slash; count > 0 && (slash = strrchr(path, '/')); count--)
        slash[slash == path] = '\0';
}

static status open_cache(outside_chunks *c, const leaf_outside *o, const outside_chunks_in *in) {
    static const uint32_t origin[3];
    const number_box all = box_of(c, origin, in->dims);
    chunk_home home = {.path = c->path,
                       .follow_links = (o->chunk_flags & LEAF_CHUNKS_LINKS) != 0,
                       .is_index = true,
                       .table = in->table,
                       .in = in->f,
                       .files = in->slices};
    chunk_shape s;
    char real[PATH_MAX]; /* of which names can be cut: none of them is `..` */
    char *trusted = mem_copy_text(c->m, realpath(c->path, real) ? real : c->path);
    if (!trusted)
        return ST_NOMEM;
    cut_names(trusted, o->levels_up);
    home.trusted = trusted;
    (void)chunk_array_measure(&c->array, &s);
    (void)chunk_array_range(&s, all.first, all.end, &home.range);
    status st = chunk_cache_create(c->m, &c->array, &home, &c->cache);
    mem_free(c->m, trusted);
    if (st == ST_NOMEM)
        st = status_describe(st, "%s: to read a chunk: %s", c->path, status_text());
    return st;
}

status outside_chunks_open(mem *m, const leaf_outside *o, const outside_chunks_in *in,
                           outside_chunks **out) {
    outside_chunks *c = mem_zalloc(m, sizeof *c);
    if (!c)
        return ST_NOMEM;
    *c = (outside_chunks){.m = m,
                          .array = outside_chunks_array(o, in->dims),
                          .path = mem_copy_text(m, in->f ? file_path(in->f) : in->slices->folder),
                          .in_file = in->table != NULL,
                          .step = o->step,
                          .first_number = first_number(o),
                          .numbers = numbers_taken(o)};
    if (c->path && !in->table)
        cut_names(c->path, 1);
    status st = c->path ? ST_OK : ST_NOMEM;
    if (st == ST_OK && strlen(c->path) >= CHUNK_FOLDER)
        st = status_describe(ST_UNSUPPORTED, "%s: too long a path", c->path);
    if (st == ST_OK)
        st = open_cache(c, o, in);
    if (st != ST_OK) {
        outside_chunks_close(c);
        return st;
    }
    *out = c;
    return ST_OK;
}

void outside_chunks_close(outside_chunks *c) {
    if (!c)
        return;
    chunk_cache_destroy(c->cache);
    mem_free(c->m, c->path);
    mem_free(c->m, c);
}

const char *outside_chunks_path(const outside_chunks *c) {
    return c->path;
}

bool outside_chunks_are_wide(const outside_chunks *c, uint32_t side) {
    enum { SEVERAL = 4 };
    const chunk_shape *s = chunk_cache_shape(c->cache);
    const uint64_t x = s->along[ORDER_X] / side, y = s->along[ORDER_Y] / side;
    return (x ? x : 1) * (y ? y : 1) > SEVERAL;
}

status outside_chunks_load(outside_chunks *c, const uint32_t first[3], const uint32_t count[3],
                           void *numbers, uint64_t *read) {
    const number_box b = box_of(c, first, count);
    return chunk_cache_gather(c->cache, b.first, b.end, numbers, read);
}

/* Files that are looked for, at most: a box has few. */
enum { LOOKED_AT = 1024 };

/* Name the first chunk of a range whose file is not there, and count the others. */
static void print_absent(const outside_chunks *c, const chunk_range *range, char *text,
                         size_t room) {
    uint32_t index[ORDER_AXES], absent = 0;
    char path[CHUNK_FOLDER + CHUNK_NAME], first[CHUNK_NAME] = "";
    memcpy(index, range->first, sizeof index);
    for (int n = 0, r = 0; n < LOOKED_AT && r < ORDER_AXES; n++) {
        struct stat info;
        if (lstat(chunk_array_path(&c->array, c->path, index, path), &info) != 0 && !absent++)
            snprintf(first, sizeof first, "%.*s", CHUNK_NAME - 1, path + strlen(c->path) + 1);
        for (r = 0; r < ORDER_AXES && ++index[r] == range->first[r] + range->count[r]; r++)
            index[r] = range->first[r];
    }
    if (absent == 1)
        snprintf(text, room, ", of which %s is not there", first);
    else if (absent)
        snprintf(text, room, ", of which %s and %u more are not there", first, absent - 1);
}

const char *outside_chunks_print(const outside_chunks *c, const uint32_t first[3],
                                 const uint32_t count[3], char text[OUTSIDE_CHUNKS_TEXT]) {
    const number_box b = box_of(c, first, count);
    char path[2][CHUNK_FOLDER + CHUNK_NAME], absent[CHUNK_NAME + 64] = "";
    chunk_range range;
    const bool one = chunk_array_range(chunk_cache_shape(c->cache), b.first, b.end, &range) == 1;
    const char *from = chunk_array_path(&c->array, "", range.first, path[0]) + 1;
    if (!c->in_file)
        print_absent(c, &range, absent, sizeof absent);
    for (int r = 0; r < ORDER_AXES; r++)
        range.first[r] += range.count[r] - 1;
    const char *to = chunk_array_path(&c->array, "", range.first, path[1]) + 1;
    snprintf(text, OUTSIDE_CHUNKS_TEXT, "%s %.*s%s%.*s%s", one ? "chunk" : "chunks", CHUNK_NAME,
             from, one ? "" : " to ", CHUNK_NAME, one ? "" : to, absent);
    return text;
}
