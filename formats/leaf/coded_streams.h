/* coded_streams.h - a payload as streams of bytes, each of one kind of number, for a compressor.
 *
 * Streams lie one behind the other. The compressor begins a block of its own at each end, so that
 * each stream gets a table of its own. The decompressed bytes are decoded without the ends: coders
 * know how long each stream is.
 */
#ifndef FORMATS_LEAF_CODED_STREAMS_H
#define FORMATS_LEAF_CODED_STREAMS_H

#include <assert.h>
#include <stddef.h>
#include <stdint.h>

enum { CODED_STREAMS_MAX = 32 };

typedef struct coded_streams {
    uint8_t *bytes; /* the caller's, `room` of them */
    size_t room, used;
    size_t end[CODED_STREAMS_MAX]; /* of each stream, from the start of bytes; ascending */
    uint32_t count;                /* 1 .. CODED_STREAMS_MAX once a coder has filled it */
} coded_streams;

/* coded_streams_take() - returns the next `count` bytes, to be filled. They must fit. */
static inline uint8_t *coded_streams_take(coded_streams *s, size_t count) {
    assert(count <= s->room - s->used);
    uint8_t *at = s->bytes + s->used;
    s->used += count;
    return at;
}

/* coded_streams_end() - end a stream behind what has been taken. */
static inline void coded_streams_end(coded_streams *s) {
    assert(s->count < CODED_STREAMS_MAX);
    s->end[s->count++] = s->used;
}

/* Decompressed bytes that are still to be read. */
typedef struct coded_input {
    const uint8_t *at;
    size_t left;
} coded_input;

/* coded_input_take() - returns the next `count` bytes, or NULL if there are fewer. */
static inline const uint8_t *coded_input_take(coded_input *in, size_t count) {
    if (count > in->left)
        return NULL;
    const uint8_t *at = in->at;
    in->at += count;
    in->left -= count;
    return at;
}

#endif
