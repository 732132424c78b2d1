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
    s->file = NULL;
    s->count = 0;
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

static status write_chunk(mesh_spool *s, uint64_t i) {
    const uint64_t first = i << MESH_SPOOL_LOG2, left = s->count - first;
    const size_t some = left < CHUNK ? (size_t)left : CHUNK;
    return s->chunks[i]
               ? out_file_write_at(s->file, first * s->element, s->chunks[i], some * s->element)
               : ST_OK;
}

status mesh_spool_spill(mesh_spool *s) {
    if (s->file)
        return ST_OK;
    status st = out_file_scratch(s->m, s->beside, &s->file);
    for (uint64_t i = 0; st == ST_OK && i < s->chunk_count; i++)
        st = write_chunk(s, i);
    free_chunks(s);
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
