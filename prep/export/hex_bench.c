#include "prep/export/hex_bench.h"

#include "formats/base/vec3.h"

static uint64_t payload_of(const cell_choice *c) {
    return leaf_layout_aligned(leaf_layout_payload_max(&c->f->layout), LEAF_ALIGN_LOG2);
}

/* The first field's values are among the treelet's. */
static uint64_t payloads_of(const cell_choice *c) {
    return HEX_TREELET_PAYLOADS + c->count - 1;
}

uint64_t hex_bench_bytes(const cell_choice *c) {
    return payloads_of(c) * payload_of(c) + c->count * sizeof(float *) +
           leaf_unpacker_memory(c->f) + 1024;
}

status hex_bench_create(mem *m, const cell_choice *c, hex_bench *b) {
    *b = (hex_bench){.m = m, .choice = c};
    b->payloads = mem_alloc(m, payloads_of(c) * payload_of(c));
    b->value = mem_array(m, c->count, sizeof *b->value);
    return b->payloads && b->value ? leaf_unpacker_create(m, c->f, &b->unpacker) : ST_NOMEM;
}

void hex_bench_release(hex_bench *b) {
    leaf_unpacker_destroy(b->unpacker);
    mem_free(b->m, b->payloads);
    mem_free(b->m, b->value);
}

/* The payload that a field's values are in: the last one of the treelet, or behind it. */
static void *values_of(const hex_bench *b, uint32_t i) {
    return b->payloads + (HEX_TREELET_PAYLOADS - 1 + i) * payload_of(b->choice);
}

status hex_bench_load(hex_bench *b, uint32_t t) {
    const cell_choice *c = b->choice;
    const leaf_layout *l = &c->f->layout;
    status st = hex_treelet_load(c->f, t, leaf_layout_set(l, c->fields[0], c->step), b->unpacker,
                                 b->payloads, &b->tr, &b->value[0]);
    for (uint32_t i = 1; i < c->count && st == ST_OK; i++)
        st = hex_treelet_load_values(c->f, &b->tr, leaf_layout_set(l, c->fields[i], c->step),
                                     b->unpacker, values_of(b, i), &b->value[i]);
    return st;
}

void hex_bench_keep(hex_bench *b, const uint32_t *kept, uint32_t count) {
    for (uint32_t i = 0; i < b->choice->count; i++) {
        float *values = values_of(b, i);
        for (uint32_t n = 0; n < count; n++)
            values[n] = values[kept[n]];
    }
}

/* ---- cells ---- */

void hex_bench_at(const hex_bench *b, uint32_t node, float at[3]) {
    for (int a = 0; a < 3; a++)
        at[a] = hex_treelet_coordinates(&b->tr, a)[node];
}

void hex_bench_cell(const hex_bench *b, const uint32_t corner[HEX_CORNERS],
                    double p[HEX_CORNERS][3]) {
    for (int c = 0; c < HEX_CORNERS; c++)
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)hex_treelet_coordinates(&b->tr, a)[corner[c]];
}

void hex_bench_map(const double p[HEX_CORNERS][3], const double u[3], double at[3],
                   double along[3][3]) {
    for (int a = 0; a < 3; a++) {
        double x[HEX_CORNERS], slope[3];
        for (int c = 0; c < HEX_CORNERS; c++)
            x[c] = p[c][a];
        at[a] = hexahedron_at(x, u);
        hexahedron_slope(x, u, slope);
        for (int k = 0; k < 3; k++)
            along[k][a] = slope[k];
    }
}

int hex_bench_sense(const hex_bench *b, uint32_t cell, const double p[HEX_CORNERS][3]) {
    static const double middle[3] = {0.5, 0.5, 0.5};
    const int sense = hex_code_sense(hex_treelet_code(&b->tr, cell));
    double at[3], along[3][3];
    if (sense != 0)
        return sense;
    hex_bench_map(p, middle, at, along);
    return vec3_det(along[0], along[1], along[2]) < 0 ? -1 : 1;
}
