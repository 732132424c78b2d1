#include "formats/base/hash.h"

#include <xxhash.h>

uint64_t hash_bytes(const void *data, size_t size) {
    return XXH3_64bits(data, size);
}

hash_id hash_identity(const void *data, size_t size) {
    XXH128_hash_t h = XXH3_128bits(data, size);
    return (hash_id){.lo = h.low64, .hi = h.high64};
}
