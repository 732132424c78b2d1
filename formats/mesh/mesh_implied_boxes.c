#include "formats/mesh/mesh_implied_boxes.h"

#include <math.h>

/* A treelet whose boxes are being made. */
typedef struct subject {
    const mesh_shape *s;
    mesh_node *nodes;
    const uint16_t *first;
    const uint16_t (*tets)[4];
    const float (*positions)[3];
    mesh_frame frame;
} subject;

static bool all_within(const float (*p)[3], uint32_t count, const float bounds[6]) {
    int outside = 0;
    for (uint32_t v = 0; v < count; v++)
        for (int a = 0; a < 3; a++)
            outside |= !(p[v][a] >= bounds[a]) | !(p[v][a] <= bounds[a + 3]);
    return !outside;
}

/* Find the box of a leaf's tets. */
static void find_leaf_box(const subject *x, uint32_t leaf, float lo[3], float hi[3]) {
    for (int a = 0; a < 3; a++) {
        lo[a] = INFINITY;
        hi[a] = -INFINITY;
    }
    for (uint32_t i = x->first[leaf]; i < x->first[leaf + 1]; i++)
        for (int corner = 0; corner < 4; corner++) {
            const float *p = x->positions[x->tets[i][corner]];
            for (int a = 0; a < 3; a++) {
                lo[a] = p[a] < lo[a] ? p[a] : lo[a];
                hi[a] = p[a] > hi[a] ? p[a] : hi[a];
            }
        }
}

static void code_leaf(const subject *x, uint32_t leaf, mesh_node *n, int c) {
    float lo[3], hi[3];
    find_leaf_box(x, leaf, lo, hi);
    for (int a = 0; a < 3; a++) {
        n->lo[a][c] = mesh_leaf_code_lo(&x->frame, a, lo[a]);
        n->hi[a][c] = mesh_leaf_code_hi(&x->frame, a, hi[a]);
    }
}

/* Code the union of an inner node's children, whose boxes are coded. */
static void code_inner(const mesh_node *inner, mesh_node *n, int c) {
    for (int a = 0; a < 3; a++) {
        uint8_t lo = 255, hi = 0;
        for (int i = 0; i < MESH_CHILDREN; i++) {
            lo = inner->lo[a][i] < lo ? inner->lo[a][i] : lo;
            hi = inner->hi[a][i] > hi ? inner->hi[a][i] : hi;
        }
        n->lo[a][c] = lo;
        n->hi[a][c] = hi;
    }
}

/* The plane of a code is monotone, so the union of coded boxes is the coded union. */
bool mesh_implied_boxes(const mesh_shape *s, const float bounds[6], void *topology) {
    const subject x = {.s = s,
                       .nodes = topology,
                       .first = mesh_leaf_first(s, topology),
                       .tets = mesh_leaf_tets(s, topology),
                       .positions = mesh_leaf_positions(s, topology),
                       .frame = mesh_leaf_frame(bounds)};
    if (!all_within(x.positions, s->vertices, bounds))
        return false;
    for (uint32_t i = s->nodes; i-- > 0;) {
        mesh_node *n = &x.nodes[i];
        for (int c = 0; c < MESH_CHILDREN; c++) {
            for (int a = 0; a < 3; a++) {
                n->lo[a][c] = 255;
                n->hi[a][c] = 0;
            }
            if (n->child[c] == MESH_NO_CHILD)
                continue;
            if (n->child[c] & MESH_LEAF)
                code_leaf(&x, n->child[c] & ~MESH_LEAF, n, c);
            else
                code_inner(&x.nodes[n->child[c]], n, c);
        }
    }
    return true;
}
