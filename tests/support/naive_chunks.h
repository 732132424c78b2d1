/* naive_chunks.h - samples of level 0 that lie in the chunks of an array, from formats/OUTSIDE.md
 * alone. */
#ifndef TESTS_SUPPORT_NAIVE_CHUNKS_H
#define TESTS_SUPPORT_NAIVE_CHUNKS_H

#include <stdint.h>

/* naive_chunks_check() - whether a section OUTSIDE has only zeros behind its path, or describes
 * chunks: *chunks. Returns NULL, or what is wrong. */
const char *naive_chunks_check(const unsigned char *section, int *chunks);

/* The file that a section names: it describes the array, or has all chunks; or the files of slices,
 * one behind the other. */
typedef struct naive_chunks_file {
    const char *path;
    const unsigned char *bytes;
    uint64_t size;
    const unsigned char *table; /* section CHUNKS; NULL: there is none */
    long table_count;
    const uint64_t *starts; /* where the file of each slice begins, and the end; NULL: one file */
} naive_chunks_file;

/* naive_chunks_read() - the numbers of all nodes, those that are taken side by side, then x
 * fastest, little endian; the caller frees them. Returns NULL, or what is wrong. */
const char *naive_chunks_read(const unsigned char *section, const naive_chunks_file *in,
                              const long dims[3], unsigned char **numbers);

#endif
