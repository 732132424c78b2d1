#include "stream/mesh_active.h"

#include <string.h>

#include "stream/active.h"

static size_t words_of(const mesh_shape *shape) {
    return (shape->tets + 63) / 64;
}

size_t mesh_active_bytes(const mesh_shape *shape) {
    return sizeof(mesh_active) + 8 * words_of(shape) + shape->nodes + shape->vertices;
}

mesh_active *mesh_active_init(void *block, const mesh_shape *shape) {
    mesh_active *active = block;
    active->tets = (uint64_t *)(active + 1);
    active->children = (uint8_t *)(active->tets + words_of(shape));
    active->sides = active->children + shape->nodes;
    return active;
}

/* Bit i of a vertex: its value is at or above isovalue i. */
static void find_sides(uint8_t *sides, const float *values, uint32_t count, const double *isovalues,
                       int isos) {
    memset(sides, 0, count);
    for (int i = 0; i < isos; i++) {
        const float at = active_threshold(isovalues[i]);
        for (uint32_t v = 0; v < count; v++)
            sides[v] |= (uint8_t)((values[v] >= at) << i);
    }
}

/* Those of a leaf's tets that have vertices on both sides of any isovalue. */
static void mark_tets(mesh_active *active, const uint16_t (*tets)[4], uint32_t first,
                      uint32_t end) {
    const uint8_t *s = active->sides;
    for (uint32_t i = first; i < end; i++) {
        const uint16_t *v = tets[i];
        const uint8_t a = s[v[0]], b = s[v[1]], c = s[v[2]], d = s[v[3]];
        const unsigned differ = (unsigned)((a | b | c | d) & ~(a & b & c & d));
        active->tets[i / 64] |= (uint64_t)(differ != 0) << i % 64;
    }
}

/* Children whose values can hold one of the isovalues, by their codes. */
static unsigned may_hold(const mesh_codes *codes, const quantized_iso isos[], int count) {
    unsigned mask = 0;
    for (int i = 0; i < count; i++)
        for (unsigned c = 0; c < MESH_CHILDREN; c++)
            mask |= (unsigned)quantize_holds(isos[i], codes->lo[c], codes->hi[c]) << c;
    return mask;
}

/* Down the tree as far as codes say; `children` notes which nodes have been come to. */
static void mark_leaves(mesh_active *active, const mesh_shape *shape, const void *topology,
                        const void *values, const quantized_iso isos[], int count) {
    const mesh_node *nodes = mesh_leaf_nodes(topology);
    const mesh_codes *codes = mesh_leaf_codes(values);
    const uint16_t *first = mesh_leaf_first(shape, topology);
    memset(active->children, 0, shape->nodes);
    active->children[0] = 1;
    for (uint32_t n = 0; n < shape->nodes; n++) {
        if (!active->children[n])
            continue;
        for (unsigned left = may_hold(&codes[n], isos, count); left; left &= left - 1) {
            const uint16_t child = nodes[n].child[__builtin_ctz(left)];
            const uint32_t leaf = child & ~(unsigned)MESH_LEAF;
            if (child == MESH_NO_CHILD)
                break;
            if (child & MESH_LEAF)
                mark_tets(active, mesh_leaf_tets(shape, topology), first[leaf], first[leaf + 1]);
            else
                active->children[child] = 1;
        }
    }
}

static bool any_tet(const uint64_t *bits, uint32_t first, uint32_t end) {
    for (uint32_t word = first / 64; word * 64 < end; word++) {
        uint64_t mask = UINT64_MAX;
        if (word == first / 64)
            mask &= UINT64_MAX << first % 64;
        if (end - word * 64 < 64)
            mask &= (UINT64_C(1) << (end - word * 64)) - 1;
        if (bits[word] & mask)
            return true;
    }
    return false;
}

/* From the last node to the first: children come behind their parents. */
static void mark_nodes(mesh_active *active, const mesh_shape *shape, const void *topology) {
    const mesh_node *nodes = mesh_leaf_nodes(topology);
    const uint16_t *first = mesh_leaf_first(shape, topology);
    for (uint32_t n = shape->nodes; n-- > 0;) {
        unsigned mask = 0;
        for (unsigned c = 0; c < MESH_CHILDREN; c++) {
            const uint16_t child = nodes[n].child[c];
            const uint32_t leaf = child & ~(unsigned)MESH_LEAF;
            if (child == MESH_NO_CHILD)
                break;
            const bool any = child & MESH_LEAF ? any_tet(active->tets, first[leaf], first[leaf + 1])
                                               : active->children[child] != 0;
            mask |= (unsigned)any << c;
        }
        active->children[n] = (uint8_t)mask;
    }
}

void mesh_active_compute(mesh_active *active, const mesh_shape *shape, const float own[2],
                         const void *topology, const void *values, const double *isovalues,
                         int count) {
    enum { TOGETHER = 8 }; /* the bits of a side */
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    memset(active->tets, 0, 8 * words_of(shape));
    for (int i = 0; i < count; i += TOGETHER) {
        const int isos = count - i < TOGETHER ? count - i : TOGETHER;
        quantized_iso held[TOGETHER];
        for (int k = 0; k < isos; k++)
            held[k] = quantizer_iso(&q, isovalues[i + k]);
        find_sides(active->sides, mesh_leaf_values(shape, values), shape->vertices, isovalues + i,
                   isos);
        mark_leaves(active, shape, topology, values, held, isos);
    }
    mark_nodes(active, shape, topology);
}
