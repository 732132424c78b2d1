/* stream_coding.h - compressed payloads of kinds that have a leaf_coder (FORMAT.md 6): zstd frames
 * of coded streams. */
#ifndef FORMATS_LEAF_STREAM_CODING_H
#define FORMATS_LEAF_STREAM_CODING_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_coder.h"

/* A compressor of one thread. */
typedef struct stream_coding stream_coding;

/* stream_coding_create() - for payloads of treelets with these counts, or less. level: of zstd.
 * stream_coding_memory() - the bytes that it takes from a mem.
 * stream_coding_outside() - and those that zstd takes elsewhere: right after stream_coding_pack().
 */
CHECKED status stream_coding_create(mem *m, const leaf_coder *coder, const uint32_t counts[4],
                                    int level, stream_coding **out);
void stream_coding_destroy(stream_coding *c); /* NULL is fine */
size_t stream_coding_memory(const leaf_coder *coder, const uint32_t counts[4]);
size_t stream_coding_outside(const stream_coding *c);

/* stream_coding_room() - the most bytes of the streams of any payload with these counts. */
size_t stream_coding_room(const leaf_coder *coder, const uint32_t counts[4]);

/* stream_coding_pack() - compress a payload into pack, of as many bytes. Returns the bytes it
 * takes; 0: it does not get smaller. */
size_t stream_coding_pack(stream_coding *c, leaf_block block, const uint32_t counts[4],
                          const float bounds[6], const void *payload, void *pack);

#endif
