/* naive_coded.h - a second decoder of coded payloads of meshes, written from formats/FORMAT.md 6
 * alone: slow and plain.
 */
#ifndef TESTS_SUPPORT_NAIVE_CODED_H
#define TESTS_SUPPORT_NAIVE_CODED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* naive_coded_decode() - block: 0 topology, 1 values, 2 gradients, 3 positions at a step. payload:
 * out, all of it, zeros before. Boxes are left 0 where the first byte says that they are implied.
 * Returns false if the bytes break a rule of it. */
bool naive_coded_decode(int block, const uint32_t counts[4], const unsigned char *in, size_t bytes,
                        unsigned char *payload, size_t payload_bytes);

/* naive_coded_unpack() - the same of a payload as it is stored: one zstd frame. *implied: the boxes of
 * a topology are not there. */
bool naive_coded_unpack(int block, const uint32_t counts[4], const unsigned char *stored,
                        size_t stored_bytes, unsigned char *payload, size_t payload_bytes,
                        bool *implied);

#endif
