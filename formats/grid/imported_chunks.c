#include "formats/grid/imported_chunks.h"

#include <string.h>
#include <sys/stat.h>

#include "formats/leaf/leaf_check.h"
#include "formats/leaf/outside_chunks.h"
#include "formats/leaf/outside_samples.h"

status imported_chunks_write(const sample_place *at, uint32_t slices, out_stream *out) {
    const stored_samples *s = &at->stored;
    leaf_outside o = {.type = s->type,
                      .components = s->components ? s->components : 1,
                      .component = s->component,
                      .flags = (at->big_endian ? LEAF_OUTSIDE_BIG_ENDIAN : 0) |
                               (s->colours ? LEAF_OUTSIDE_COLOURS : 0) |
                               (at->has_missing ? LEAF_OUTSIDE_MISSING : 0),
                      .slope = s->slope,
                      .intercept = s->intercept,
                      .missing = at->has_missing ? at->missing : 0.0};
    status st = outside_chunks_put(at, "", &o);
    if (st == ST_OK)
        st = out_stream_write(out, &at->table_count, sizeof at->table_count);
    if (st == ST_OK)
        st = out_stream_write(out, &o, sizeof o);
    if (st == ST_OK)
        st = out_stream_write(out, at->table, at->table_count * sizeof *at->table);
    return st == ST_OK && at->slices
               ? out_stream_write(out, at->slices, slices * sizeof *at->slices)
               : st;
}

static status take(byte_stream *from, void *to, size_t size) {
    size_t got = 0;
    const status st = byte_stream_read(from, to, size, &got);
    if (st != ST_OK || got == size)
        return st;
    return status_describe(ST_CORRUPT, "%s: its importer does not tell where its chunks are",
                           byte_stream_name(from));
}

/* Read the names of the slices' files, and look at these. */
static status take_slices(byte_stream *from, const char *folder, const leaf_header *h,
                          imported_chunks *c) {
    const uint32_t count = h->dims[2];
    c->slices = mem_array(c->m, count, sizeof *c->slices);
    status st = c->slices ? take(from, c->slices, count * sizeof *c->slices) : ST_NOMEM;
    if (st == ST_OK)
        st = leaf_check_slices(byte_stream_name(from), h, c->slices, 0);
    return st == ST_OK ? slice_folder_mark(c->m, folder, c->slices, count) : st;
}

/* Read the tables of a section that was found sound. */
static status take_tables(byte_stream *from, const char *path, const leaf_header *h,
                          const leaf_outside *o, imported_chunks *c) {
    c->table = mem_array(c->m, h->outside_chunks, sizeof *c->table);
    status st = c->table ? take(from, c->table, h->outside_chunks * sizeof *c->table) : ST_NOMEM;
    if (st == ST_OK && o->form == LEAF_OUTSIDE_SLICES)
        st = take_slices(from, path, h, c);
    return st == ST_OK ? leaf_check_chunks(byte_stream_name(from), h, o, c->table, c->slices, 0)
                       : st;
}

status imported_chunks_read(byte_stream *from, const char *path, const uint32_t dims[3],
                            sample_type type, imported_chunks *c, sample_place *at) {
    leaf_header h = {.dims = {dims[0], dims[1], dims[2]}, .sample_type = type};
    leaf_outside o;
    struct stat info;
    status st = take(from, &h.outside_chunks, sizeof h.outside_chunks);
    if (st == ST_OK)
        st = take(from, &o, sizeof o);
    if (st != ST_OK)
        return st;
    const bool in_slices = o.form == LEAF_OUTSIDE_SLICES;
    h.outside = in_slices ? LEAF_IN_SLICES : LEAF_IN_FILE;
    o.file_bytes = !in_slices && stat(path, &info) == 0 ? (uint64_t)info.st_size : 0;
    o.path[0] = '.'; /* it is the caller who knows */
    st = leaf_check_outside(byte_stream_name(from), &h, &o, 0);
    if (st == ST_OK && !in_slices && o.form != LEAF_OUTSIDE_TABLE)
        st = status_describe(ST_CORRUPT, "%s: its importer tells of no chunks", path);
    if (st == ST_OK)
        st = take_tables(from, path, &h, &o, c);
    if (st != ST_OK)
        return st;
    c->array = outside_chunks_array(&o, dims);
    *at = outside_samples_place(&o);
    at->path = path;
    at->chunks = &c->array;
    at->step = o.step;
    at->table = c->table;
    at->table_count = h.outside_chunks;
    at->slices = c->slices;
    return ST_OK;
}

void imported_chunks_release(imported_chunks *c) {
    if (c->m) {
        mem_free(c->m, c->table);
        mem_free(c->m, c->slices);
    }
    c->table = NULL;
    c->slices = NULL;
}
