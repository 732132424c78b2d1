/* mesh_active.h - which tets of a mesh's treelet are active: derived data of a resident treelet, as
 * active.h is for grids.
 *
 * A tet is active iff the range of its four values meets the interest and none of them is NaN or
 * inf. This is exact. The masks are made when a treelet is first looked up. They take a byte per
 * vertex, a byte per node and a bit per tet.
 */
#ifndef STREAM_MESH_ACTIVE_H
#define STREAM_MESH_ACTIVE_H

#include <stddef.h>
#include <stdint.h>

#include "formats/mesh/mesh_leaf.h"
#include "stream/interest.h"

typedef struct mesh_active {
    uint8_t *children; /* per node: bit c: child c has active tets below */
    uint64_t *tets;    /* a bit per tet */
    uint8_t *sides;    /* scratch while masks are made: a byte per vertex */
} mesh_active;

/* mesh_active_bytes() - returns the size of the block, 64-byte aligned, that mesh_active_init()
 * lays out. */
size_t mesh_active_bytes(const mesh_shape *shape);
mesh_active *mesh_active_init(void *block, const mesh_shape *shape);

/* mesh_active_compute() - make the masks for an interest. topology, values: the treelet's checked
 * payloads. own: the range of its finite values, which its codes are relative to. non_finite: some
 * values are NaN or inf. */
void mesh_active_compute(mesh_active *active, const mesh_shape *shape, const float own[2],
                         bool non_finite, const void *topology, const void *values,
                         const interest *in);

/* mesh_active_word() - returns the bits of tets 64 word .. 64 word + 63, without those outside of
 * first .. end - 1. */
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
