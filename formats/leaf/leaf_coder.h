/* leaf_coder.h - how a kind turns payloads into streams that compress well, and back, to the bit: a
 * table of functions.
 *
 * Kinds whose payloads come in blocks (leaf_layout.h) have one; stream_coding.h compresses the
 * streams.
 *
 * Stateless: any thread may call these at any time, with buffers of its own. Nothing is allocated.
 * counts: of the treelet, as in leaf_layout.counts, and sound. bounds: of the treelet at the first
 * step, finite and ordered.
 */
#ifndef FORMATS_LEAF_LEAF_CODER_H
#define FORMATS_LEAF_LEAF_CODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/coded_streams.h"
#include "formats/leaf/leaf_layout.h"

typedef struct leaf_coder {
    /* bytes(): of a payload. room(): the most that its streams take together. scratch(): what
     * encode() needs for any payload of the treelet. */
    size_t (*bytes)(leaf_block block, const uint32_t counts[4]);
    size_t (*room)(leaf_block block, const uint32_t counts[4]);
    size_t (*scratch)(const uint32_t counts[4]);

    /* Encode a payload. It cannot fail: one that cannot be made again from its streams is stored as
     * it is.
     *
     * payload  bytes() bytes, 64-byte aligned; any
     * scratch  scratch() bytes, 64-byte aligned; overwritten
     * out      bytes, and room for at least room(), are the caller's; the rest is filled
     *
     * The streams depend on nothing but the other arguments. */
    void (*encode)(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const void *payload, void *scratch, coded_streams *out);

    /* Decode streams, one behind the other.
     *
     * in       `bytes` bytes, of any alignment and content; nothing is read outside them
     * payload  out: bytes() bytes, 64-byte aligned, undefined if the result is false; nothing is
     * written outside them
     *
     * Returns false if the bytes are no payload's streams. If true, the payload is what was
     * encoded, with the same counts and bounds. From bytes that encode() has not made, it may be
     * any: the kind must check it as if it had been read. Takes time in proportion to the payload's
     * bytes, whatever the input. */
    bool (*decode)(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const uint8_t *in, size_t bytes, void *payload);
} leaf_coder;

#endif
