/* mesh_morton.h - a tet's place along the Morton curve through its mesh.
 *
 * It is the centroid's place on a lattice of 2^21 cells along the longest edge of the points' box,
 * bits interleaved: 63 bits, the same on any machine.
 */
#ifndef FORMATS_MESH_MESH_MORTON_H
#define FORMATS_MESH_MESH_MORTON_H

#include <stdint.h>

enum { MESH_MORTON_BITS = 63, MESH_MORTON_AXIS_BITS = 21 };

typedef struct mesh_lattice {
    double lo[3];
    double scale; /* cells per unit of length; 0: the box has no extent */
} mesh_lattice;

/* mesh_lattice_of() - bounds: lo x y z, hi x y z, finite. */
static inline mesh_lattice mesh_lattice_of(const float bounds[6]) {
    mesh_lattice l = {.scale = 0};
    double longest = 0;
    for (int a = 0; a < 3; a++) {
        double edge = (double)bounds[a + 3] - (double)bounds[a];
        longest = edge > longest ? edge : longest;
        l.lo[a] = (double)bounds[a];
    }
    if (longest > 0)
        l.scale = (double)(1 << MESH_MORTON_AXIS_BITS) / longest;
    return l;
}

/* Spread the lowest 21 bits: bit i moves to bit 3 i. */
static inline uint64_t mesh_morton_spread(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x001f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x001f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

/* mesh_morton_at() - key of a place within the bounds.
 * mesh_morton_key() - key of the tet with these vertices, which must lie within the bounds.
 * mesh_morton_triangle() - likewise of a triangle.
 * mesh_morton_cell() - likewise of a hexahedron with these corners. */
static inline uint64_t mesh_morton_at(const mesh_lattice *l, const double p[3]) {
    uint64_t key = 0;
    for (int a = 0; a < 3; a++) {
        double cell = (p[a] - l->lo[a]) * l->scale;
        const double last = (1 << MESH_MORTON_AXIS_BITS) - 1;
        cell = cell > 0 ? cell : 0;
        key |= mesh_morton_spread((uint64_t)(int32_t)(cell < last ? cell : last)) << a;
    }
    return key;
}

static inline uint64_t mesh_morton_key(const mesh_lattice *l, const float p[4][3]) {
    double middle[3];
    for (int a = 0; a < 3; a++)
        middle[a] =
            0.25 * (((double)p[0][a] + (double)p[1][a]) + ((double)p[2][a] + (double)p[3][a]));
    return mesh_morton_at(l, middle);
}

static inline uint64_t mesh_morton_triangle(const mesh_lattice *l, const float p[3][3]) {
    double middle[3];
    for (int a = 0; a < 3; a++)
        middle[a] = (((double)p[0][a] + (double)p[1][a]) + (double)p[2][a]) / 3.0;
    return mesh_morton_at(l, middle);
}

static inline uint64_t mesh_morton_cell(const mesh_lattice *l, const float p[8][3]) {
    double middle[3] = {0.0, 0.0, 0.0};
    for (int c = 0; c < 8; c++)
        for (int a = 0; a < 3; a++)
            middle[a] += 0.125 * (double)p[c][a];
    return mesh_morton_at(l, middle);
}

/* mesh_morton_common() - number of leading bits that two keys share: 0 .. 63. */
static inline int mesh_morton_common(uint64_t a, uint64_t b) {
    return a == b ? MESH_MORTON_BITS : __builtin_clzll(a ^ b) - (64 - MESH_MORTON_BITS);
}

#endif
