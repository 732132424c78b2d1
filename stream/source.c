#include "stream/source.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "formats/base/block_runs.h"
#include "formats/base/bus_error.h"
#include "formats/base/fault.h"

#ifndef MADV_POPULATE_READ
/* Linux 5.14; older kernels answer EINVAL, and the checksum's reading faults the pages in. */
#define MADV_POPULATE_READ 22
#endif

enum { GIVE_BACK = 8 << 20, POPULATE_ATTEMPTS = 4 };

/* Payloads that lie so near to each other are read ahead together. */
enum { AHEAD_GAP = 4 << 10 };

/* How payloads with bytes in the file come and go. */
typedef struct backend {
    status (*load)(source *s, uint32_t p, leaf_unpacker *u, const void **payload);
    void (*evict)(source *s, uint32_t p, const void *payload);
} backend;

struct source {
    mem *m;
    leaf_file *file;
    const backend *backend;
    void *map; /* the whole file, or a part of one from a page's start; NULL: not mapped */
    size_t map_bytes;
    const uint8_t *bytes; /* byte 0 of the file, mapped or the caller's; NULL: neither */
    leaf_fetcher fetcher; /* copies stored bytes out of the mapping */
    _Atomic uint64_t copied;
    block_runs *blocks;    /* memory of our own */
    size_t page, overhead; /* source_overhead_bytes() */
};

/* ---- mapped ---- */

typedef struct page_range {
    uint8_t *first;
    size_t bytes;
} page_range;

/* The pages that hold bytes [from, from + bytes) of the file. */
static page_range pages_of(const source *s, uint64_t from, uint64_t bytes) {
    const uintptr_t at = (uintptr_t)s->bytes + from;
    const uintptr_t first = at / s->page * s->page;
    return (page_range){(uint8_t *)first, (size_t)(at + bytes - first)};
}

static int populate_pages(page_range r) {
    if (fault_hit(FAULT_PAGES))
        return EFAULT;
    return madvise(r.first, r.bytes, MADV_POPULATE_READ) == 0 ? 0 : errno;
}

/* EFAULT means that touching the pages would raise SIGBUS: the disk does not give them, or the file
 * has been cut. The mark tells of a cut, except of one that began in the tick of the clock in which
 * the file was opened and has been made good since: then another attempt finds pages, and the
 * checksum what is in them. Returns ST_OK to try again. */
static status populate_failed(const source *s, uint32_t p, uint64_t from, uint64_t bytes, int error,
                              int attempt) {
    const status st = error == EFAULT ? leaf_file_changed(s->file) : ST_OK;
    if (st != ST_OK || (error == EFAULT && attempt < POPULATE_ATTEMPTS))
        return st;
    return status_describe(ST_IO, "%s: payload %u: reading bytes %llu to %llu failed: %s",
                           file_path(s->file->source), p, (unsigned long long)from,
                           (unsigned long long)(from + bytes), strerror(error));
}

static status populate(source *s, uint32_t p, uint64_t from, uint64_t bytes) {
    const page_range r = pages_of(s, from, bytes);
    if (fault_hit(FAULT_READ))
        return status_describe(ST_IO, "%s: payload %u: reading its pages failed",
                               file_path(s->file->source), p);
    /* Request the whole range at once: populating page by page would wait for each. */
    (void)madvise(r.first, r.bytes, MADV_WILLNEED);
    int attempt = 0, error;
    while ((error = populate_pages(r)) != 0) {
        if (error == EINTR || error == EAGAIN)
            continue;
        if (error == EINVAL)
            break;
        const status st = populate_failed(s, p, from, bytes, error, ++attempt);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* Give all pages back after every GIVE_BACK bytes: giving back those of each payload took a fifth
 * of the time that a thread has for one. What another thread copies meanwhile comes from the page
 * cache again. */
static void give_back(source *s, size_t bytes) {
    const uint64_t before = atomic_fetch_add_explicit(&s->copied, bytes, memory_order_relaxed);
    if (before / GIVE_BACK != (before + bytes) / GIVE_BACK)
        (void)madvise(s->map, s->map_bytes, MADV_DONTNEED);
}

/* Copy bytes [from, from + bytes) of payload p out of the mapping. */
static status copy_mapped(source *s, uint32_t p, uint32_t from, size_t bytes, void *to) {
    const uint64_t at = s->file->offsets[p] + from;
    const status st = populate(s, p, at, bytes);
    if (st != ST_OK)
        return st;
    memcpy(to, s->bytes + at, bytes);
    give_back(s, bytes);
    return ST_OK;
}

/* Copy stored bytes, then check the copy: somebody may write to the file meanwhile. */
static status mapped_fetch(void *ctx, uint32_t p, void *stored) {
    source *s = ctx;
    const status st = copy_mapped(s, p, 0, (size_t)s->file->sizes[p], stored);
    return st == ST_OK ? leaf_file_check(s->file, p, stored) : st;
}

static status mapped_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    (void)u;
    const status st = populate(s, p, s->file->offsets[p], s->file->sizes[p]);
    *payload = s->bytes + s->file->offsets[p];
    return st == ST_OK ? leaf_file_check(s->file, p, *payload) : st;
}

static void mapped_evict(source *s, uint32_t p, const void *payload) {
    /* Give back only pages without a neighbour's bytes: a ray would have to fault a shared page in
     * again. */
    const uintptr_t from = ((uintptr_t)payload + s->page - 1) / s->page * s->page;
    const uintptr_t to = ((uintptr_t)payload + s->file->sizes[p]) / s->page * s->page;
    if (to > from)
        (void)madvise((void *)from, (size_t)(to - from), MADV_DONTNEED);
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

/* ---- memory of our own ---- */

static void own_evict(source *s, uint32_t p, const void *payload) {
    block_runs_free(s->blocks, (void *)(uintptr_t)payload,
                    leaf_layout_payload_bytes(&s->file->layout, p));
}

static status own_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    void *block = block_runs_alloc(s->blocks, leaf_layout_payload_bytes(&s->file->layout, p));
    if (!block)
        return ST_NOMEM;
    const status st = source_load_into(s, p, u, block);
    if (st != ST_OK) {
        own_evict(s, p, block);
        return st;
    }
    *payload = block;
    return ST_OK;
}

status source_load_after(source *s, uint32_t p, leaf_unpacker *u, uint32_t q, const void *from,
                         const void **payload) {
    const size_t bytes = leaf_layout_payload_bytes(&s->file->layout, p);
    void *block = block_runs_alloc(s->blocks, bytes);
    if (!block)
        return ST_NOMEM;
    memcpy(block, from, bytes);
    const status st =
        leaf_file_load_after(s->file, p, u, s->fetcher.fetch ? &s->fetcher : NULL, q, block);
    if (st != ST_OK) {
        own_evict(s, p, block);
        return st;
    }
    *payload = block;
    return ST_OK;
}

static const backend own_backend = {own_load, own_evict};

/* ---- all ---- */

/* What has no bytes in the file is made in memory of our own. */
static const backend *backend_of(const source *s, uint32_t p) {
    return leaf_file_has_bytes(s->file, p) ? s->backend : &own_backend;
}

/* Map the file, or the pages that hold this part of one. */
static status map_file(source *s) {
    const leaf_file *f = s->file;
    const uint64_t before = file_offset(f->source) % s->page;
    const size_t bytes = (size_t)(file_size(f->source) + before);
    file_mark_settle(&f->mark);
    void *map = mmap(NULL, bytes, PROT_READ, MAP_SHARED, file_descriptor(f->source),
                     (off_t)(file_offset(f->source) - before));
    if (map == MAP_FAILED)
        return status_describe(errno == ENOMEM ? ST_NOMEM : ST_IO, "%s: cannot be mapped: %s",
                               file_path(f->source), strerror(errno));
    (void)madvise(map, bytes, MADV_RANDOM);
    s->map = map;
    s->map_bytes = bytes;
    s->bytes = (const uint8_t *)map + before;
    return ST_OK;
}

/* Whether payloads may be used where the file's bytes are. They are aligned within the file, so
 * they are aligned in memory if the file's bytes are. */
static bool usable_in_place(const leaf_file *f, const void *bytes) {
    return f->header.codec == LEAF_CODEC_RAW && !leaf_file_holds_indices(f) &&
           (uintptr_t)bytes % LEAF_ALIGN == 0;
}

static status begin_mapped(source *s) {
    const status st = map_file(s);
    if (st != ST_OK)
        return st;
    s->fetcher = (leaf_fetcher){mapped_fetch, s};
    if (!usable_in_place(s->file, s->bytes))
        return ST_OK;
    s->backend = &mapped_backend;
    s->overhead = 2 * s->page; /* rounded to pages on both sides */
    return ST_OK;
}

static void begin_memory(source *s) {
    const void *bytes = file_memory(s->file->source);
    if (!usable_in_place(s->file, bytes))
        return;
    s->bytes = bytes;
    s->backend = &memory_backend;
}

/* Whether to map without being asked: a program that embeds the library would be ended by SIGBUS if
 * the file were cut short, and within a budget the kernel takes mapped pages back. */
static bool may_map(const source *s) {
    return bus_error_installed() && !s->m->limit;
}

status source_open(mem *m, leaf_file *f, source_kind kind, source **out) {
    source *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->file = f;
    s->page = (size_t)sysconf(_SC_PAGESIZE);
    s->overhead = 128;
    s->backend = &own_backend;
    status st = ST_OK;
    if (file_memory(f->source) && kind != SOURCE_ARENA)
        begin_memory(s);
    else if (kind == SOURCE_MAPPED)
        st = begin_mapped(s);
    else if (kind == SOURCE_AUTO && may_map(s) && usable_in_place(f, NULL))
        (void)begin_mapped(s); /* or the arena, as where address space is limited */
    if (st == ST_OK)
        st = block_runs_create(m, leaf_layout_payload_max(&f->layout), f->layout.treelets,
                               &s->blocks);
    if (st != ST_OK) {
        source_close(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

status source_extend(source *s, source_move *move) {
    const leaf_file *f = s->file;
    *move = (source_move){0};
    if (!s->map)
        return ST_OK;
    const size_t bytes = (size_t)file_size(f->source);
    assert(file_offset(f->source) == 0);
    file_mark_settle(&f->mark);
    void *map = mremap(s->map, s->map_bytes, bytes, MREMAP_MAYMOVE);
    if (map == MAP_FAILED)
        return status_describe(errno == ENOMEM ? ST_NOMEM : ST_IO, "%s: cannot be mapped: %s",
                               file_path(f->source), strerror(errno));
    (void)madvise(map, bytes, MADV_RANDOM);
    *move = (source_move){(uintptr_t)s->map, s->map_bytes, (uint8_t *)map - (uint8_t *)s->map};
    s->map = map;
    s->map_bytes = bytes;
    s->bytes = map;
    return ST_OK;
}

void source_close(source *s) {
    if (!s)
        return;
    if (s->map)
        (void)munmap(s->map, s->map_bytes);
    block_runs_destroy(s->blocks);
    mem_free(s->m, s);
}

status source_load(source *s, uint32_t p, leaf_unpacker *u, const void **payload) {
    return backend_of(s, p)->load(s, p, u, payload);
}

void source_evict(source *s, uint32_t p, const void *payload) {
    backend_of(s, p)->evict(s, p, payload);
}

status source_load_into(source *s, uint32_t p, leaf_unpacker *u, void *payload) {
    return leaf_file_load_by(s->file, p, u, s->fetcher.fetch ? &s->fetcher : NULL, payload);
}

status source_read(source *s, uint32_t p, uint32_t from, uint32_t bytes, void *to) {
    return s->map ? copy_mapped(s, p, from, bytes, to)
                  : file_read_at(s->file->source, s->file->offsets[p] + from, to, bytes);
}

/* Sort payloads by their place in the file. There are few. */
static void sort_by_place(const leaf_file *f, uint32_t payloads[], uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        const uint32_t p = payloads[i];
        uint32_t at = i;
        for (; at > 0 && f->offsets[payloads[at - 1]] > f->offsets[p]; at--)
            payloads[at] = payloads[at - 1];
        payloads[at] = p;
    }
}

void source_ahead(source *s, uint32_t payloads[], uint32_t count) {
    const leaf_file *f = leaf_file_stores(s->file);
    const int fd = file_descriptor(f->source);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++)
        if (leaf_file_has_bytes(f, payloads[i]))
            payloads[kept++] = payloads[i];
    sort_by_place(f, payloads, kept);
    for (uint32_t i = 0; fd >= 0 && i < kept;) {
        const uint64_t from = f->offsets[payloads[i]];
        uint64_t to = from;
        for (; i < kept && f->offsets[payloads[i]] <= to + AHEAD_GAP; i++)
            to = f->offsets[payloads[i]] + f->sizes[payloads[i]];
        (void)posix_fadvise(fd, (off_t)(file_offset(f->source) + from), (off_t)(to - from),
                            POSIX_FADV_WILLNEED);
    }
}

size_t source_overhead_bytes(const source *s) {
    return s->overhead;
}
