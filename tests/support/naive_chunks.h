/* naive_chunks.h - samples of level 0 that lie in the chunks of an array, from formats/CHUNKS.md
 * alone. */
#ifndef TESTS_SUPPORT_NAIVE_CHUNKS_H
#define TESTS_SUPPORT_NAIVE_CHUNKS_H

#include <stdint.h>

/* naive_chunks_check() - whether a section OUTSIDE has only zeros behind its path, or describes
 * chunks: *chunks. Returns NULL, or what is wrong. */
const char *naive_chunks_check(const unsigned char *section, int *chunks);

/* naive_chunks_read() - the numbers of all nodes, those that are taken side by side, then x
 * fastest, little endian; the caller frees them.
 * json, size: the bytes of the file that describes the array, whose path is json_path. */
const char *naive_chunks_read(const unsigned char *section, const char *json_path,
                              const unsigned char *json, uint64_t size, const long dims[3],
                              unsigned char **numbers);

#endif
