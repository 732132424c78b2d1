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

static status add_chunk(mesh_spool *s) {
    status st = mem_grow(s->m, &s->chunks, sizeof *s->chunks, s->chunk_count, 64, &s->chunk_room);
    if (st != ST_OK)
        return st;
    char *chunk = mem_alloc(s->m, CHUNK * s->element);
    if (!chunk)
        return ST_NOMEM;
    s->chunks[s->chunk_count++] = chunk;
    return ST_OK;
}

status mesh_spool_spill(mesh_spool *s) {
    if (s->file)
        return ST_OK;
    status st = out_file_scratch(s->m, s->beside, &s->file);
    uint64_t whole = s->count >> MESH_SPOOL_LOG2;
    for (uint64_t i = 0; st == ST_OK && i < whole; i++)
        st = out_file_append(s->file, s->chunks[i], CHUNK * s->element);
    if (st != ST_OK)
        return st;
    /* What is left over stays in one chunk: the buffer. */
    char *rest = s->chunk_count > whole ? s->chunks[whole] : NULL;
    if (rest)
        s->chunks[whole] = NULL;
    free_chunks(s);
    if (!rest)
        return ST_OK;
    s->chunks[0] = rest;
    s->chunk_count = 1;
    return ST_OK;
}

static bool is_full(const mesh_spool *s) {
    return s->ceiling && mem_used(s->m) + CHUNK * s->element > s->ceiling;
}

/* Room for one element more. */
static status make_room(mesh_spool *s) {
    if (!s->file && s->chunk_count > 0 && is_full(s)) {
        mesh_spool *out = s->first_out;
        if (!out || out->file || out->chunk_count == 0)
            out = s;
        status st = mesh_spool_spill(out);
        if (st != ST_OK)
            return st;
    }
    return s->file && s->chunk_count ? ST_OK : add_chunk(s);
}

static status append_some(mesh_spool *s, const char *from, size_t count) {
    size_t used = s->count & (CHUNK - 1);
    if (used == 0) {
        status st = make_room(s);
        if (st != ST_OK)
            return st;
    }
    char *chunk = s->chunks[s->file ? 0 : s->count >> MESH_SPOOL_LOG2];
    memcpy(chunk + used * s->element, from, count * s->element);
    s->count += count;
    if (s->file && used + count == CHUNK)
        return out_file_append(s->file, chunk, CHUNK * s->element);
    return ST_OK;
}

status mesh_spool_append(mesh_spool *s, const void *elements, size_t count) {
    const char *from = elements;
    while (count > 0) {
        size_t room = CHUNK - (s->count & (CHUNK - 1)), some = count < room ? count : room;
        status st = append_some(s, from, some);
        if (st != ST_OK)
            return st;
        from += some * s->element;
        count -= some;
    }
    return ST_OK;
}

status mesh_spool_end(mesh_spool *s) {
    size_t rest = s->count & (CHUNK - 1);
    if (!s->file)
        return ST_OK;
    status st = rest ? out_file_append(s->file, s->chunks[0], rest * s->element) : ST_OK;
    free_chunks(s);
    return st;
}

/* Of one that still grows, the last elements are in the buffer. */
static status read_file(mesh_spool *s, uint64_t first, size_t count, char *to) {
    const uint64_t written = s->chunk_count ? s->count & ~(uint64_t)(CHUNK - 1) : s->count;
    const uint64_t end = first + count < written ? first + count : written;
    status st = ST_OK;
    if (first < end) {
        const size_t some = (size_t)(end - first);
        st = out_file_read_at(s->file, first * s->element, to, some * s->element);
        first += some;
        count -= some;
        to += some * s->element;
    }
    if (st == ST_OK && count > 0)
        memcpy(to, s->chunks[0] + (first - written) * s->element, count * s->element);
    return st;
}

status mesh_spool_read(mesh_spool *s, uint64_t first, size_t count, void *to) {
    assert(first + count <= s->count);
    if (s->file)
        return read_file(s, first, count, to);
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
