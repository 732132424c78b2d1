/* coded_payload.h - what coders (leaf_coder.h) do alike: the first byte of the streams, and
 * payloads that are stored as they are. */
#ifndef FORMATS_LEAF_CODED_PAYLOAD_H
#define FORMATS_LEAF_CODED_PAYLOAD_H

#include <stdbool.h>
#include <string.h>

#include "formats/leaf/coded_streams.h"

/* The first byte. Written to files: never renumber. A kind may have further ones. */
enum { CODED_STORED = 0, CODED_STREAMS = 1 };

/* coded_payload_begin() - begin with this first byte. out: its bytes and its room are set.
 * coded_payload_store() - fill in all streams of a payload that is stored.
 * coded_payload_stored() - read it. False: it is not as long. */
static inline void coded_payload_begin(uint8_t first, coded_streams *out) {
    *out = (coded_streams){.bytes = out->bytes, .room = out->room};
    *coded_streams_take(out, 1) = first;
}
static inline void coded_payload_store(const void *payload, size_t bytes, coded_streams *out) {
    coded_payload_begin(CODED_STORED, out);
    memcpy(coded_streams_take(out, bytes), payload, bytes);
    coded_streams_end(out);
}
static inline bool coded_payload_stored(coded_input *in, void *payload, size_t bytes) {
    const uint8_t *stored = coded_input_take(in, bytes);
    if (!stored || in->left)
        return false;
    memcpy(payload, stored, bytes);
    return true;
}

/* coded_payload_is_zero() - whether bytes from .. end - 1 are. Payloads that are made from streams
 * have such padding. */
static inline bool coded_payload_is_zero(const void *payload, size_t from, size_t end) {
    const uint8_t *bytes = payload;
    for (size_t i = from; i < end; i++)
        if (bytes[i])
            return false;
    return true;
}

/* coded_payload_end_planes() - end a stream for each of `count` planes that were taken together,
 * `bytes` each. */
static inline void coded_payload_end_planes(coded_streams *out, int count, size_t bytes) {
    out->used -= (size_t)count * bytes;
    for (int b = 0; b < count; b++) {
        out->used += bytes;
        coded_streams_end(out);
    }
}

#endif
