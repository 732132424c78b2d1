#include "formats/mesh/mesh_refit.h"

#include <string.h>

size_t mesh_refit_scratch(const mesh_shape *s) {
    return s->nodes * sizeof(float[6]);
}

/* ---- ranges of values ---- */

typedef struct range {
    float lo, hi;
} range;

static const range nothing = {INFINITY, -INFINITY};

static inline range wider(range a, float lo, float hi) {
    a.lo = lo < a.lo ? lo : a.lo;
    a.hi = hi > a.hi ? hi : a.hi;
    return a;
}

static range leaf_range(const uint16_t (*tets)[4], uint32_t first, uint32_t end, const float *value,
                        bool finite) {
    range all = nothing;
    const uint16_t *v = tets[first], *const behind = tets[end];
    for (; v < behind; v++)
        if (finite || isfinite(value[*v]))
            all = wider(all, value[*v], value[*v]);
    return all;
}

void mesh_refit_values(const mesh_shape *s, const void *topology, const float own[2], bool finite,
                       void *values, void *scratch) {
    const mesh_node *nodes = mesh_leaf_nodes(topology);
    const uint16_t *first = mesh_leaf_first(s, topology);
    const uint16_t(*tets)[4] = mesh_leaf_tets(s, topology);
    const float *value = mesh_leaf_values(s, values);
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    mesh_codes *codes = values;
    range *ranges = scratch;
    memset((char *)values + s->nodes * sizeof *codes, 0, s->values_at - s->nodes * sizeof *codes);
    /* Children come after their parents: go backwards. */
    for (uint32_t n = s->nodes; n-- > 0;) {
        range all = nothing;
        memset(codes[n].lo, 255, sizeof codes[n].lo);
        memset(codes[n].hi, 0, sizeof codes[n].hi);
        for (int c = 0; c < MESH_CHILDREN && nodes[n].child[c] != MESH_NO_CHILD; c++) {
            const uint32_t child = nodes[n].child[c], leaf = child & ~(uint32_t)MESH_LEAF;
            const range r = child & MESH_LEAF
                                ? leaf_range(tets, first[leaf], first[leaf + 1], value, finite)
                                : ranges[child];
            all = wider(all, r.lo, r.hi);
            /* No finite value; or values that are not the file's: then the checksum will fail. */
            if (!(own[0] <= r.lo && r.lo <= r.hi && r.hi <= own[1]))
                continue;
            codes[n].lo[c] = quantizer_floor(&q, (double)r.lo);
            codes[n].hi[c] = quantizer_ceil(&q, (double)r.hi);
        }
        ranges[n] = all;
    }
}

/* ---- boxes of vertices ---- */

typedef struct box {
    float lo[3], hi[3];
} box;

static const box nowhere = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static inline void widen(box *b, const float lo[3], const float hi[3]) {
    for (int a = 0; a < 3; a++) {
        b->lo[a] = lo[a] < b->lo[a] ? lo[a] : b->lo[a];
        b->hi[a] = hi[a] > b->hi[a] ? hi[a] : b->hi[a];
    }
}

static box leaf_box(const uint16_t (*tets)[4], uint32_t first, uint32_t end,
                    const float (*position)[3]) {
    box all = nowhere;
    const uint16_t *v = tets[first], *const behind = tets[end];
    for (; v < behind; v++)
        widen(&all, position[*v], position[*v]);
    return all;
}

void mesh_refit_boxes(const mesh_shape *s, const void *topology, const float bounds[6],
                      void *positions, void *scratch) {
    const mesh_node *nodes = mesh_leaf_nodes(topology);
    const uint16_t *first = mesh_leaf_first(s, topology);
    const uint16_t(*tets)[4] = mesh_leaf_tets(s, topology);
    const float(*position)[3] = mesh_leaf_moved(s, positions);
    const mesh_frame frame = mesh_leaf_frame(bounds);
    mesh_boxes *codes = positions;
    box *boxes = scratch;
    memset((char *)positions + s->nodes * sizeof *codes, 0, s->moved_at - s->nodes * sizeof *codes);
    for (uint32_t n = s->nodes; n-- > 0;) {
        box all = nowhere;
        memset(codes[n].lo, 255, sizeof codes[n].lo);
        memset(codes[n].hi, 0, sizeof codes[n].hi);
        for (int c = 0; c < MESH_CHILDREN && nodes[n].child[c] != MESH_NO_CHILD; c++) {
            const uint32_t child = nodes[n].child[c], leaf = child & ~(uint32_t)MESH_LEAF;
            const box b = child & MESH_LEAF ? leaf_box(tets, first[leaf], first[leaf + 1], position)
                                            : boxes[child];
            widen(&all, b.lo, b.hi);
            for (int a = 0; a < 3; a++) {
                codes[n].lo[a][c] = mesh_leaf_code_lo(&frame, a, b.lo[a]);
                codes[n].hi[a][c] = mesh_leaf_code_hi(&frame, a, b.hi[a]);
            }
        }
        boxes[n] = all;
    }
}
