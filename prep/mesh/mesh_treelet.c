#include "prep/mesh/mesh_treelet.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/base/exact.h"
#include "prep/mesh/mesh_fetch.h"
#include "prep/mesh/mesh_tree.h"

/* Codes of a box and a range of values: lo of x, y, z, value, then 255 - hi of the same. So the
 * union of two has the smaller of each byte. If only the box or the range is wanted, the other one
 * is left over from the treelet before. */
typedef struct codes {
    uint8_t byte[8];
} codes;

struct mesh_treelet_builder {
    mem *m;
    uint32_t treelet_tets;
    mesh_vertices vertices;
    mesh_tree tree;
    codes *vertex_codes;
    codes *node_codes;
    char *topology, *values;
    char *positions; /* of a further step; NULL: there has been none */
    size_t positions_room;
    mesh_shape shape; /* of the current treelet */
};

/* ---- sizes ---- */

void mesh_treelet_counts_max(uint32_t treelet_tets, uint32_t leaf_tets, uint32_t counts[4]) {
    counts[0] = counts[3] = treelet_tets;
    counts[1] = 4 * treelet_tets;
    counts[2] = mesh_tree_nodes_max(treelet_tets, leaf_tets);
}

static mesh_shape largest_shape(uint32_t treelet_tets, uint32_t leaf_tets) {
    uint32_t counts[4];
    mesh_treelet_counts_max(treelet_tets, leaf_tets, counts);
    return mesh_leaf_shape(counts);
}

size_t mesh_treelet_payload_max(uint32_t treelet_tets, uint32_t leaf_tets) {
    return largest_shape(treelet_tets, leaf_tets).topology_bytes;
}

uint64_t mesh_treelet_memory(uint32_t treelet_tets, uint32_t leaf_tets) {
    const mesh_shape s = largest_shape(treelet_tets, leaf_tets);
    return sizeof(mesh_treelet_builder) + mesh_vertices_memory(treelet_tets, 4) +
           mesh_tree_memory(treelet_tets, leaf_tets) +
           ((uint64_t)s.vertices + s.nodes) * sizeof(codes) + s.topology_bytes + s.values_bytes +
           1024;
}

uint64_t mesh_treelet_moved_memory(uint32_t treelet_tets, uint32_t leaf_tets) {
    return largest_shape(treelet_tets, leaf_tets).positions_bytes + 128;
}

status mesh_treelet_create(mem *m, uint32_t treelet_tets, uint32_t leaf_tets,
                           mesh_treelet_builder **out) {
    mesh_treelet_builder *b = mem_zalloc(m, sizeof *b);
    if (!b)
        return ST_NOMEM;
    const mesh_shape s = largest_shape(treelet_tets, leaf_tets);
    b->m = m;
    b->treelet_tets = treelet_tets;
    b->positions_room = s.positions_bytes;
    status st = mesh_vertices_init(&b->vertices, m, treelet_tets, 4);
    if (st == ST_OK)
        st = mesh_tree_init(&b->tree, m, treelet_tets, leaf_tets);
    if (st == ST_OK) {
        b->vertex_codes = mem_array(m, s.vertices, sizeof *b->vertex_codes);
        b->node_codes = mem_alloc(m, s.nodes * sizeof *b->node_codes);
        b->topology = mem_alloc(m, s.topology_bytes);
        b->values = mem_alloc(m, s.values_bytes);
        if (!b->vertex_codes || !b->node_codes || !b->topology || !b->values)
            st = ST_NOMEM;
    }
    if (st != ST_OK) {
        mesh_treelet_destroy(b);
        return st;
    }
    *out = b;
    return ST_OK;
}

void mesh_treelet_destroy(mesh_treelet_builder *b) {
    if (!b)
        return;
    mesh_vertices_release(&b->vertices);
    mesh_tree_release(&b->tree);
    mem_free(b->m, b->vertex_codes);
    mem_free(b->m, b->node_codes);
    mem_free(b->m, b->topology);
    mem_free(b->m, b->values);
    mem_free(b->m, b->positions);
    mem_free(b->m, b);
}

/* ---- vertices ---- */

/* Compute mesh_leaf_code_lo() and mesh_leaf_code_hi() of a coordinate within the bounds. Start at a
 * guess, one or two steps away, instead of searching. */
static void code_coordinate(const mesh_frame *f, int axis, double per_step, float at, uint8_t *lo,
                            uint8_t *hi) {
    const double guess = ((double)at - (double)f->lo[axis]) * per_step;
    int code = guess < 255 ? (int)guess : 255;
    while (code < 255 && mesh_leaf_plane(f, axis, code) < at)
        code++;
    while (code > 0 && mesh_leaf_plane(f, axis, code - 1) >= at)
        code--;
    *hi = (uint8_t)code;
    if (code > 0 && mesh_leaf_plane(f, axis, code) != at)
        for (code--; code > 0; code--)
            if (mesh_leaf_plane(f, axis, code - 1) != mesh_leaf_plane(f, axis, code))
                break;
    *lo = (uint8_t)code;
}

static void code_positions(codes *to, const float (*position)[3], uint32_t count,
                           const float bounds[6]) {
    const mesh_frame f = mesh_leaf_frame(bounds);
    double per_step[3];
    for (int a = 0; a < 3; a++)
        per_step[a] = f.step[a] > 0 ? 1.0 / (double)f.step[a] : 0;
    for (uint32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            uint8_t hi;
            code_coordinate(&f, a, per_step[a], position[i][a], &to[i].byte[a], &hi);
            to[i].byte[4 + a] = (uint8_t)(255 - hi);
        }
}

static void code_values(codes *to, const float *value, uint32_t count, const leaf_entry *e) {
    const quantizer q = quantizer_of(e->own[0], e->own[1], SAMPLE_F32);
    for (uint32_t i = 0; i < count; i++) {
        const bool finite = isfinite(value[i]);
        to[i].byte[3] = finite ? quantizer_floor(&q, (double)value[i]) : 255;
        to[i].byte[7] = (uint8_t)(255 - (finite ? quantizer_ceil(&q, (double)value[i]) : 0));
    }
}

/* ---- tets ---- */

static inline void order(uint16_t *a, uint16_t *b) {
    const uint16_t low = *a < *b ? *a : *b, high = *a < *b ? *b : *a;
    *a = low;
    *b = high;
}

static inline void place_tet(uint16_t to[4], const uint16_t corners[4]) {
    memcpy(to, corners, sizeof(uint16_t[4]));
    order(&to[0], &to[1]);
    order(&to[2], &to[3]);
    order(&to[0], &to[2]);
    order(&to[1], &to[3]);
    order(&to[1], &to[2]);
}

static void place_tets(const mesh_treelet_builder *b, uint16_t (*to)[4]) {
    for (uint32_t t = 0; t < b->shape.tets; t++)
        place_tet(to[t], b->vertices.corners + 4 * (size_t)t);
}

static int orientation_of(const float (*position)[3], const uint16_t corners[4]) {
    double p[4][3];
    for (int k = 0; k < 4; k++)
        for (int a = 0; a < 3; a++)
            p[k][a] = (double)position[corners[k]][a];
    return exact_orientation((const double(*)[3])p);
}

static void count_signs(const mesh_treelet_builder *b, const float (*position)[3],
                        mesh_treelet *out) {
    for (uint32_t t = 0; t < b->shape.tets; t++) {
        const int sign = orientation_of(position, b->vertices.corners + 4 * (size_t)t);
        out->positive += sign > 0;
        out->negative += sign < 0;
        out->flat += sign == 0;
    }
}

/* ---- the tree's codes ---- */

static inline codes join(codes a, codes b) {
    for (int i = 0; i < 8; i++)
        a.byte[i] = a.byte[i] < b.byte[i] ? a.byte[i] : b.byte[i];
    return a;
}

static codes join_tets(const mesh_treelet_builder *b, const uint16_t (*tets)[4], uint32_t first,
                       uint32_t end) {
    codes all;
    memset(&all, 255, sizeof all);
    for (uint32_t t = first; t < end; t++)
        for (int c = 0; c < 4; c++)
            all = join(all, b->vertex_codes[tets[t][c]]);
    return all;
}

static void set_box(mesh_boxes *n, uint32_t c, codes box) {
    for (int a = 0; a < 3; a++) {
        n->lo[a][c] = box.byte[a];
        n->hi[a][c] = (uint8_t)(255 - box.byte[4 + a]);
    }
}

static void set_range(mesh_codes *v, uint32_t c, codes box) {
    v->lo[c] = box.byte[3];
    v->hi[c] = (uint8_t)(255 - box.byte[7]);
}

/* Code the children's boxes, `stride` bytes from node to node, or their ranges of values, or both.
 * Children are stored behind their parents, so go from the last node to the first. */
static void code_nodes(mesh_treelet_builder *b, char *boxes, size_t stride, mesh_codes *values) {
    const uint16_t(*tets)[4] = mesh_leaf_tets(&b->shape, b->topology);
    for (uint32_t i = b->shape.nodes; i-- > 0;) {
        const mesh_tree_node *n = &b->tree.node[i];
        mesh_boxes *box_codes = boxes ? (mesh_boxes *)(boxes + i * stride) : NULL;
        codes all;
        memset(&all, 255, sizeof all);
        if (boxes) {
            memset(box_codes->lo, 255, sizeof box_codes->lo);
            memset(box_codes->hi, 0, sizeof box_codes->hi);
        }
        if (values) {
            memset(values[i].lo, 255, sizeof values[i].lo);
            memset(values[i].hi, 0, sizeof values[i].hi);
        }
        for (uint32_t c = 0; c < n->children; c++) {
            const codes box = n->child[c] & MESH_LEAF
                                  ? join_tets(b, tets, n->first[c], n->first[c + 1])
                                  : b->node_codes[n->child[c]];
            if (boxes)
                set_box(box_codes, c, box);
            if (values)
                set_range(&values[i], c, box);
            all = join(all, box);
        }
        b->node_codes[i] = all;
    }
}

static void place_children(const mesh_treelet_builder *b) {
    mesh_node *nodes = (mesh_node *)b->topology;
    for (uint32_t i = 0; i < b->shape.nodes; i++)
        memcpy(nodes[i].child, b->tree.node[i].child, sizeof nodes[i].child);
}

static void place_leaves(const mesh_tree *t, uint16_t *first, uint32_t tets) {
    for (uint32_t i = 0; i < t->nodes; i++)
        for (uint32_t c = 0; c < t->node[i].children; c++)
            if (t->node[i].child[c] & MESH_LEAF)
                first[t->node[i].child[c] & ~MESH_LEAF] = (uint16_t)t->node[i].first[c];
    first[t->leaves] = (uint16_t)tets;
}

/* ---- all of it ---- */

static void clear_pad(char *payload, uint32_t from, uint32_t to) {
    memset(payload + from, 0, to - from);
}

static void clear_topology_pads(const mesh_treelet_builder *b) {
    const mesh_shape *s = &b->shape;
    clear_pad(b->topology, s->leaf_first_at + (s->leaves + 1) * (uint32_t)sizeof(uint16_t),
              s->tets_at);
    clear_pad(b->topology, s->tets_at + s->tets * (uint32_t)sizeof(uint16_t[4]), s->positions_at);
    clear_pad(b->topology, s->positions_at + s->vertices * (uint32_t)sizeof(float[3]),
              s->topology_bytes);
}

void mesh_treelet_begin(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                        mesh_treelet *out) {
    assert(count > 0 && count <= b->treelet_tets);
    mesh_vertices_number(&b->vertices, records->id, sizeof *records, count);
    mesh_tree_build(&b->tree, records, count);
    *out = (mesh_treelet){
        .counts = {(uint32_t)count, b->vertices.count, b->tree.nodes, b->tree.leaves}};
    b->shape = mesh_leaf_shape(out->counts);
    place_tets(b, (uint16_t(*)[4])(b->topology + b->shape.tets_at));
}

uint32_t mesh_treelet_point(const mesh_treelet_builder *b, uint32_t vertex) {
    return mesh_vertices_id(&b->vertices, vertex);
}

/* Take the values. Sets their range and, in vertex_codes, their codes. */
static status take_values(mesh_treelet_builder *b, mesh_pages *values, mesh_treelet *out) {
    const mesh_shape *s = &b->shape;
    float *value = (float *)(b->values + s->values_at);
    clear_pad(b->values, s->nodes * (uint32_t)sizeof(mesh_codes), s->values_at);
    clear_pad(b->values, s->values_at + s->vertices * (uint32_t)sizeof(float), s->values_bytes);
    status st = mesh_fetch(&b->vertices, values, value, sizeof *value);
    if (st != ST_OK)
        return st;
    out->entry = mesh_fetch_range(value, s->vertices);
    code_values(b->vertex_codes, value, s->vertices, &out->entry);
    out->values = b->values;
    return ST_OK;
}

status mesh_treelet_revalue(mesh_treelet_builder *b, mesh_pages *values, mesh_treelet *out) {
    status st = take_values(b, values, out);
    if (st == ST_OK)
        code_nodes(b, NULL, 0, (mesh_codes *)b->values);
    return st;
}

status mesh_treelet_move(mesh_treelet_builder *b, mesh_pages *points, mesh_treelet *out) {
    const mesh_shape *s = &b->shape;
    if (!b->positions)
        b->positions = mem_alloc(b->m, b->positions_room);
    if (!b->positions)
        return ST_NOMEM;
    float(*position)[3] = (float(*)[3])(b->positions + s->moved_at);
    clear_pad(b->positions, s->nodes * (uint32_t)sizeof(mesh_boxes), s->moved_at);
    clear_pad(b->positions, s->moved_at + s->vertices * (uint32_t)sizeof *position,
              s->positions_bytes);
    status st = mesh_fetch(&b->vertices, points, position, sizeof *position);
    if (st != ST_OK)
        return st;
    mesh_fetch_bounds((const float(*)[3])position, s->vertices, out->moved_bounds);
    code_positions(b->vertex_codes, (const float(*)[3])position, s->vertices, out->moved_bounds);
    code_nodes(b, b->positions, sizeof(mesh_boxes), NULL);
    out->positions = b->positions;
    return ST_OK;
}

status mesh_treelet_build(mesh_treelet_builder *b, const mesh_record *records, size_t count,
                          mesh_pages *points, mesh_pages *values, mesh_treelet *out) {
    mesh_treelet_begin(b, records, count, out);
    float(*position)[3] = (float(*)[3])(b->topology + b->shape.positions_at);
    clear_topology_pads(b);
    status st = mesh_fetch(&b->vertices, points, position, sizeof *position);
    if (st == ST_OK)
        st = take_values(b, values, out);
    if (st != ST_OK)
        return st;
    mesh_fetch_bounds((const float(*)[3])position, b->shape.vertices, out->bounds);
    code_positions(b->vertex_codes, (const float(*)[3])position, b->shape.vertices, out->bounds);
    count_signs(b, (const float(*)[3])position, out);
    place_leaves(&b->tree, (uint16_t *)(b->topology + b->shape.leaf_first_at), (uint32_t)count);
    place_children(b);
    code_nodes(b, b->topology, sizeof(mesh_node), (mesh_codes *)b->values);
    out->topology = b->topology;
    return ST_OK;
}

status mesh_treelet_gradients(mesh_treelet_builder *b, const mesh_treelet *t, mesh_pages *gradients,
                              const void **payload) {
    const mesh_shape s = mesh_leaf_shape(t->counts);
    assert(s.gradients_bytes <= s.topology_bytes);
    for (uint32_t i = 0; i < s.vertices; i++) {
        const void *g = mesh_pages_at(gradients, mesh_vertices_id(&b->vertices, i));
        if (!g)
            return gradients->st;
        memcpy(b->topology + i * sizeof(float[3]), g, sizeof(float[3]));
    }
    const size_t end = s.vertices * sizeof(float[3]);
    memset(b->topology + end, 0, s.gradients_bytes - end);
    *payload = b->topology;
    return ST_OK;
}
