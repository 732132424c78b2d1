#include "formats/mesh/mesh_coder.h"

#include <string.h>

#include "formats/leaf/coded_payload.h"
#include "formats/leaf/float_planes.h"
#include "formats/mesh/mesh_leaf.h"
#include "formats/mesh/mesh_topology_coder.h"

/* The parts of a payload but a topology: codes of nodes, and floats of vertices. */
typedef struct parts {
    size_t code_axes, code_bytes; /* per axis and node: 8 lo, 8 hi; bytes of all nodes */
    size_t axes, floats_at, floats_bytes;
    size_t bytes;
} parts;

static parts parts_of(leaf_block block, const mesh_shape *s) {
    parts p = {.axes = block == LEAF_BLOCK_VALUES ? 1 : 3};
    p.floats_bytes = s->vertices * p.axes * sizeof(float);
    if (block == LEAF_BLOCK_VALUES) {
        p.code_axes = 1;
        p.floats_at = s->values_at;
        p.bytes = s->values_bytes;
    } else if (block == LEAF_BLOCK_GRADIENTS) {
        p.bytes = s->gradients_bytes;
    } else {
        p.code_axes = 3;
        p.floats_at = s->moved_at;
        p.bytes = s->positions_bytes;
    }
    p.code_bytes = s->nodes * p.code_axes * 2 * MESH_CHILDREN;
    return p;
}

/* ---- sizes ---- */

static size_t bytes_of(leaf_block block, const uint32_t counts[4]) {
    const mesh_shape s = mesh_leaf_shape(counts);
    return block == LEAF_BLOCK_TOPOLOGY ? s.topology_bytes : parts_of(block, &s).bytes;
}

static size_t room_of(leaf_block block, const uint32_t counts[4]) {
    const mesh_shape s = mesh_leaf_shape(counts);
    const parts p = parts_of(block, &s);
    const size_t coded = block == LEAF_BLOCK_TOPOLOGY ? mesh_topology_room(&s)
                                                      : s.nodes + p.code_bytes + p.floats_bytes;
    const size_t stored = bytes_of(block, counts);
    return 1 + (coded > stored ? coded : stored);
}

static size_t scratch_of(const uint32_t counts[4]) {
    const mesh_shape s = mesh_leaf_shape(counts);
    return s.topology_bytes + mesh_topology_scratch(&s);
}

/* ---- codes of nodes ----
 *
 * A byte a node: how many children there are, up to the last that has codes other than 255, 0 on
 * all axes. Then for axis after axis, for each of those children: lo, less that of the child
 * before; in a second stream hi, less lo. */

static bool is_empty(const uint8_t *node, size_t axes, size_t child) {
    for (size_t a = 0; a < axes; a++)
        if (node[a * MESH_CHILDREN + child] != 255 || node[(axes + a) * MESH_CHILDREN + child] != 0)
            return false;
    return true;
}

static size_t count_children(const uint8_t *codes, size_t nodes, size_t axes, uint8_t *children) {
    size_t sum = 0;
    for (size_t n = 0; n < nodes; n++) {
        uint8_t count = MESH_CHILDREN;
        while (count > 0 && is_empty(codes + n * axes * 2 * MESH_CHILDREN, axes, count - 1U))
            count--;
        children[n] = count;
        sum += count;
    }
    return sum;
}

static void encode_codes(const uint8_t *codes, size_t nodes, size_t axes, coded_streams *out) {
    uint8_t *children = coded_streams_take(out, nodes);
    const size_t sum = count_children(codes, nodes, axes, children);
    uint8_t *lo = coded_streams_take(out, sum * axes);
    coded_streams_end(out);
    uint8_t *hi = coded_streams_take(out, sum * axes);
    coded_streams_end(out);
    for (size_t a = 0; a < axes; a++) {
        uint8_t before = 0;
        for (size_t n = 0; n < nodes; n++) {
            const uint8_t *row = codes + (n * 2 * axes + a) * MESH_CHILDREN;
            for (uint8_t c = 0; c < children[n]; c++) {
                *lo++ = (uint8_t)(row[c] - before);
                *hi++ = (uint8_t)(row[axes * MESH_CHILDREN + c] - row[c]);
                before = row[c];
            }
        }
    }
}

/* Set *sum to the children of all nodes. Returns false if a node has too many. */
static bool sum_children(const uint8_t *children, size_t nodes, size_t *sum) {
    *sum = 0;
    for (size_t n = 0; n < nodes; n++) {
        if (children[n] > MESH_CHILDREN)
            return false;
        *sum += children[n];
    }
    return true;
}

static bool decode_codes(coded_input *in, size_t nodes, size_t axes, uint8_t *codes) {
    const uint8_t *children = coded_input_take(in, nodes);
    size_t sum;
    if (!children || !sum_children(children, nodes, &sum))
        return false;
    const uint8_t *lo = coded_input_take(in, sum * axes), *hi = coded_input_take(in, sum * axes);
    if (!lo || !hi)
        return false;
    for (size_t a = 0; a < axes; a++) {
        uint8_t before = 0;
        for (size_t n = 0; n < nodes; n++) {
            uint8_t *row = codes + (n * 2 * axes + a) * MESH_CHILDREN;
            memset(row, 255, MESH_CHILDREN);
            memset(row + axes * MESH_CHILDREN, 0, MESH_CHILDREN);
            for (uint8_t c = 0; c < children[n]; c++) {
                before = (uint8_t)(before + *lo++);
                row[c] = before;
                row[axes * MESH_CHILDREN + c] = (uint8_t)(before + *hi++);
            }
        }
    }
    return true;
}

/* ---- values, gradients, positions at a step ---- */

static void encode_parts(const parts *p, const mesh_shape *s, const uint8_t *payload,
                         coded_streams *out) {
    if (p->code_axes)
        encode_codes(payload, s->nodes, p->code_axes, out);
    uint8_t *planes = coded_streams_take(out, p->floats_bytes);
    float_planes_encode(payload + p->floats_at, s->vertices, p->axes, planes);
    coded_payload_end_planes(out, FLOAT_PLANES, p->floats_bytes / FLOAT_PLANES);
}

static bool decode_parts(const parts *p, const mesh_shape *s, coded_input *in, uint8_t *payload) {
    if (p->code_axes && !decode_codes(in, s->nodes, p->code_axes, payload))
        return false;
    const uint8_t *planes = coded_input_take(in, p->floats_bytes);
    if (!planes || in->left)
        return false;
    float_planes_decode(planes, s->vertices, p->axes, payload + p->floats_at);
    memset(payload + p->code_bytes, 0, p->floats_at - p->code_bytes);
    memset(payload + p->floats_at + p->floats_bytes, 0, p->bytes - p->floats_at - p->floats_bytes);
    return true;
}

/* ---- topologies ---- */

/* Encode one way, and see whether the payload comes back. */
static bool try_topology(mesh_topology_way way, const mesh_shape *s, const float bounds[6],
                         const uint8_t *payload, uint8_t *scratch, coded_streams *out) {
    coded_payload_begin((uint8_t)way, out);
    if (!mesh_topology_encode(way, s, payload, scratch + s->topology_bytes, out))
        return false;
    coded_input in = {out->bytes + 1, out->used - 1};
    return mesh_topology_decode(way, s, bounds, &in, scratch) &&
           memcmp(scratch, payload, s->topology_bytes) == 0;
}

/* ---- all blocks ---- */

static void encode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const void *payload, void *scratch, coded_streams *out) {
    const mesh_shape s = mesh_leaf_shape(counts);
    const uint8_t *bytes = payload;
    assert(out->room >= room_of(block, counts));
    if (block == LEAF_BLOCK_TOPOLOGY) {
        if (!try_topology(MESH_BOXES_IMPLIED, &s, bounds, bytes, scratch, out) &&
            !try_topology(MESH_BOXES_STORED, &s, bounds, bytes, scratch, out))
            coded_payload_store(bytes, s.topology_bytes, out);
        return;
    }
    const parts p = parts_of(block, &s);
    if (!coded_payload_is_zero(bytes, p.code_bytes, p.floats_at) ||
        !coded_payload_is_zero(bytes, p.floats_at + p.floats_bytes, p.bytes)) {
        coded_payload_store(bytes, p.bytes, out);
        return;
    }
    coded_payload_begin(CODED_STREAMS, out);
    encode_parts(&p, &s, bytes, out);
}

static bool decode(leaf_block block, const uint32_t counts[4], const float bounds[6],
                   const uint8_t *in, size_t bytes, void *payload) {
    const mesh_shape s = mesh_leaf_shape(counts);
    coded_input rest = {in, bytes};
    const uint8_t *way = coded_input_take(&rest, 1);
    if (!way)
        return false;
    if (*way == CODED_STORED)
        return coded_payload_stored(&rest, payload, bytes_of(block, counts));
    if (block == LEAF_BLOCK_TOPOLOGY)
        return (*way == MESH_BOXES_IMPLIED || *way == MESH_BOXES_STORED) &&
               mesh_topology_decode((mesh_topology_way)*way, &s, bounds, &rest, payload);
    const parts p = parts_of(block, &s);
    return *way == CODED_STREAMS && decode_parts(&p, &s, &rest, payload);
}

const leaf_coder mesh_coder = {
    .bytes = bytes_of, .room = room_of, .scratch = scratch_of, .encode = encode, .decode = decode};
