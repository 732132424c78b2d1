/* vdb_new.cpp - operator new that counts; see vdb_memory.h. */
#include <cstdlib>
#include <new>

#include <malloc.h>

#include "prep/import/vdb/vdb_memory.h"

namespace {

void *counted(void *block) {
    if (!block)
        throw std::bad_alloc();
    if (!vdb_memory_take(malloc_usable_size(block))) {
        free(block);
        throw std::bad_alloc();
    }
    return block;
}

void release(void *block) {
    if (!block)
        return;
    vdb_memory_give(malloc_usable_size(block));
    free(block);
}

/* Do not even try sizes beyond the budget: a broken file may ask for any. */
void *take(std::size_t size) {
    if (!vdb_memory_take(size))
        throw std::bad_alloc();
    vdb_memory_give(size);
    return counted(malloc(size ? size : 1));
}

} // namespace

void *operator new(std::size_t size) {
    return take(size);
}
void *operator new[](std::size_t size) {
    return take(size);
}
void *operator new(std::size_t size, std::align_val_t align) {
    const std::size_t a = static_cast<std::size_t>(align);
    return counted(aligned_alloc(a, (size + a - 1) / a * a));
}
void *operator new[](std::size_t size, std::align_val_t align) {
    return operator new(size, align);
}
void operator delete(void *block) noexcept {
    release(block);
}
void operator delete[](void *block) noexcept {
    release(block);
}
void operator delete(void *block, std::size_t) noexcept {
    release(block);
}
void operator delete[](void *block, std::size_t) noexcept {
    release(block);
}
void operator delete(void *block, std::align_val_t) noexcept {
    release(block);
}
void operator delete[](void *block, std::align_val_t) noexcept {
    release(block);
}
void operator delete(void *block, std::size_t, std::align_val_t) noexcept {
    release(block);
}
void operator delete[](void *block, std::size_t, std::align_val_t) noexcept {
    release(block);
}
