#include "stream/mesh_active.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/leaf.h"

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

/* Intervals that are tested together: as many as fit the bits of a byte per vertex. Bit i: the
 * value reaches interval i; bit i + shift: it lies beyond. shift 0: isovalues, where both are the
 * same. */
typedef struct batch {
    const value_limits *limits;
    const quantized_limits *codes;
    int count;
    unsigned shift;
} batch;

enum { SIDE_BITS = 8 };

/* Returns the batch from interval `first` on. Isovalues take a bit each, other intervals two. */
static batch batch_of(const interest_part *part, int first) {
    const value_limits *at = part->limits + first;
    const int left = part->count - first, most = left < SIDE_BITS ? left : SIDE_BITS;
    batch b = {at, part->codes + first, 0, 0};
    while (b.count < most && at[b.count].reach == at[b.count].beyond)
        b.count++;
    if (b.count < most && b.count < SIDE_BITS / 2) {
        b.count = left < SIDE_BITS / 2 ? left : SIDE_BITS / 2;
        b.shift = SIDE_BITS / 2;
    }
    return b;
}

static void find_sides(uint8_t *sides, const float *values, uint32_t count, const batch *b) {
    memset(sides, 0, count);
    for (int i = 0; i < b->count; i++) {
        const value_limits at = b->limits[i];
        for (uint32_t v = 0; v < count; v++)
            sides[v] |= (uint8_t)((values[v] >= at.reach) << i);
        for (uint32_t v = 0; b->shift && v < count; v++)
            sides[v] |= (uint8_t)((values[v] >= at.beyond) << (i + (int)b->shift));
    }
}

/* Returns a bit per tet: some vertex reaches an interval, and not all vertices are beyond it. */
static inline uint64_t met_tets(const uint8_t *s, const uint16_t (*tets)[4], uint32_t count,
                                unsigned shift) {
    const unsigned reaches = (1u << (shift ? shift : SIDE_BITS)) - 1u;
    uint64_t bits = 0;
    for (uint32_t i = 0; i < count; i++) {
        const uint16_t *v = tets[i];
        const uint8_t a = s[v[0]], b = s[v[1]], c = s[v[2]], d = s[v[3]];
        const unsigned met = (unsigned)((a | b | c | d) & ~((a & b & c & d) >> shift)) & reaches;
        bits |= (uint64_t)(met != 0) << i;
    }
    return bits;
}

static uint64_t finite_tets(const float *values, const uint16_t (*tets)[4], uint32_t count) {
    uint64_t bits = 0;
    for (uint32_t i = 0; i < count; i++) {
        bool finite = true;
        for (int k = 0; k < 4; k++)
            finite = finite && isfinite(values[tets[i][k]]);
        bits |= (uint64_t)finite << i;
    }
    return bits;
}

/* Returns the children whose codes may meet one of the intervals: a bit each. */
static unsigned may_meet(const mesh_codes *codes, const batch *b) {
    unsigned mask = 0;
    for (int i = 0; i < b->count; i++)
        for (unsigned c = 0; c < MESH_CHILDREN; c++)
            mask |= (unsigned)quantize_holds(b->codes[i], codes->lo[c], codes->hi[c]) << c;
    return mask;
}

/* A bit per node. */
typedef uint64_t node_set[MESH_LEAF / 64];

/* Leaves wait in a short queue, so that their prefetched tets have come when they are marked. */
enum { LEAVES_WAITING = 8 };

typedef struct waiting_leaves {
    struct {
        uint32_t node, child, first, end;
    } of[LEAVES_WAITING];
    unsigned count, next;
} waiting_leaves;

/* The masks to mark, and the data that decides. */
typedef struct marking {
    mesh_active *active;
    const mesh_node *nodes;
    const mesh_codes *codes;
    const uint16_t *first; /* per leaf: its first tet */
    const uint16_t (*tets)[4];
    const float *values;
    bool non_finite;
} marking;

_Static_assert(LEAF_LEAF_TETS_MAX <= 64, "a leaf's tets are bits of a word");

static void mark_leaf(const marking *m, const batch *b, waiting_leaves *w) {
    const unsigned k = w->next++ % LEAVES_WAITING;
    const uint32_t first = w->of[k].first, count = w->of[k].end - first;
    const uint16_t(*tets)[4] = m->tets + first;
    uint64_t bits = b->shift ? met_tets(m->active->sides, tets, count, SIDE_BITS / 2)
                             : met_tets(m->active->sides, tets, count, 0);
    if (m->non_finite)
        bits &= finite_tets(m->values, tets, count);
    m->active->tets[first / 64] |= bits << first % 64;
    if (first % 64 + count > 64)
        m->active->tets[first / 64 + 1] |= bits >> (64 - first % 64);
    m->active->children[w->of[k].node] |= (uint8_t)((bits != 0) << w->of[k].child);
}

/* Descend the tree where codes may meet the batch, and mark its leaves' tets. reached: add the
 * nodes visited. */
static void mark_leaves(const marking *m, uint32_t nodes, const batch *b, node_set reached) {
    waiting_leaves waiting = {.count = 0};
    reached[0] |= 1;
    /* Children come after their parents, so one pass visits them all. */
    for (uint32_t word = 0; word * 64 < nodes; word++) {
        for (uint64_t done = 0, left; (left = reached[word] & ~done);) {
            const uint32_t n = word * 64 + (uint32_t)__builtin_ctzll(left);
            done |= left & -left;
            for (unsigned met = may_meet(&m->codes[n], b); met; met &= met - 1) {
                const unsigned c = (unsigned)__builtin_ctz(met);
                const uint32_t child = m->nodes[n].child[c], leaf = child & ~(uint32_t)MESH_LEAF;
                if (child == MESH_NO_CHILD)
                    break;
                if (!(child & MESH_LEAF)) {
                    reached[child / 64] |= UINT64_C(1) << child % 64;
                    continue;
                }
                __builtin_prefetch(m->tets[m->first[leaf]]);
                if (waiting.count - waiting.next == LEAVES_WAITING)
                    mark_leaf(m, b, &waiting);
                waiting.of[waiting.count % LEAVES_WAITING].node = n;
                waiting.of[waiting.count % LEAVES_WAITING].child = c;
                waiting.of[waiting.count % LEAVES_WAITING].first = m->first[leaf];
                waiting.of[waiting.count++ % LEAVES_WAITING].end = m->first[leaf + 1];
            }
        }
    }
    while (waiting.next < waiting.count)
        mark_leaf(m, b, &waiting);
}

/* Mark children with active tets below, from the last reached node to the first. */
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
                         bool non_finite, const void *topology, const void *values,
                         const interest *in) {
    const marking m = {.active = active,
                       .nodes = mesh_leaf_nodes(topology),
                       .codes = mesh_leaf_codes(values),
                       .first = mesh_leaf_first(shape, topology),
                       .tets = mesh_leaf_tets(shape, topology),
                       .values = mesh_leaf_values(shape, values),
                       .non_finite = non_finite};
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    interest_part part;
    node_set reached;
    memset(active->tets, 0, 8 * words_of(shape));
    memset(active->children, 0, shape->nodes);
    memset(reached, 0, (shape->nodes + 63) / 64 * sizeof reached[0]);
    interest_within(&part, in, &q);
    for (int i = 0; i < part.count;) {
        const batch b = batch_of(&part, i);
        find_sides(active->sides, m.values, shape->vertices, &b);
        mark_leaves(&m, shape->nodes, &b, reached);
        i += b.count;
    }
    mark_nodes(active, shape, m.nodes, reached);
}
