/* The streams of a topology:
 *
 *   0     u8 children[nodes], u8 inner[nodes]   of each node: how many; bit c: child c is a node
 *         u8 leaf[leaves]                       of each leaf: how many tets
 *   1 ..  tets and positions                    mesh_corner_coder.h
 *   last  mesh_boxes[nodes]                     if they are stored
 */
#include "formats/mesh/mesh_topology_coder.h"

#include <string.h>

#include "formats/mesh/mesh_corner_coder.h"
#include "formats/mesh/mesh_implied_boxes.h"

size_t mesh_topology_room(const mesh_shape *s) {
    return s->nodes * (2 + sizeof(mesh_boxes)) + s->leaves + mesh_corners_room(s);
}

size_t mesh_topology_scratch(const mesh_shape *s) {
    return mesh_corners_scratch(s);
}

/* ---- the tree ---- */

static void encode_tree(const mesh_shape *s, const void *payload, coded_streams *out) {
    const mesh_node *nodes = mesh_leaf_nodes(payload);
    const uint16_t *first = mesh_leaf_first(s, payload);
    uint8_t *children = coded_streams_take(out, s->nodes);
    uint8_t *inner = coded_streams_take(out, s->nodes);
    uint8_t *leaf = coded_streams_take(out, s->leaves);
    for (uint32_t n = 0; n < s->nodes; n++) {
        uint8_t c = 0, mask = 0;
        for (; c < MESH_CHILDREN && nodes[n].child[c] != MESH_NO_CHILD; c++)
            if (!(nodes[n].child[c] & MESH_LEAF))
                mask |= (uint8_t)(1U << c);
        children[n] = c;
        inner[n] = mask;
    }
    for (uint32_t l = 0; l < s->leaves; l++)
        leaf[l] = (uint8_t)(first[l + 1] - first[l]);
    coded_streams_end(out);
}

/* Number inner nodes in the order in which they are met. Leaves get their numbers afterwards. */
static bool decode_children(const mesh_shape *s, const uint8_t *children, const uint8_t *inner,
                            mesh_node *nodes) {
    uint32_t next = 1;
    for (uint32_t n = 0; n < s->nodes; n++) {
        if (n >= next || children[n] > MESH_CHILDREN || inner[n] >> children[n])
            return false;
        for (int c = 0; c < MESH_CHILDREN; c++)
            if (c >= children[n])
                nodes[n].child[c] = MESH_NO_CHILD;
            else
                nodes[n].child[c] = inner[n] >> c & 1 ? (uint16_t)next++ : MESH_LEAF;
    }
    return next == s->nodes;
}

/* Number leaves as a walk down from the root meets them, children in order. Each inner node is
 * behind its parent and is the child of one node alone, so the walk ends. */
static bool number_leaves(const mesh_shape *s, mesh_node *nodes) {
    struct {
        uint16_t node, child;
    } path[MESH_DEPTH_MAX] = {{0, 0}};
    uint32_t leaf = 0;
    for (int depth = 0; depth >= 0;) {
        uint16_t *child = nodes[path[depth].node].child;
        const uint16_t c = path[depth].child++;
        if (c == MESH_CHILDREN || child[c] == MESH_NO_CHILD) {
            depth--;
        } else if (child[c] & MESH_LEAF) {
            child[c] = (uint16_t)(MESH_LEAF | leaf++);
        } else {
            if (++depth == MESH_DEPTH_MAX)
                return false;
            path[depth].node = child[c];
            path[depth].child = 0;
        }
    }
    return leaf == s->leaves;
}

static bool decode_leaves(const mesh_shape *s, const uint8_t *leaf, uint16_t *first) {
    uint32_t sum = 0;
    first[0] = 0;
    for (uint32_t l = 0; l < s->leaves; l++) {
        if (!leaf[l])
            return false;
        sum += leaf[l];
        first[l + 1] = (uint16_t)sum;
    }
    return sum == s->tets;
}

static bool decode_tree(const mesh_shape *s, coded_input *in, uint8_t *payload) {
    mesh_node *nodes = (mesh_node *)payload;
    const uint8_t *children = coded_input_take(in, s->nodes);
    const uint8_t *inner = coded_input_take(in, s->nodes);
    const uint8_t *leaf = coded_input_take(in, s->leaves);
    return children && inner && leaf && decode_children(s, children, inner, nodes) &&
           number_leaves(s, nodes) &&
           decode_leaves(s, leaf, (uint16_t *)(payload + s->leaf_first_at));
}

/* ---- boxes that are stored ---- */

static void encode_boxes(const mesh_shape *s, const void *payload, coded_streams *out) {
    const mesh_node *nodes = mesh_leaf_nodes(payload);
    uint8_t *to = coded_streams_take(out, s->nodes * sizeof(mesh_boxes));
    for (uint32_t n = 0; n < s->nodes; n++)
        memcpy(to + n * sizeof(mesh_boxes), &nodes[n], sizeof(mesh_boxes));
    coded_streams_end(out);
}

static void decode_boxes(const mesh_shape *s, const uint8_t *boxes, mesh_node *nodes) {
    for (uint32_t n = 0; n < s->nodes; n++)
        memcpy(&nodes[n], boxes + n * sizeof(mesh_boxes), sizeof(mesh_boxes));
}

/* ---- all of it ---- */

bool mesh_topology_encode(mesh_topology_way way, const mesh_shape *s, const void *payload,
                          uint8_t *scratch, coded_streams *out) {
    encode_tree(s, payload, out);
    if (!mesh_corners_encode(s, payload, scratch, out))
        return false;
    if (way == MESH_BOXES_STORED)
        encode_boxes(s, payload, out);
    return true;
}

bool mesh_topology_decode(mesh_topology_way way, const mesh_shape *s, const float bounds[6],
                          coded_input *in, void *payload) {
    memset(payload, 0, s->topology_bytes);
    if (!decode_tree(s, in, payload))
        return false;
    /* What is left without the boxes is the tets'. */
    const size_t boxes_bytes = way == MESH_BOXES_STORED ? s->nodes * sizeof(mesh_boxes) : 0;
    if (in->left < boxes_bytes)
        return false;
    coded_input corners = {in->at, in->left - boxes_bytes};
    const uint8_t *boxes = corners.at + corners.left;
    if (!mesh_corners_decode(s, &corners, payload))
        return false;
    if (way == MESH_BOXES_IMPLIED)
        return mesh_implied_boxes(s, bounds, payload);
    decode_boxes(s, boxes, payload);
    return true;
}
