/* hash.h - checksums (XXH3 64) and identities (XXH3 128). They detect accidents, not forgery. */
#ifndef FORMATS_BASE_HASH_H
#define FORMATS_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

uint64_t hash_bytes(const void *data, size_t size);

/* hash_stream_begin() - for bytes that come in pieces; NULL: no room. hash_stream_add() - take the
 * next. hash_stream_end() - returns the checksum of all, and frees the stream. */
typedef struct hash_stream hash_stream;
hash_stream *hash_stream_begin(void);
void hash_stream_add(hash_stream *s, const void *data, size_t size);
uint64_t hash_stream_end(hash_stream *s);

typedef struct hash_id {
    uint64_t lo, hi;
} hash_id;

hash_id hash_identity(const void *data, size_t size);

#endif
