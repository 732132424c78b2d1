/* mesh_active.h - which tets of a mesh's treelet are of interest: derived data of a resident
 * treelet, as active.h is for grids.
 *
 * A tet is active iff the range of its four values meets the interest and none of them is NaN or
 * inf: exact. Made when a treelet is first looked at. 2 bytes a vertex and node and a bit a tet.
 */
#ifndef STREAM_MESH_ACTIVE_H
#define STREAM_MESH_ACTIVE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/mesh/mesh_leaf.h"
#include "stream/interest.h"

typedef struct mesh_active {
    uint8_t *children; /* a node: bit c: there are active tets below child c */
    uint64_t *tets;    /* a bit a tet */
    uint8_t *sides;    /* room for a byte a vertex while they are made */
} mesh_active;

/* mesh_active_bytes() - size of the block that mesh_active_init() lays out; 64-byte aligned. */
size_t mesh_active_bytes(const mesh_shape *shape);
mesh_active *mesh_active_init(void *block, const mesh_shape *shape);

/* mesh_active_compute() - topology, values: the treelet's checked payloads; own: the range of its
 * values, which its codes are relative to; non_finite: there are others among them. */
void mesh_active_compute(mesh_active *active, const mesh_shape *shape, const float own[2],
                         bool non_finite, const void *topology, const void *values,
                         const interest *in);

/* mesh_active_word() - of the bits of tets 64 word .. 64 word + 63 those of tets first .. end - 1.
 */
static inline uint64_t mesh_active_word(const mesh_active *active, uint32_t word, uint32_t first,
                                        uint32_t end) {
    uint64_t bits = active->tets[word];
    if (word == first / 64)
        bits &= UINT64_MAX << first % 64;
    if (end - word * 64 < 64)
        bits &= (UINT64_C(1) << (end - word * 64)) - 1;
    return bits;
}

#endif
