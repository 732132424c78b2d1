#include "formats/mesh/mesh_leaf.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

#include "formats/leaf/leaf.h"

/* ---- shapes ---- */

mesh_shape mesh_leaf_shape(const uint32_t counts[4]) {
    mesh_shape s = {
        .tets = counts[0], .vertices = counts[1], .nodes = counts[2], .leaves = counts[3]};
    s.leaf_first_at = s.nodes * (uint32_t)sizeof(mesh_node);
    s.tets_at = leaf_aligned(s.leaf_first_at + (s.leaves + 1) * (uint32_t)sizeof(uint16_t));
    s.positions_at = leaf_aligned(s.tets_at + s.tets * (uint32_t)sizeof(uint16_t[4]));
    s.topology_bytes = leaf_aligned(s.positions_at + s.vertices * (uint32_t)sizeof(float[3]));
    s.values_at = leaf_aligned(s.nodes * (uint32_t)sizeof(mesh_codes));
    s.values_bytes = leaf_aligned(s.values_at + s.vertices * (uint32_t)sizeof(float));
    s.gradients_bytes = leaf_aligned(s.vertices * (uint32_t)sizeof(float[3]));
    s.moved_at = leaf_aligned(s.nodes * (uint32_t)sizeof(mesh_boxes));
    s.positions_bytes = leaf_aligned(s.moved_at + s.vertices * (uint32_t)sizeof(float[3]));
    return s;
}

const char *mesh_leaf_counts_fault(const uint32_t counts[4], uint32_t treelet_tets,
                                   uint32_t leaf_tets) {
    const uint32_t tets = counts[0], vertices = counts[1], nodes = counts[2], leaves = counts[3];
    if (tets < 1 || tets > treelet_tets)
        return "as many tets";
    if (vertices < 4 || vertices > 4 * tets)
        return "as many vertices";
    if (leaves < 1 || leaves > tets || (uint64_t)leaves * leaf_tets < tets)
        return "as many leaves";
    /* Nodes have 2 to 8 children, and all but the root are a child. */
    if (nodes < 1 || (nodes > 1 && nodes >= leaves) || leaves > 7 * nodes + 1)
        return "as many nodes";
    return NULL;
}

/* ---- planes ---- */

static float from_bits(uint32_t bits) {
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* Returns the step of mesh_leaf_frame(). Bisect the floats of 16 significant bits: without their
 * last 8 bits, which are zero, their bits count them in ascending order. */
static float smallest_step(float lo, float hi) {
    uint32_t below = 0, enough = 0x7f7fff; /* the largest finite one */
    if (hi <= lo)
        return 0;
    while (below + 1 < enough) {
        const uint32_t middle = (below + enough) / 2;
        mesh_frame f = {.lo = {lo}, .step = {from_bits(middle << 8)}};
        if (mesh_leaf_plane(&f, 0, 255) >= hi)
            enough = middle;
        else
            below = middle;
    }
    return from_bits(enough << 8);
}

mesh_frame mesh_leaf_frame(const float bounds[6]) {
    mesh_frame f;
    for (int a = 0; a < 3; a++) {
        f.lo[a] = bounds[a];
        f.step[a] = smallest_step(bounds[a], bounds[a + 3]);
    }
    return f;
}

/* Returns the smallest code whose plane is >= at. Plane 255 must be. */
static int search(const mesh_frame *f, int axis, float at) {
    int first = 0, end = 255;
    while (first < end) {
        const int middle = (first + end) / 2;
        if (mesh_leaf_plane(f, axis, middle) >= at)
            end = middle;
        else
            first = middle + 1;
    }
    return first;
}

static bool is_first(const mesh_frame *f, int axis, int code, float at) {
    return mesh_leaf_plane(f, axis, code) >= at &&
           (code == 0 || mesh_leaf_plane(f, axis, code - 1) < at);
}

/* Returns the same as search(), but tries a guess first, which is mostly right. */
static int first_at_or_above(const mesh_frame *f, int axis, float at) {
    const float guess = (at - f->lo[axis]) / f->step[axis];
    if (!(guess < 255))
        return search(f, axis, at);
    const int code = (int)guess;
    if (is_first(f, axis, code + 1, at))
        return code + 1;
    return is_first(f, axis, code, at) ? code : search(f, axis, at);
}

uint8_t mesh_leaf_code_hi(const mesh_frame *f, int axis, float at) {
    assert(at >= f->lo[axis] && at <= mesh_leaf_plane(f, axis, 255));
    return (uint8_t)first_at_or_above(f, axis, at);
}

uint8_t mesh_leaf_code_lo(const mesh_frame *f, int axis, float at) {
    assert(at >= f->lo[axis] && at <= mesh_leaf_plane(f, axis, 255));
    const int code = first_at_or_above(f, axis, at);
    if (code == 0 || mesh_leaf_plane(f, axis, code) == at)
        return (uint8_t)code;
    /* The code before has the highest plane below `at`. Smaller codes may share that plane. */
    const float below = mesh_leaf_plane(f, axis, code - 1);
    return (uint8_t)(is_first(f, axis, code - 1, below) ? code - 1 : search(f, axis, below));
}
