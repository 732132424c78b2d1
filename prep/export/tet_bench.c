#include "prep/export/tet_bench.h"

#include <string.h>

#include "formats/base/exact.h"
#include "formats/mesh/mesh_leaf_check.h"

static uint64_t payload_of(const cell_choice *c) {
    return leaf_layout_aligned(leaf_layout_payload_max(&c->f->layout), LEAF_ALIGN_LOG2);
}

static bool has_moved(const cell_choice *c) {
    return leaf_layout_place(&c->f->layout, c->step) > 0;
}

static bool has_gradients(const cell_choice *c) {
    return c->gradients && c->f->layout.gradient_sets;
}

uint64_t tet_bench_bytes(const cell_choice *c) {
    const uint64_t payloads = 1 + c->count + has_moved(c) + has_gradients(c);
    return payloads * payload_of(c) + c->count * sizeof(float *) + leaf_unpacker_memory(c->f) +
           1024;
}

status tet_bench_create(mem *m, const cell_choice *c, tet_bench *b) {
    const size_t payload = payload_of(c);
    *b = (tet_bench){.m = m, .choice = c};
    b->topology = mem_alloc(m, payload);
    b->values = mem_alloc(m, c->count * payload);
    b->value = mem_array(m, c->count, sizeof *b->value);
    bool all = b->topology && b->values && b->value;
    if (has_moved(c))
        all &= (b->moved = mem_alloc(m, payload)) != NULL;
    if (has_gradients(c))
        all &= (b->gradients = mem_alloc(m, payload)) != NULL;
    return all ? leaf_unpacker_create(m, c->f, &b->unpacker) : ST_NOMEM;
}

void tet_bench_release(tet_bench *b) {
    leaf_unpacker_destroy(b->unpacker);
    mem_free(b->m, b->topology);
    mem_free(b->m, b->values);
    mem_free(b->m, b->value);
    mem_free(b->m, b->moved);
    mem_free(b->m, b->gradients);
}

static status load_values(tet_bench *b, uint32_t t) {
    const cell_choice *c = b->choice;
    const leaf_layout *l = &c->f->layout;
    for (uint32_t i = 0; i < c->count; i++) {
        char *values = b->values + i * payload_of(c);
        const uint32_t set = leaf_layout_set(l, c->fields[i], c->step);
        status st = leaf_file_load(c->f, leaf_layout_values(l, set, t), b->unpacker, values);
        if (st != ST_OK)
            return st;
        b->value[i] = mesh_leaf_values(&b->shape, values);
    }
    return ST_OK;
}

static status load_moved(tet_bench *b, uint32_t t) {
    const cell_choice *c = b->choice;
    status st = leaf_file_load(c->f, leaf_layout_positions(&c->f->layout, c->step, t), b->unpacker,
                               b->moved);
    b->at = mesh_leaf_moved(&b->shape, b->moved);
    return st == ST_OK ? mesh_leaf_check_moved(c->f, c->step, t, b->moved) : st;
}

static status load_gradients(tet_bench *b, uint32_t t) {
    const cell_choice *c = b->choice;
    const leaf_layout *l = &c->f->layout;
    const uint32_t set = leaf_layout_set(l, c->fields[0], c->step);
    b->gradient = mesh_leaf_gradients(b->gradients);
    return leaf_file_load(c->f, leaf_layout_gradients(l, set, t), b->unpacker, b->gradients);
}

status tet_bench_load(tet_bench *b, uint32_t t) {
    leaf_file *f = b->choice->f;
    b->shape = mesh_leaf_shape(f->mesh->counts[t]);
    status st = leaf_file_load(f, t, b->unpacker, b->topology);
    if (st == ST_OK)
        st = mesh_leaf_check_loaded(f, t, b->topology);
    b->tets = mesh_leaf_tets(&b->shape, b->topology);
    b->at = mesh_leaf_positions(&b->shape, b->topology);
    if (st == ST_OK)
        st = load_values(b, t);
    if (st == ST_OK && b->moved)
        st = load_moved(b, t);
    if (st == ST_OK && b->gradients)
        st = load_gradients(b, t);
    return st;
}

int tet_bench_sign(const tet_bench *b, uint32_t tet) {
    double corner[4][3];
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            corner[i][a] = (double)b->at[b->tets[tet][i]][a];
    return exact_orientation((const double(*)[3])corner);
}
