/* import_malloc.c - wraps the C library's allocator under the same names, to note refused blocks.
 *
 * Libraries report a lack of memory in many ways: some as malformed input, some not at all. What
 * they were refused is kept by import_limits.h, for error messages. It is linked into importers
 * alone, and not if sanitizers have an allocator of their own.
 */
#include <errno.h>
#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include "prep/import/import_limits.h"

#ifdef __GLIBC__

#define PUBLIC __attribute__((visibility("default")))

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *block);

static void *noted(void *block, size_t size) {
    if (!block && size)
        import_limits_refused(size);
    return block;
}

PUBLIC void *malloc(size_t size) {
    return noted(__libc_malloc(size), size);
}

PUBLIC void *calloc(size_t count, size_t size) {
    size_t all;
    const bool fits = !__builtin_mul_overflow(count, size, &all);
    return noted(__libc_calloc(count, size), fits ? all : SIZE_MAX);
}

PUBLIC void *realloc(void *block, size_t size) {
    return noted(__libc_realloc(block, size), size);
}

PUBLIC void *reallocarray(void *block, size_t count, size_t size) {
    size_t all;
    if (!__builtin_mul_overflow(count, size, &all))
        return realloc(block, all);
    errno = ENOMEM;
    return NULL;
}

PUBLIC void *memalign(size_t alignment, size_t size) {
    return noted(__libc_memalign(alignment, size), size);
}

PUBLIC void *aligned_alloc(size_t alignment, size_t size) {
    return memalign(alignment, size);
}

PUBLIC int posix_memalign(void **out, size_t alignment, size_t size) {
    if (alignment % sizeof(void *) || (alignment & (alignment - 1)) || !alignment)
        return EINVAL;
    void *block = memalign(alignment, size);
    if (!block)
        return ENOMEM;
    *out = block;
    return 0;
}

PUBLIC void *valloc(size_t size) {
    return memalign((size_t)sysconf(_SC_PAGESIZE), size);
}

PUBLIC void *pvalloc(size_t size) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    return memalign(page, (size + page - 1) / page * page);
}

PUBLIC void free(void *block) {
    __libc_free(block);
}

#endif
