/* hash.h - checksums (XXH3 64) and identities (XXH3 128). They detect accidents, not forgery. */
#ifndef FORMATS_BASE_HASH_H
#define FORMATS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

uint64_t hash_bytes(const void *data, size_t size);

typedef struct hash_id {
    uint64_t lo, hi;
} hash_id;

hash_id hash_identity(const void *data, size_t size);

#endif
