#include "formats/mesh/mesh_leaf_check.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* One payload under check. */
typedef struct subject {
    const leaf_file *f;
    uint32_t t, payload;
    mesh_shape s;
    const uint8_t *bytes;
    const mesh_node *nodes;
} subject;

static subject subject_of(const leaf_file *f, uint32_t t, uint32_t payload, const void *topology,
                          const void *bytes) {
    return (subject){.f = f,
                     .t = t,
                     .payload = payload,
                     .s = mesh_leaf_shape(f->mesh->counts[t]),
                     .bytes = bytes,
                     .nodes = mesh_leaf_nodes(topology)};
}

/* Describe a fault. at: the wrong bytes, in the payload. */
__attribute__((format(printf, 3, 4))) static status wrong(const subject *x, const void *at,
                                                          const char *fmt, ...) {
    char text[STATUS_TEXT_MAX / 2], name[LEAF_NAME_MAX];
    const uint64_t offset = (uint64_t)((const uint8_t *)at - x->bytes);
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    const char *path = file_path(x->f->source);
    leaf_layout_payload_name(&x->f->layout, x->payload, name);
    if (leaf_file_is_raw(x->f, x->payload))
        return status_describe(ST_CORRUPT, "%s: byte %llu: %s: %s", path,
                               (unsigned long long)(x->f->offsets[x->payload] + offset), name,
                               text);
    return status_describe(ST_CORRUPT, "%s: byte %llu of %s: %s", path, (unsigned long long)offset,
                           name, text);
}

/* ---- is it safe to traverse? ---- */

/* Check that present children come first, and that inner nodes are numbered as they are met. Then
 * each node but the root is the child of exactly one node, which is before it. */
static status check_children(const subject *x) {
    uint32_t next = 1;
    for (uint32_t n = 0; n < x->s.nodes; n++) {
        const uint16_t *child = x->nodes[n].child;
        uint32_t present = 0;
        if (n >= next)
            return wrong(x, child, "node %u is no node's child", n);
        for (uint32_t c = 0; c < MESH_CHILDREN; c++) {
            if (child[c] == MESH_NO_CHILD)
                continue;
            if (present++ < c)
                return wrong(x, &child[c], "node %u: expected no child behind an absent one", n);
            if (!(child[c] & MESH_LEAF) && child[c] != next++)
                return wrong(x, &child[c], "expected node %u as the next child, found %u", next - 1,
                             child[c]);
        }
        if (present < 2 && x->s.leaves > 1)
            return wrong(x, child, "expected two children or more, found %u", present);
    }
    if (next != x->s.nodes)
        return wrong(x, x->nodes, "expected %u nodes in the tree, found %u", x->s.nodes, next);
    return ST_OK;
}

/* Check that a walk down from the root meets the leaves in order. */
static status check_leaf_order(const subject *x) {
    struct {
        uint16_t node, child;
    } path[MESH_DEPTH_MAX] = {{0, 0}};
    uint32_t leaf = 0;
    for (int depth = 0; depth >= 0;) {
        const uint16_t *child = x->nodes[path[depth].node].child;
        const uint16_t c = path[depth].child++;
        if (c == MESH_CHILDREN || child[c] == MESH_NO_CHILD) {
            depth--;
        } else if (child[c] & MESH_LEAF) {
            if ((child[c] & ~MESH_LEAF) != leaf++)
                return wrong(x, &child[c], "expected leaf %u as the next one, found %u", leaf - 1,
                             child[c] & ~MESH_LEAF);
        } else {
            if (++depth == MESH_DEPTH_MAX)
                return wrong(x, &child[c], "expected at most %d nodes on a path", MESH_DEPTH_MAX);
            path[depth].node = child[c];
            path[depth].child = 0;
        }
    }
    if (leaf != x->s.leaves)
        return wrong(x, x->nodes, "expected %u leaves in the tree, found %u", x->s.leaves, leaf);
    return ST_OK;
}

static status check_leaves(const subject *x) {
    const uint16_t *first = mesh_leaf_first(&x->s, x->bytes);
    if (first[0] != 0)
        return wrong(x, first, "expected the first leaf at tet 0, found %u", first[0]);
    for (uint32_t l = 0; l < x->s.leaves; l++)
        if (first[l + 1] <= first[l] || first[l + 1] - first[l] > (int)x->f->header.leaf_tets)
            return wrong(x, &first[l + 1],
                         "expected leaf %u to end %u to %u tets behind %u, not %u", l, 1,
                         x->f->header.leaf_tets, first[l], first[l + 1]);
    if (first[x->s.leaves] != x->s.tets)
        return wrong(x, &first[x->s.leaves], "expected the last leaf to end at tet %u, found %u",
                     x->s.tets, first[x->s.leaves]);
    return ST_OK;
}

/* Check all tets at once, which is quick. Look for the bad one only when there is one. */
static status check_tets(const subject *x) {
    const uint16_t(*tet)[4] = mesh_leaf_tets(&x->s, x->bytes);
    unsigned bad = 0;
    for (uint32_t i = 0; i < x->s.tets; i++)
        bad |= (unsigned)(tet[i][0] >= tet[i][1]) | (unsigned)(tet[i][1] >= tet[i][2]) |
               (unsigned)(tet[i][2] >= tet[i][3]) | (unsigned)(tet[i][3] >= x->s.vertices);
    for (uint32_t i = 0; bad && i < x->s.tets; i++)
        if (tet[i][0] >= tet[i][1] || tet[i][1] >= tet[i][2] || tet[i][2] >= tet[i][3] ||
            tet[i][3] >= x->s.vertices)
            return wrong(x, tet[i],
                         "tet %u: expected vertices below %u in ascending order, found "
                         "%u, %u, %u, %u",
                         i, x->s.vertices, tet[i][0], tet[i][1], tet[i][2], tet[i][3]);
    return ST_OK;
}

static bool outside(const float *p, const float *bounds) {
    return !(p[0] >= bounds[0]) | !(p[1] >= bounds[1]) | !(p[2] >= bounds[2]) |
           !(p[0] <= bounds[3]) | !(p[1] <= bounds[4]) | !(p[2] <= bounds[5]);
}

static status check_positions(const subject *x, const float (*p)[3], const float bounds[6]) {
    unsigned bad = 0;
    for (uint32_t v = 0; v < x->s.vertices; v++)
        bad |= outside(p[v], bounds);
    for (uint32_t v = 0; bad && v < x->s.vertices; v++)
        if (outside(p[v], bounds))
            return wrong(x, p[v], "expected vertex %u within the treelet's bounds, found %g %g %g",
                         v, (double)p[v][0], (double)p[v][1], (double)p[v][2]);
    return ST_OK;
}

status mesh_leaf_check_loaded(const leaf_file *f, uint32_t t, const void *topology) {
    const subject x = subject_of(f, t, t, topology, topology);
    status st = check_children(&x);
    if (st == ST_OK)
        st = check_leaf_order(&x);
    if (st == ST_OK)
        st = check_leaves(&x);
    if (st == ST_OK)
        st = check_tets(&x);
    return st == ST_OK
               ? check_positions(&x, mesh_leaf_positions(&x.s, topology), f->mesh->bounds[t])
               : st;
}

status mesh_leaf_check_moved(const leaf_file *f, uint32_t step, uint32_t t, const void *positions) {
    const subject x = subject_of(f, t, leaf_layout_positions(&f->layout, step, t), NULL, positions);
    return check_positions(&x, mesh_leaf_moved(&x.s, positions),
                           f->mesh->bounds[leaf_layout_bounds(&f->layout, step, t)]);
}

/* ---- everything that can be recomputed ---- */

size_t mesh_leaf_check_scratch(const mesh_shape *s) {
    return s->nodes * sizeof(float[6]) + s->vertices;
}

static status check_zero(const subject *x, size_t from, size_t to) {
    for (size_t i = from; i < to; i++)
        if (x->bytes[i])
            return wrong(x, x->bytes + i, "expected 0 as padding, found %u", x->bytes[i]);
    return ST_OK;
}

static status check_code(const subject *x, const uint8_t *code, const char *what,
                         uint8_t expected) {
    if (*code == expected)
        return ST_OK;
    return wrong(x, code, "expected the %s code %u, found %u", what, expected, *code);
}

/* Widen a box of `axes` axes to contain lo .. hi: of a vertex, or of a child's box. */
static void widen(float *box, int axes, const float *lo, const float *hi) {
    for (int a = 0; a < axes; a++) {
        box[a] = lo[a] < box[a] ? lo[a] : box[a];
        box[axes + a] = hi[a] > box[axes + a] ? hi[a] : box[axes + a];
    }
}

static void empty_box(float *box, int axes) {
    for (int a = 0; a < axes; a++) {
        box[a] = INFINITY;
        box[axes + a] = -INFINITY;
    }
}

/* Find a child's box. Leaf: the box of `at` (`axes` numbers per vertex) over its tets, without
 * vertices that are not finite. Inner node: what was found for it, in `boxes`. */
static void child_box(const subject *x, const void *topology, uint16_t child, const float *at,
                      int axes, const float *boxes, float *box) {
    empty_box(box, axes);
    if (!(child & MESH_LEAF)) {
        const float *inner = boxes + (size_t)child * 2 * (size_t)axes;
        widen(box, axes, inner, inner + axes);
        return;
    }
    const uint16_t *first = mesh_leaf_first(&x->s, topology) + (child & ~MESH_LEAF);
    for (uint32_t i = first[0]; i < first[1]; i++)
        for (int corner = 0; corner < 4; corner++) {
            const float *v = at + (size_t)mesh_leaf_tets(&x->s, topology)[i][corner] * (size_t)axes;
            if (isfinite(v[0]))
                widen(box, axes, v, v);
        }
}

/* A step's positions and the codes of their boxes, which lie in the topology or in a payload of
 * their own. */
typedef struct placement {
    const float (*positions)[3];
    const float *bounds;
    const char *codes; /* mesh_boxes, `stride` bytes apart */
    size_t stride;
} placement;

static status check_boxes(const subject *x, const placement *p, const void *topology,
                          float *boxes) {
    const mesh_frame frame = mesh_leaf_frame(p->bounds);
    const float *at = p->positions[0];
    for (uint32_t n = x->s.nodes; n-- > 0;) {
        const uint16_t *child = x->nodes[n].child;
        const mesh_boxes *codes = (const mesh_boxes *)(p->codes + n * p->stride);
        float *all = boxes + (size_t)n * 6, box[6];
        empty_box(all, 3);
        for (int c = 0; c < MESH_CHILDREN; c++) {
            const bool absent = child[c] == MESH_NO_CHILD;
            if (!absent) {
                child_box(x, topology, child[c], at, 3, boxes, box);
                widen(all, 3, box, box + 3);
            }
            for (int a = 0; a < 3; a++) {
                status st = check_code(x, &codes->lo[a][c], "lower",
                                       absent ? 255 : mesh_leaf_code_lo(&frame, a, box[a]));
                if (st == ST_OK)
                    st = check_code(x, &codes->hi[a][c], "upper",
                                    absent ? 0 : mesh_leaf_code_hi(&frame, a, box[a + 3]));
                if (st != ST_OK)
                    return st;
            }
        }
    }
    return ST_OK;
}

static status check_bounds(const subject *x, const placement *at) {
    const float(*p)[3] = at->positions;
    const float *bounds = at->bounds;
    float box[6];
    empty_box(box, 3);
    for (uint32_t v = 0; v < x->s.vertices; v++)
        widen(box, 3, p[v], p[v]);
    for (int a = 0; a < 6; a++)
        if (box[a] != bounds[a])
            return wrong(x, p, "expected vertices within exactly %g .. %g along %c, found %g .. %g",
                         (double)bounds[a % 3], (double)bounds[a % 3 + 3], "xyz"[a % 3],
                         (double)box[a % 3], (double)box[a % 3 + 3]);
    return ST_OK;
}

static status check_used(const subject *x, uint8_t *used) {
    const uint16_t(*tet)[4] = mesh_leaf_tets(&x->s, x->bytes);
    memset(used, 0, x->s.vertices);
    for (uint32_t i = 0; i < x->s.tets; i++)
        for (int corner = 0; corner < 4; corner++)
            used[tet[i][corner]] = 1;
    for (uint32_t v = 0; v < x->s.vertices; v++)
        if (!used[v])
            return wrong(x, mesh_leaf_positions(&x->s, x->bytes)[v], "vertex %u is no tet's", v);
    return ST_OK;
}

status mesh_leaf_check_topology(const leaf_file *f, uint32_t t, const void *topology,
                                void *scratch) {
    const subject x = subject_of(f, t, t, topology, topology);
    const mesh_shape *s = &x.s;
    const placement p = {.positions = mesh_leaf_positions(s, topology),
                         .bounds = f->mesh->bounds[t],
                         .codes = topology,
                         .stride = sizeof(mesh_node)};
    status st = check_zero(&x, s->leaf_first_at + (s->leaves + 1) * sizeof(uint16_t), s->tets_at);
    if (st == ST_OK)
        st = check_zero(&x, s->tets_at + s->tets * sizeof(uint16_t[4]), s->positions_at);
    if (st == ST_OK)
        st = check_zero(&x, s->positions_at + s->vertices * sizeof(float[3]), s->topology_bytes);
    if (st == ST_OK)
        st = check_bounds(&x, &p);
    if (st == ST_OK)
        st = check_used(&x, (uint8_t *)scratch + s->nodes * sizeof(float[6]));
    return st == ST_OK ? check_boxes(&x, &p, topology, scratch) : st;
}

status mesh_leaf_check_positions(const leaf_file *f, uint32_t step, uint32_t t,
                                 const void *topology, const void *positions, void *scratch) {
    const subject x =
        subject_of(f, t, leaf_layout_positions(&f->layout, step, t), topology, positions);
    const mesh_shape *s = &x.s;
    const placement p = {.positions = mesh_leaf_moved(s, positions),
                         .bounds = f->mesh->bounds[leaf_layout_bounds(&f->layout, step, t)],
                         .codes = positions,
                         .stride = sizeof(mesh_boxes)};
    status st = check_zero(&x, s->nodes * sizeof(mesh_boxes), s->moved_at);
    if (st == ST_OK)
        st = check_zero(&x, s->moved_at + s->vertices * sizeof(float[3]), s->positions_bytes);
    if (st == ST_OK)
        st = check_bounds(&x, &p);
    return st == ST_OK ? check_boxes(&x, &p, topology, scratch) : st;
}

status mesh_leaf_check_gradients(const leaf_file *f, uint32_t set, uint32_t t,
                                 const void *gradients) {
    const subject x = subject_of(f, t, leaf_layout_gradients(&f->layout, set, t), NULL, gradients);
    const float(*g)[3] = mesh_leaf_gradients(gradients);
    for (uint32_t v = 0; v < x.s.vertices; v++)
        for (int a = 0; a < 3; a++)
            if (!isfinite(g[v][a]))
                return wrong(&x, &g[v][a], "expected a finite number, found %g", (double)g[v][a]);
    return check_zero(&x, x.s.vertices * sizeof(float[3]), x.s.gradients_bytes);
}

static status check_range(const subject *x, uint32_t set) {
    const size_t element = (size_t)set * x->f->layout.treelets + x->t;
    const float *own = x->f->own[element], *value = mesh_leaf_values(&x->s, x->bytes);
    float range[2];
    bool non_finite = false;
    empty_box(range, 1);
    for (uint32_t v = 0; v < x->s.vertices; v++)
        if (isfinite(value[v]))
            widen(range, 1, &value[v], &value[v]);
        else
            non_finite = true;
    if (range[0] != own[0] || range[1] != own[1])
        return wrong(x, value, "expected values in exactly %g .. %g, found %g .. %g",
                     (double)own[0], (double)own[1], (double)range[0], (double)range[1]);
    if (non_finite != ((x->f->flags[element] & LEAF_FLAG_NON_FINITE) != 0))
        return wrong(x, value, "expected %s non-finite values, as its flags say",
                     non_finite ? "no" : "some");
    return ST_OK;
}

static status check_value_codes(const subject *x, uint32_t set, const void *topology,
                                float *ranges) {
    const float *own = x->f->own[(size_t)set * x->f->layout.treelets + x->t];
    const quantizer q = quantizer_of(own[0], own[1], SAMPLE_F32);
    const mesh_codes *codes = mesh_leaf_codes(x->bytes);
    for (uint32_t n = x->s.nodes; n-- > 0;) {
        float *all = ranges + (size_t)n * 2;
        empty_box(all, 1);
        for (int c = 0; c < MESH_CHILDREN; c++) {
            const uint16_t child = x->nodes[n].child[c];
            float range[2];
            empty_box(range, 1);
            if (child != MESH_NO_CHILD)
                child_box(x, topology, child, mesh_leaf_values(&x->s, x->bytes), 1, ranges, range);
            widen(all, 1, range, range + 1);
            const bool empty = range[0] > range[1];
            status st = check_code(x, &codes[n].lo[c], "lowest",
                                   empty ? 255 : quantizer_floor(&q, (double)range[0]));
            if (st == ST_OK)
                st = check_code(x, &codes[n].hi[c], "highest",
                                empty ? 0 : quantizer_ceil(&q, (double)range[1]));
            if (st != ST_OK)
                return st;
        }
    }
    return ST_OK;
}

status mesh_leaf_check_values(const leaf_file *f, uint32_t set, uint32_t t, const void *topology,
                              const void *values, void *scratch) {
    const subject x = subject_of(f, t, leaf_layout_values(&f->layout, set, t), topology, values);
    const mesh_shape *s = &x.s;
    status st = check_zero(&x, s->nodes * sizeof(mesh_codes), s->values_at);
    if (st == ST_OK)
        st = check_zero(&x, s->values_at + s->vertices * sizeof(float), s->values_bytes);
    if (st == ST_OK)
        st = check_range(&x, set);
    return st == ST_OK ? check_value_codes(&x, set, topology, scratch) : st;
}
