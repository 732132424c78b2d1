#include "formats/base/mem.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "formats/base/fault.h"
#include "formats/base/status.h"

/* The cache line before each block holds its size, so that the block itself stays aligned. */
enum { LINE = 64 };

/* Blocks from this size on are mappings of their own, in large pages where the system has them. The
 * allocator gave the planes of each picture back to the system, and took them again page by page:
 * a tenth of the time of a picture that changes with a time step. */
enum { MAPPED_FROM = MEM_LARGE_PAGE };

/* The address sanitizer sees what is read behind the end of the allocator's blocks alone. */
#ifdef __SANITIZE_ADDRESS__
enum { WATCHED = 1 };
#else
enum { WATCHED = 0 };
#endif

void mem_init(mem *m, size_t limit) {
    atomic_init(&m->used, 0);
    atomic_init(&m->peak, 0);
    m->limit = limit;
    m->lent = 0;
    m->target = NULL;
}

static void *refuse(const mem *m, size_t size) {
    if (m->limit)
        (void)status_describe(
            ST_NOMEM, "no room for %zu bytes: %zu of the memory budget of %zu bytes are in use%s",
            size, atomic_load(&m->used) + m->lent, m->limit + m->lent,
            m->lent ? ", by an importer, too" : "");
    else
        (void)status_describe(ST_NOMEM, "no room for %zu bytes: the system has no memory left",
                              size);
    return NULL;
}

/* Count bytes as in use; false: the budget has no room for them. *used: all that then are. */
static bool count(mem *m, size_t bytes, size_t *used) {
    *used = atomic_fetch_add(&m->used, bytes) + bytes;
    if (!m->limit || *used <= m->limit)
        return true;
    atomic_fetch_sub(&m->used, bytes);
    return false;
}

static void raise_peak(mem *m, size_t used) {
    size_t peak = atomic_load(&m->peak);
    while (used > peak && !atomic_compare_exchange_weak(&m->peak, &peak, used)) {}
}

static bool is_mapped(size_t total) {
    return !WATCHED && total >= MAPPED_FROM;
}

void *mem_map(size_t bytes) {
    if (bytes > SIZE_MAX - MEM_LARGE_PAGE)
        return NULL;
    const size_t wanted = bytes + MEM_LARGE_PAGE;
    char *map = mmap(NULL, wanted, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (map == MAP_FAILED)
        return NULL;
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    const size_t before = (MEM_LARGE_PAGE - (uintptr_t)map % MEM_LARGE_PAGE) % MEM_LARGE_PAGE;
    const size_t end = before + (bytes + page - 1) / page * page;
    if (before > 0)
        (void)munmap(map, before);
    if (end < wanted)
        (void)munmap(map + end, wanted - end);
    /* Small pages do as well where the system has no large ones. */
    (void)madvise(map + before, bytes, MADV_HUGEPAGE);
    return map + before;
}

/* How much memory a block of `size` bytes takes. */
static size_t total_of(size_t size) {
    return (size + 2 * LINE - 1) / LINE * LINE;
}

void *mem_alloc(mem *m, size_t size) {
    if (size > SIZE_MAX - 2 * LINE || fault_hit(FAULT_ALLOC))
        return refuse(m, size);
    const size_t total = total_of(size);
    size_t used;
    if (!count(m, total, &used))
        return refuse(m, size);
    char *line = is_mapped(total) ? mem_map(total) : aligned_alloc(LINE, total);
    if (!line) {
        atomic_fetch_sub(&m->used, total);
        return refuse(m, size);
    }
    raise_peak(m, used);
    memcpy(line, &total, sizeof total);
    return line + LINE;
}

void *mem_zalloc(mem *m, size_t size) {
    void *block = mem_alloc(m, size);
    if (block && !is_mapped(total_of(size)))
        memset(block, 0, size);
    return block;
}

void *mem_array(mem *m, size_t count, size_t size) {
    size_t bytes = 0;
    if (__builtin_mul_overflow(count, size, &bytes))
        return refuse(m, SIZE_MAX);
    return mem_zalloc(m, bytes ? bytes : 1);
}

status mem_grow(mem *m, void *array, size_t size, size_t count, size_t least, size_t *room) {
    if (count < *room)
        return ST_OK;
    const size_t more = *room ? 2 * *room : least;
    void *old, *larger = mem_array(m, more, size);
    if (!larger)
        return ST_NOMEM;
    memcpy(&old, array, sizeof old);
    if (count > 0)
        memcpy(larger, old, count * size);
    mem_free(m, old);
    memcpy(array, &larger, sizeof larger);
    *room = more;
    return ST_OK;
}

char *mem_copy_text(mem *m, const char *text) {
    size_t size = strlen(text) + 1;
    char *copy = mem_alloc(m, size);
    if (copy)
        memcpy(copy, text, size);
    return copy;
}

void mem_free(mem *m, void *block) {
    if (!block)
        return;
    char *line = (char *)block - LINE;
    size_t total = 0;
    memcpy(&total, line, sizeof total);
    atomic_fetch_sub(&m->used, total);
    if (is_mapped(total))
        (void)munmap(line, total);
    else
        free(line);
}

void *mem_zlib_alloc(void *m, unsigned count, unsigned size) {
    return mem_array(m, count, size);
}

void mem_zlib_free(void *m, void *block) {
    mem_free(m, block);
}

bool mem_reserve(mem *m, size_t bytes) {
    size_t used;
    if (!count(m, bytes, &used)) {
        (void)refuse(m, bytes);
        return false;
    }
    raise_peak(m, used);
    return true;
}

void mem_unreserve(mem *m, size_t bytes) {
    atomic_fetch_sub(&m->used, bytes);
}

size_t mem_lend_half(mem *m) {
    const size_t used = mem_used(m), half = m->limit / 2;
    const size_t left = used < m->limit ? m->limit - used : 0, most = left - left / 4;
    const size_t lent = half < most ? half : most;
    m->limit -= lent;
    m->lent += lent;
    return lent;
}

void mem_take_back(mem *m, size_t lent) {
    m->limit += lent;
    m->lent -= lent;
}

size_t mem_used(const mem *m) {
    return atomic_load(&m->used);
}

size_t mem_peak(const mem *m) {
    return atomic_load(&m->peak);
}

bool mem_room(size_t bytes) {
    void *some = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (some == MAP_FAILED)
        return false;
    munmap(some, bytes);
    return true;
}
