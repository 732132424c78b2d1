#include "prep/mesh/mesh_spool.h"

#include <assert.h>
#include <string.h>

enum { CHUNK = 1 << MESH_SPOOL_LOG2 };

void mesh_spool_init(mesh_spool *s, mem *m, const char *beside, size_t element, size_t ceiling) {
    *s = (mesh_spool){.m = m, .beside = beside, .element = element, .ceiling = ceiling};
}

static void free_chunks(mesh_spool *s) {
    for (size_t i = 0; i < s->chunk_count; i++)
        mem_free(s->m, s->chunks[i]);
    s->chunk_count = 0;
}

void mesh_spool_release(mesh_spool *s) {
    free_chunks(s);
    mem_free(s->m, s->chunks);
    s->chunks = NULL;
    s->chunk_room = 0;
    out_file_discard(s->file);
    out_file_discard(s->copy);
    s->file = s->copy = NULL;
    s->count = s->copied = 0;
}

size_t mesh_spool_buffers(size_t element) {
    return CHUNK * element + 4096;
}

/* Add chunk i. Chunks before it may be missing. */
static status add_chunk(mesh_spool *s, uint64_t i) {
    while (s->chunk_count <= i) {
        status st =
            mem_grow(s->m, &s->chunks, sizeof *s->chunks, s->chunk_count, 64, &s->chunk_room);
        if (st != ST_OK)
            return st;
        s->chunks[s->chunk_count++] = NULL;
    }
    s->chunks[i] = mem_zalloc(s->m, CHUNK * s->element);
    return s->chunks[i] ? ST_OK : ST_NOMEM;
}

/* Open the file. What it holds beyond the elements that are copied is cut off, as gaps must read as
 * zeros. */
static status open_copy(mesh_spool *s) {
    if (s->copy)
        return ST_OK;
    if (!s->work)
        return out_file_scratch(s->m, s->beside, &s->copy);
    status st = work_folder_file(s->work, s->which, true, &s->copy);
    return st == ST_OK ? out_file_cut(s->copy, s->copied * s->element) : st;
}

/* The number of elements from `first` on that lie in its chunk, below `count`. */
static size_t some_of(uint64_t first, uint64_t count) {
    const uint64_t room = CHUNK - (first & (CHUNK - 1));
    return (size_t)(count - first < room ? count - first : room);
}

/* Write the elements that are not in the file. */
static status copy_rest(mesh_spool *s) {
    status st = open_copy(s);
    while (st == ST_OK && s->copied < s->count) {
        const size_t some = some_of(s->copied, s->count);
        const char *chunk = s->chunks[s->copied >> MESH_SPOOL_LOG2];
        st = progress_ask(s->p, "writing");
        if (st == ST_OK && chunk)
            st = out_file_write_at(s->copy, s->copied * s->element,
                                   chunk + (s->copied & (CHUNK - 1)) * s->element,
                                   some * s->element);
        s->copied += st == ST_OK ? some : 0;
    }
    return st;
}

/* From now on all is in the file alone. */
static void leave_memory(mesh_spool *s) {
    s->file = s->copy;
    s->copy = NULL;
    free_chunks(s);
}

status mesh_spool_spill(mesh_spool *s) {
    if (s->file)
        return ST_OK;
    status st = copy_rest(s);
    if (st == ST_OK)
        leave_memory(s);
    return st;
}

static bool is_full(const mesh_spool *s) {
    return s->ceiling && mem_used(s->m) + CHUNK * s->element > s->ceiling;
}

/* Make room for chunk i, or go to a file. */
static status make_room(mesh_spool *s, uint64_t i) {
    if (s->file || (i < s->chunk_count && s->chunks[i]))
        return ST_OK;
    if (s->chunk_count > 0 && is_full(s)) {
        mesh_spool *out = s->first_out;
        if (!out || out->file || out->chunk_count == 0)
            out = s;
        status st = mesh_spool_spill(out);
        if (st != ST_OK || out == s)
            return st;
    }
    return add_chunk(s, i);
}

/* Put elements of one chunk, or any number if the spool is in a file. */
static status put_some(mesh_spool *s, uint64_t at, const char *from, size_t count) {
    status st = make_room(s, at >> MESH_SPOOL_LOG2);
    if (st != ST_OK)
        return st;
    if (s->file)
        st = out_file_write_at(s->file, at * s->element, from, count * s->element);
    else
        memcpy(s->chunks[at >> MESH_SPOOL_LOG2] + (at & (CHUNK - 1)) * s->element, from,
               count * s->element);
    s->count = at + count > s->count ? at + count : s->count;
    return st;
}

status mesh_spool_put(mesh_spool *s, uint64_t at, const void *elements, size_t count) {
    const char *from = elements;
    while (count > 0) {
        const size_t room = CHUNK - (at & (CHUNK - 1)), some = count < room ? count : room;
        status st = put_some(s, at, from, some);
        if (st != ST_OK)
            return st;
        from += some * s->element;
        at += some;
        count -= some;
    }
    return ST_OK;
}

status mesh_spool_append(mesh_spool *s, const void *elements, size_t count) {
    return mesh_spool_put(s, s->count, elements, count);
}

status mesh_spool_read(mesh_spool *s, uint64_t first, size_t count, void *to) {
    assert(first + count <= s->count);
    if (s->file)
        return out_file_read_at(s->file, first * s->element, to, count * s->element);
    char *at = to;
    while (count > 0) {
        size_t room = CHUNK - (first & (CHUNK - 1)), some = count < room ? count : room;
        memcpy(at, mesh_spool_at(s, first), some * s->element);
        at += some * s->element;
        first += some;
        count -= some;
    }
    return ST_OK;
}

void mesh_spool_forget(mesh_spool *s, uint64_t before) {
    if (s->file)
        return;
    for (uint64_t i = before >> MESH_SPOOL_LOG2; i-- > 0 && s->chunks[i];) {
        mem_free(s->m, s->chunks[i]);
        s->chunks[i] = NULL;
    }
}

/* ---- for another run ---- */

void mesh_spool_keep_in(mesh_spool *s, work_folder *work, work_file which) {
    assert(s->count == 0 && !s->file);
    s->work = work;
    s->which = which;
}

status mesh_spool_store(mesh_spool *s) {
    return s->file || s->count == 0 ? ST_OK : copy_rest(s);
}

void mesh_spool_unstore(mesh_spool *s) {
    if (!s->copy)
        return;
    (void)!out_file_cut(s->copy, 0);
    out_file_discard(s->copy);
    s->copy = NULL;
    s->copied = 0;
}

out_file *mesh_spool_file(const mesh_spool *s) {
    return s->file ? s->file : s->copy;
}

/* Read elements up to `count` from the file into memory, as far as there is room. */
static status fetch(mesh_spool *s, uint64_t count) {
    status st = ST_OK;
    while (st == ST_OK && s->count < count && !(s->chunk_count > 0 && is_full(s))) {
        const uint64_t chunk = s->count >> MESH_SPOOL_LOG2;
        const size_t some = some_of(s->count, count);
        st = progress_ask(s->p, "reading");
        if (st == ST_OK)
            st = add_chunk(s, chunk);
        if (st == ST_OK)
            st = out_file_read_at(s->copy, s->count * s->element, s->chunks[chunk],
                                  some * s->element);
        s->count += some;
    }
    return st;
}

static status load(mesh_spool *s, uint64_t count, bool held, state_io *io) {
    assert(s->count == 0 && !mesh_spool_file(s));
    if (count == 0)
        return ST_OK;
    if (!s->work) /* such a mesh has none of these */
        return state_io_fault(io);
    status st = work_folder_file(s->work, s->which, true, &s->copy);
    if (st != ST_OK)
        return st;
    if (out_file_size(s->copy) / s->element < count)
        return state_io_fault(io);
    st = out_file_cut(s->copy, count * s->element);
    if (st == ST_OK && held)
        st = fetch(s, count);
    if (st == ST_OK && s->count < count)
        leave_memory(s);
    s->count = s->copied = count;
    return st;
}

status mesh_spool_keep(mesh_spool *s, state_io *io) {
    uint64_t count = s->count;
    uint32_t held = !s->file;
    status st = STATE_IO(io, count);
    if (st == ST_OK)
        st = STATE_IO(io, held);
    return st == ST_OK && state_io_loads(io) ? load(s, count, held, io) : st;
}
