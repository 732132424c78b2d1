#include "stream/source.h"

#include <errno.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "formats/base/fault.h"

#ifndef MADV_POPULATE_READ
/* Linux 5.14; older kernels answer EINVAL, and the checksum's reading faults the pages in. */
#define MADV_POPULATE_READ 22
#endif

typedef struct backend {
    status (*load)(source *s, uint32_t p, leaf_unpacker *u, const void **payload);
    void (*evict)(source *s, uint32_t p, const void *payload);
} backend;

struct source {
    mem *m;
    leaf_file *file;
    source_kind kind;
    const backend *backend; /* for payloads with bytes in the file */
    uint8_t *map;           /* mapped: the whole file */
    const uint8_t *bytes;   /* in place: the whole file, the caller's */
    size_t page;
};

/* ---- mapped ---- */

static status mapped_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    (void)u;
    const uint64_t from = s->file->offsets[p], to = from + s->file->sizes[p];
    const uint64_t first = from / s->page * s->page;
    if (fault_hit(FAULT_READ))
        return status_describe(ST_IO, "%s: payload %u: reading its pages failed",
                               file_path(s->file->source), p);
    /* Request the whole range at once: populating page by page would wait for each. */
    (void)madvise(s->map + first, (size_t)(to - first), MADV_WILLNEED);
    while (madvise(s->map + first, (size_t)(to - first), MADV_POPULATE_READ) != 0) {
        if (errno == EINTR || errno == EAGAIN)
            continue;
        if (errno == EINVAL)
            break;
        return status_describe(ST_IO, "%s: payload %u: reading bytes %llu to %llu failed: %s",
                               file_path(s->file->source), p, (unsigned long long)from,
                               (unsigned long long)to, strerror(errno));
    }
    *payload = s->map + from;
    return leaf_file_check(s->file, p, *payload);
}

static void mapped_evict(source *s, uint32_t p, const void *payload) {
    (void)payload;
    /* Give back only pages without a neighbour's bytes: a ray would have to fault a shared page in
     * again. */
    const uint64_t from = (s->file->offsets[p] + s->page - 1) / s->page * s->page;
    const uint64_t to = (s->file->offsets[p] + s->file->sizes[p]) / s->page * s->page;
    if (to > from)
        (void)madvise(s->map + from, (size_t)(to - from), MADV_DONTNEED);
}

static const backend mapped_backend = {mapped_load, mapped_evict};

/* ---- in place: bytes that are in memory already ---- */

static status memory_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    (void)u;
    *payload = s->bytes + s->file->offsets[p];
    return leaf_file_check(s->file, p, *payload);
}

static void memory_evict(source *s, uint32_t p, const void *payload) {
    (void)s, (void)p, (void)payload;
}

static const backend memory_backend = {memory_load, memory_evict};

/* ---- arena ---- */

static status arena_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    void *block = mem_alloc(s->m, leaf_layout_payload_bytes(&s->file->layout, p));
    if (!block)
        return ST_NOMEM;
    status st = leaf_file_load(s->file, p, u, block);
    if (st != ST_OK) {
        mem_free(s->m, block);
        return st;
    }
    *payload = block;
    return ST_OK;
}

static void arena_evict(source *s, uint32_t p, const void *payload) {
    (void)p;
    mem_free(s->m, (void *)(uintptr_t)payload);
}

static const backend arena_backend = {arena_load, arena_evict};

/* ---- all ---- */

/* What has no bytes in the file is made in the arena. */
static const backend *backend_of(const source *s, uint32_t p) {
    return leaf_file_has_bytes(s->file, p) ? s->backend : &arena_backend;
}

static status map_file(source *s) {
    const leaf_file *f = s->file;
    const char *path = file_path(f->source);
    if (file_offset(f->source))
        return status_describe(ST_UNSUPPORTED, "%s: a part of a file cannot be mapped", path);
    file_mark_settle(&f->mark);
    void *map = mmap(NULL, (size_t)file_size(f->source), PROT_READ, MAP_SHARED,
                     file_descriptor(f->source), 0);
    if (map == MAP_FAILED)
        return status_describe(errno == ENOMEM ? ST_NOMEM : ST_IO, "%s: cannot be mapped: %s", path,
                               strerror(errno));
    (void)madvise(map, (size_t)file_size(f->source), MADV_RANDOM);
    s->map = map;
    s->backend = &mapped_backend;
    return ST_OK;
}

/* Payloads are aligned within the file, so they are aligned in memory if the file's bytes are. */
static status use_bytes(source *s, const uint8_t *bytes) {
    s->kind = SOURCE_ARENA; /* nothing is rounded to pages */
    if ((uintptr_t)bytes % LEAF_ALIGN)
        return ST_OK;
    s->bytes = bytes;
    s->backend = &memory_backend;
    return ST_OK;
}

/* Use payloads in place, in memory or mapped, if their format allows it. */
static status use_in_place(source *s) {
    const leaf_file *f = s->file;
    if (f->header.codec != LEAF_CODEC_RAW)
        return status_describe(ST_UNSUPPORTED,
                               "%s: compressed payloads cannot be mapped: use the arena backend",
                               file_path(f->source));
    if (leaf_file_holds_indices(f)) {
        s->kind = SOURCE_ARENA;
        return ST_OK;
    }
    const uint8_t *bytes = file_memory(f->source);
    return bytes ? use_bytes(s, bytes) : map_file(s);
}

/* Returns the arena (stream/README.md says why), unless raw payloads are in memory already. */
static source_kind best_kind(const leaf_file *f) {
    const bool here = file_memory(f->source) && f->header.codec == LEAF_CODEC_RAW;
    return here ? SOURCE_MAPPED : SOURCE_ARENA;
}

status source_open(mem *m, leaf_file *f, source_kind kind, source **out) {
    source *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->file = f;
    s->kind = kind == SOURCE_AUTO ? best_kind(f) : kind;
    s->page = (size_t)sysconf(_SC_PAGESIZE);
    s->backend = &arena_backend;
    const status st = s->kind == SOURCE_MAPPED ? use_in_place(s) : ST_OK;
    if (st != ST_OK) {
        mem_free(m, s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void source_close(source *s) {
    if (!s)
        return;
    if (s->map)
        (void)munmap(s->map, (size_t)file_size(s->file->source));
    mem_free(s->m, s);
}

status source_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    return backend_of(s, p)->load(s, p, u, payload);
}

void source_evict(source *s, uint32_t p, const void *payload) {
    backend_of(s, p)->evict(s, p, payload);
}

status source_read(source *s, uint32_t p, uint32_t from, uint32_t bytes, void *to) {
    return file_read_at(s->file->source, s->file->offsets[p] + from, to, bytes);
}

size_t source_overhead_bytes(const source *s) {
    /* The mapped backend rounds to pages on both sides. */
    return s->kind == SOURCE_MAPPED ? 2 * s->page : 128;
}
