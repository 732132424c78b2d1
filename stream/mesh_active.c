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

/* Those of a leaf's tets that have vertices on both sides of any isovalue; whether there are any.
 */
static bool mark_tets(mesh_active *active, const uint16_t (*tets)[4], uint32_t first,
                      uint32_t end) {
    const uint8_t *s = active->sides;
    unsigned any = 0;
    for (uint32_t i = first; i < end; i++) {
        const uint16_t *v = tets[i];
        const uint8_t a = s[v[0]], b = s[v[1]], c = s[v[2]], d = s[v[3]];
        const unsigned differ = (unsigned)((a | b | c | d) & ~(a & b & c & d));
        active->tets[i / 64] |= (uint64_t)(differ != 0) << i % 64;
        any |= differ;
    }
    return any;
}

/* Children whose values can hold one of the isovalues, by their codes. */
static unsigned may_hold(const mesh_codes *codes, const quantized_iso isos[], int count) {
    unsigned mask = 0;
    for (int i = 0; i < count; i++)
        for (unsigned c = 0; c < MESH_CHILDREN; c++)
            mask |= (unsigned)quantize_holds(isos[i], codes->lo[c], codes->hi[c]) << c;
    return mask;
}

/* A bit a node. */
typedef uint64_t node_set[MESH_LEAF / 64];

/* Leaves wait a while, so that their tets are on their way when it is their turn. */
enum { LEAVES_WAITING = 8 };

typedef struct waiting_leaves {
    struct {
        uint32_t node, child, first, end;
    } of[LEAVES_WAITING];
    unsigned count, next;
} waiting_leaves;

static void mark_leaf(mesh_active *active, const uint16_t (*tets)[4], waiting_leaves *w) {
    const unsigned k = w->next++ % LEAVES_WAITING;
    const bool any = mark_tets(active, tets, w->of[k].first, w->of[k].end);
    active->children[w->of[k].node] |= (uint8_t)(any << w->of[k].child);
}

/* Down the tree as far as codes say; reached: the nodes that this comes to. */
static void mark_leaves(mesh_active *active, const mesh_shape *shape, const void *topology,
                        const void *values, const quantized_iso isos[], int count,
                        node_set reached) {
    const mesh_node *nodes = mesh_leaf_nodes(topology);
    const mesh_codes *codes = mesh_leaf_codes(values);
    const uint16_t *first = mesh_leaf_first(shape, topology);
    const uint16_t(*tets)[4] = mesh_leaf_tets(shape, topology);
    waiting_leaves waiting = {.count = 0};
    reached[0] |= 1;
    /* Children come behind their parents. */
    for (uint32_t word = 0; word * 64 < shape->nodes; word++) {
        for (uint64_t done = 0, left; (left = reached[word] & ~done);) {
            const uint32_t n = word * 64 + (uint32_t)__builtin_ctzll(left);
            done |= left & -left;
            for (unsigned hold = may_hold(&codes[n], isos, count); hold; hold &= hold - 1) {
                const unsigned c = (unsigned)__builtin_ctz(hold);
                const uint32_t child = nodes[n].child[c], leaf = child & ~(uint32_t)MESH_LEAF;
                if (child == MESH_NO_CHILD)
                    break;
                if (!(child & MESH_LEAF)) {
                    reached[child / 64] |= UINT64_C(1) << child % 64;
                    continue;
                }
                __builtin_prefetch(tets[first[leaf]]);
                if (waiting.count - waiting.next == LEAVES_WAITING)
                    mark_leaf(active, tets, &waiting);
                waiting.of[waiting.count % LEAVES_WAITING].node = n;
                waiting.of[waiting.count % LEAVES_WAITING].child = c;
                waiting.of[waiting.count % LEAVES_WAITING].first = first[leaf];
                waiting.of[waiting.count++ % LEAVES_WAITING].end = first[leaf + 1];
            }
        }
    }
    while (waiting.next < waiting.count)
        mark_leaf(active, tets, &waiting);
}

/* Nodes with active ones below, from the last one that was reached to the first. */
static void mark_nodes(mesh_active *active, const mesh_shape *shape, const mesh_node *nodes,
                       const node_set reached) {
    for (uint32_t word = (shape->nodes + 63) / 64; word-- > 0;) {
        for (uint64_t left = reached[word]; left;) {
            const unsigned bit = 63u - (unsigned)__builtin_clzll(left);
            const uint32_t n = word * 64 + bit;
            left ^= UINT64_C(1) << bit;
            for (unsigned c = 0; c < MESH_CHILDREN; c++) {
                const uint16_t child = nodes[n].child[c];
                if (child < MESH_LEAF)
                    active->children[n] |= (uint8_t)((active->children[child] != 0) << c);
            }
        }
    }
}

void mesh_active_compute(mesh_active *active, const mesh_shape *shape, const float own[2],
                         const void *topology, const void *values, const double *isovalues,
                         int count) {
    enum { TOGETHER = 8 }; /* the bits of a side */
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    node_set reached;
    memset(active->tets, 0, 8 * words_of(shape));
    memset(active->children, 0, shape->nodes);
    memset(reached, 0, (shape->nodes + 63) / 64 * sizeof reached[0]);
    for (int i = 0; i < count; i += TOGETHER) {
        const int isos = count - i < TOGETHER ? count - i : TOGETHER;
        quantized_iso held[TOGETHER];
        for (int k = 0; k < isos; k++)
            held[k] = quantizer_iso(&q, isovalues[i + k]);
        find_sides(active->sides, mesh_leaf_values(shape, values), shape->vertices, isovalues + i,
                   isos);
        mark_leaves(active, shape, topology, values, held, isos, reached);
    }
    mark_nodes(active, shape, mesh_leaf_nodes(topology), reached);
}
