#include "formats/leaf/mesh_verify.h"

#include <math.h>

#include "formats/leaf/leaf_histogram.h"
#include "formats/leaf/leaf_layout.h"
#include "formats/mesh/mesh_leaf_check.h"

static uint64_t cells_of(const leaf_file *f) {
    return f->header.tets;
}

/* The topology, the payload that is checked, one more, and scratch. */
static size_t room_of(const leaf_file *f) {
    size_t scratch = 0;
    for (uint32_t t = 0; t < f->layout.treelets; t++) {
        const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
        const size_t bytes = mesh_leaf_check_scratch(&s);
        scratch = bytes > scratch ? bytes : scratch;
    }
    return 3 * (size_t)leaf_layout_payload_max(&f->layout) + scratch;
}

static uint32_t count_odd(const leaf_file *f, uint32_t t, const void *values) {
    const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
    uint32_t count = 0;
    for (uint32_t i = 0; i < s.vertices; i++)
        count += !isfinite(mesh_leaf_values(&s, values)[i]);
    return count;
}

/* Measure the tets that are drawn for a set's histogram. positions: room for a step's positions, if
 * they differ from the first step's. */
static status look_at_tets(const leaf_verifying *v, uint32_t set, uint32_t t, const char *topology,
                           const char *values, char *positions) {
    const leaf_file *f = v->f;
    const mesh_shape s = mesh_leaf_shape(f->mesh->counts[t]);
    const float(*points)[3] = mesh_leaf_positions(&s, topology);
    const uint32_t step = leaf_layout_step(&f->layout, set);
    if (!v->cells)
        return ST_OK;
    if (leaf_layout_place(&f->layout, step) > 0) {
        const status st = v->load(v, leaf_layout_positions(&f->layout, step, t), positions);
        if (st != ST_OK)
            return st;
        points = mesh_leaf_moved(&s, positions);
    }
    const histogram_run run = leaf_histogram_run(f, set, cells_of(f));
    leaf_histogram_take_tets(&run, f->mesh->first_tet[t], &s, mesh_leaf_tets(&s, topology), points,
                             mesh_leaf_values(&s, values), v->cells + set * v->count);
    return ST_OK;
}

/* Check payload p of a treelet, any but its topology. room: for another payload, then scratch. */
static status verify_block(const leaf_verifying *v, uint32_t p, const char *topology,
                           const char *payload, char *room, uint64_t *non_finite) {
    const leaf_file *f = v->f;
    const uint32_t t = p % f->layout.treelets;
    char *scratch = room + leaf_layout_payload_max(&f->layout);
    uint32_t index;
    status st;
    switch (leaf_layout_block_of(&f->layout, p, &index)) {
    case LEAF_BLOCK_VALUES:
        st = mesh_leaf_check_values(f, index, t, topology, payload, scratch);
        if (st == ST_OK && (f->flags[p - f->layout.treelets] & LEAF_FLAG_NON_FINITE))
            *non_finite += count_odd(f, t, payload);
        return st == ST_OK ? look_at_tets(v, index, t, topology, payload, room) : st;
    case LEAF_BLOCK_GRADIENTS: return mesh_leaf_check_gradients(f, index, t, payload);
    default:
        st = mesh_leaf_check_moved(f, index, t, payload);
        return st == ST_OK ? mesh_leaf_check_positions(f, index, t, topology, payload, scratch)
                           : st;
    }
}

static status verify_treelet(const leaf_verifying *v, uint32_t t, uint64_t *non_finite) {
    const leaf_file *f = v->f;
    const size_t room = leaf_layout_payload_max(&f->layout);
    char *topology = v->room, *payload = topology + room, *other = payload + room,
         *scratch = other + room;
    status st = v->load(v, t, topology);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(f, t, topology);
    if (st == ST_OK)
        st = mesh_leaf_check_topology(f, t, topology, scratch);
    for (uint32_t p = t + f->layout.treelets; p < f->layout.payloads && st == ST_OK;
         p += f->layout.treelets) {
        st = v->load(v, p, payload);
        if (st == ST_OK)
            st = verify_block(v, p, topology, payload, other, non_finite);
    }
    return st;
}

const leaf_verifier mesh_verifier = {"tets", cells_of, room_of, verify_treelet};
