/* leaf_writer_finish.c - finishing a treelet file: payloads to their places, ranges merged, then
 * the directory (leaf_writer_directory.c) and the header. */
#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/base/file_guard.h"
#include "formats/base/hash.h"
#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/leaf_check.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_head.h"
#include "formats/leaf/leaf_unpacker.h"
#include "formats/leaf/leaf_writer_private.h"
#include "formats/leaf/mesh_layout.h"

/* Place the payloads of a mesh, all of whose sizes are known. */
static void place_payloads(leaf_writer *w) {
    w->next = (leaf_placing){.end = leaf_writer_payloads_at(w)};
    w->header.payload_bytes = 0;
    for (leaf_order o = leaf_order_begin(&w->layout); o.p < w->layout.payloads;
         leaf_order_next(&o, &w->layout))
        w->header.payload_bytes += leaf_writer_place(w, o.p);
}

void leaf_writer_stop_by(leaf_writer *w, const progress *p) {
    w->stop = p;
}

static status make_copy_room(leaf_writer *w) {
    w->copy_buffer = mem_alloc(w->m, leaf_layout_stored_max(&w->layout));
    return w->copy_buffer ? ST_OK : ST_NOMEM;
}

static status copy_payload(leaf_writer *w, uint32_t p) {
    const size_t size = (size_t)w->sizes[p];
    if (w->scratch_at[p] == NOT_THERE)
        return ST_OK;
    status st = out_file_read_at(w->scratch, w->scratch_at[p], w->copy_buffer, size);
    return st == ST_OK ? out_file_write_at(w->out, w->offsets[p], w->copy_buffer, size) : st;
}

/* Copy payloads from the scratch file to their places. Which ones wait there depends on chance, but
 * not how often to ask whether to go on. */
static status copy_payloads(leaf_writer *w) {
    enum { SOME = 256 };
    status st = ST_OK;
    place_payloads(w);
    for (uint32_t p = 0; p < w->layout.payloads && st == ST_OK; p++) {
        st = p % SOME == 0 ? progress_ask(w->stop, "build") : ST_OK;
        if (st == ST_OK)
            st = copy_payload(w, p);
    }
    return st;
}

/* All payloads of a grid are at their places. */
static void end_payloads(leaf_writer *w) {
    assert(w->order.p == w->layout.payloads && !w->waiting);
    w->header.payload_bytes = 0;
    for (uint32_t p = 0; p < w->layout.payloads; p++)
        w->header.payload_bytes += leaf_writer_is_same(w, p) ? 0 : w->sizes[p];
}

/* Merge the ranges of a grid's set, last treelet first: children come behind their parents. */
static void merge_ranges(leaf_writer *w, uint32_t set) {
    const leaf_layout *l = &w->layout;
    const size_t first = leaf_layout_samples(l, set, 0);
    float(*ranges)[2] = w->ranges + first;
    for (uint32_t t = l->treelets; t-- > 0;) {
        float *merged = ranges[t];
        memcpy(merged, w->own[first + t], sizeof w->own[first + t]);
        uint32_t child = l->first_child[t];
        for (int n = __builtin_popcount(leaf_layout_children(l, t)); n > 0; n--, child++) {
            merged[0] = ranges[child][0] < merged[0] ? ranges[child][0] : merged[0];
            merged[1] = ranges[child][1] > merged[1] ? ranges[child][1] : merged[1];
        }
    }
}

/* Compute the header's values of a grid from its treelets. */
static void sum_up_grid(leaf_writer *w) {
    leaf_header *h = &w->header;
    h->value_min = (double)INFINITY;
    h->value_max = -(double)INFINITY;
    for (uint32_t set = 0; set < w->layout.sets; set++) {
        double range[2];
        merge_ranges(w, set);
        leaf_writer_range(w, set, range);
        h->value_min = fmin(h->value_min, range[0]);
        h->value_max = fmax(h->value_max, range[1]);
    }
}

/* Compute the header's values of a mesh, or curvilinear grid, from its treelets. */
static void sum_up_cells(leaf_writer *w) {
    leaf_header *h = &w->header;
    double lo = (double)INFINITY, hi = -(double)INFINITY;
    memcpy(h->bounds, w->bounds[0], sizeof h->bounds);
    for (uint32_t t = 0; t < w->layout.treelets && h->treelet_tets; t++)
        h->tets += w->counts[t][0];
    for (size_t i = 0; i < (size_t)w->layout.treelets * w->layout.places; i++)
        for (int a = 0; a < 3; a++) {
            h->bounds[a] = fminf(h->bounds[a], w->bounds[i][a]);
            h->bounds[a + 3] = fmaxf(h->bounds[a + 3], w->bounds[i][a + 3]);
        }
    for (size_t i = 0; i < (size_t)w->layout.treelets * w->layout.sets; i++) {
        memcpy(w->ranges[i], w->own[i], sizeof w->own[i]);
        lo = fmin(lo, (double)w->own[i][0]);
        hi = fmax(hi, (double)w->own[i][1]);
    }
    h->value_min = lo;
    h->value_max = hi;
}

static void note_facts(leaf_writer *w, const leaf_facts *facts) {
    leaf_header *h = &w->header;
    h->non_finite = facts->non_finite;
    h->rounding_error = facts->rounding_error;
    h->vertices = facts->vertices;
    h->flat = w->before ? w->before->header.flat : facts->flat;
    h->inverted = w->before ? w->before->header.inverted : facts->inverted;
    h->repeated = facts->repeated;
    h->bad = facts->bad;
    leaf_head_text(h->provenance, sizeof h->provenance, facts->provenance);
}

static status write_header(leaf_writer *w) {
    leaf_header *h = &w->header;
    hash_id id = leaf_header_id(h, w->table);
    h->id[0] = id.lo;
    h->id[1] = id.hi;
    h->checksum = leaf_header_checksum(h);
    status st =
        out_file_write_at(w->out, leaf_table_at(h), w->table, h->sections * sizeof *w->table);
    return st == ST_OK ? out_file_write_at(w->out, 0, h, sizeof *h) : st;
}

/* Compute what follows from all payloads, and put those of a mesh at their places. */
static status close_payloads(leaf_writer *w) {
    if (!w->counts) {
        end_payloads(w);
        sum_up_grid(w);
        return ST_OK;
    }
    const leaf_noded *noded = w->layout.geometry->noded;
    if (!noded || noded->listed)
        leaf_layout_set_counts(&w->layout, (const uint32_t(*)[4])w->counts);
    status st = make_copy_room(w);
    if (st == ST_OK)
        st = copy_payloads(w);
    sum_up_cells(w);
    return st;
}

static status write_all(leaf_writer *w, const leaf_facts *facts) {
    status st = close_payloads(w);
    note_facts(w, facts);
    if (st == ST_OK)
        st = leaf_writer_write_directory(w, w->next.end);
    return st == ST_OK ? write_header(w) : st;
}

status leaf_writer_settle(leaf_writer *w, const leaf_facts *facts) {
    assert(w->counts && !w->settled);
    w->settled = true;
    return write_all(w, facts);
}

const char *leaf_writer_path(const leaf_writer *w) {
    return out_file_temporary(w->out);
}

enum { EMBED_BYTES = 64 << 10 };

static status copy_file(leaf_writer *w, file *from, uint64_t to) {
    const uint64_t size = file_size(from);
    char *buffer = mem_alloc(w->m, EMBED_BYTES);
    if (!buffer)
        return ST_NOMEM;
    status st = ST_OK;
    for (uint64_t at = 0; at < size && st == ST_OK; at += EMBED_BYTES) {
        const size_t step = size - at < EMBED_BYTES ? (size_t)(size - at) : EMBED_BYTES;
        st = file_read_at(from, at, buffer, step);
        if (st == ST_OK)
            st = out_file_write_at(w->out, to + at, buffer, step);
    }
    mem_free(w->m, buffer);
    return st;
}

status leaf_writer_embed(leaf_writer *w, uint32_t set, const char *path) {
    assert(w->settled && w->parts && set < w->layout.sets && !w->parts[set].bytes);
    leaf_header *h = &w->header;
    leaf_header own;
    file *from = NULL;
    status st = file_open(w->m, path, &from);
    if (st == ST_OK)
        st = file_read_at(from, 0, &own, sizeof own);
    if (st == ST_OK)
        st = leaf_check_header(path, &own, file_size(from));
    if (st == ST_OK)
        st = copy_file(w, from, h->file_bytes);
    if (st == ST_OK) {
        assert(own.kind == LEAF_KIND_GRID || own.kind == h->kind);
        assert(own.run_align_log2 == h->run_align_log2);
        w->parts[set] = (leaf_part){
            .offset = h->file_bytes, .bytes = own.file_bytes, .id = {own.id[0], own.id[1]}};
        h->file_bytes += own.file_bytes;
    }
    file_close(from);
    return st;
}

/* Write the directory again, with the embedded coarse grids. */
static status write_parts(leaf_writer *w) {
    if (!w->parts)
        return ST_OK;
    status st = leaf_writer_write_parts(w);
    return st == ST_OK ? write_header(w) : st;
}

/* Read samples of some treelets where they lie, in another file: they are those that were put, if
 * the place is right and the file has not changed. */
static status prove_outside(leaf_file *f) {
    enum { SOME = 64 };
    const leaf_level *level = &f->layout.level[0];
    const uint32_t step = level->count / SOME + 1;
    leaf_unpacker *u = NULL;
    void *payload = mem_alloc(f->m, leaf_layout_payload_max(&f->layout));
    status st = payload ? leaf_unpacker_create(f->m, f, &u) : ST_NOMEM;
    for (uint32_t i = 0; i < level->count && st == ST_OK; i += step) {
        uint32_t t = level->first + i;
        while (t + 1 < level->first + level->count && !leaf_file_is_outside(f, t))
            t++;
        i = t - level->first;
        st = leaf_file_load(f, t, u, payload);
    }
    leaf_unpacker_destroy(u);
    mem_free(f->m, payload);
    return st;
}

/* Open a file that is about to get its name. So the reader opens all that the writer accepts. */
static status prove(leaf_writer *w) {
    leaf_file *f = NULL;
    status st = leaf_file_open_as(w->m, out_file_temporary(w->out), w->path, &f);
    if (st == ST_OK && f->samples)
        st = prove_outside(f);
    leaf_file_close(f);
    file_guard_forget(out_file_temporary(w->out));
    return st;
}

static status publish(leaf_writer *w) {
    status st = prove(w);
    if (st != ST_OK)
        return st;
    st = out_file_commit(w->out);
    w->out = NULL;
    return st;
}

status leaf_writer_finish(leaf_writer *w, const leaf_facts *facts, leaf_header *header) {
    status st = w->settled ? write_parts(w) : write_all(w, facts);
    if (st == ST_OK && header)
        *header = w->header;
    if (st == ST_OK)
        st = w->grow ? leaf_grow_publish(w->grow, out_file_temporary(w->out)) : publish(w);
    leaf_writer_discard(w);
    return st;
}
