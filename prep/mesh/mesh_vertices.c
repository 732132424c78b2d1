#include "prep/mesh/mesh_vertices.h"

#include <stdbool.h>
#include <string.h>

#define NO_VERTEX UINT32_MAX /* no vertex has this id */

enum { DIGITS = 256 };

/* log2 of the slots for so many vertices: at most half are used. */
static uint32_t slots_log2(uint64_t vertices) {
    uint32_t log2 = 6;
    while ((uint64_t)1 << log2 < 2 * vertices)
        log2++;
    return log2;
}

uint64_t mesh_vertices_memory(uint32_t cells_max, uint32_t each) {
    const uint64_t most = each * (uint64_t)cells_max;
    return most * (2 * sizeof(uint64_t) + 2 * sizeof(uint16_t)) +
           (sizeof(mesh_vertex_slot) << slots_log2(most)) + 1024;
}

status mesh_vertices_init(mesh_vertices *v, mem *m, uint32_t cells_max, uint32_t each) {
    const size_t most = each * (size_t)cells_max;
    *v = (mesh_vertices){.m = m, .each = each, .slots_log2_max = slots_log2(most)};
    v->ids = mem_alloc(m, most * sizeof *v->ids);
    v->other = mem_alloc(m, most * sizeof *v->other);
    v->corners = mem_alloc(m, most * sizeof *v->corners);
    v->local = mem_alloc(m, most * sizeof *v->local);
    v->slots = mem_alloc(m, sizeof *v->slots << v->slots_log2_max);
    return v->ids && v->other && v->corners && v->local && v->slots ? ST_OK : ST_NOMEM;
}

void mesh_vertices_release(mesh_vertices *v) {
    if (!v->m)
        return;
    mem_free(v->m, v->ids);
    mem_free(v->m, v->other);
    mem_free(v->m, v->corners);
    mem_free(v->m, v->local);
    mem_free(v->m, v->slots);
    *v = (mesh_vertices){0};
}

/* ---- each vertex once: open addressing ---- */

static mesh_vertex_slot *slot_of(mesh_vertices *v, uint32_t id, uint32_t log2) {
    size_t at = (uint32_t)(id * 0x9e3779b1U) >> (32 - log2);
    while (v->slots[at].id != id && v->slots[at].id != NO_VERTEX)
        at = (at + 1) & (((size_t)1 << log2) - 1);
    return &v->slots[at];
}

static void rebuild_slots(mesh_vertices *v, uint32_t log2) {
    memset(v->slots, 0xff, sizeof *v->slots << log2);
    for (uint32_t i = 0; i < v->count; i++) {
        uint32_t id = mesh_vertices_id(v, i);
        *slot_of(v, id, log2) = (mesh_vertex_slot){id, i};
    }
}

/* Number vertices in the order in which they are met; ids[number] = id << 32 | number. */
static void collect(mesh_vertices *v, const uint32_t *ids, size_t stride, size_t cells) {
    uint32_t log2 = slots_log2(v->each * cells / 8 + v->each);
    uint16_t *corner = v->corners;
    v->count = 0;
    rebuild_slots(v, log2);
    for (size_t t = 0; t < cells; t++) {
        const uint32_t *cell = (const uint32_t *)(const void *)((const char *)ids + t * stride);
        if (2 * ((uint64_t)v->count + v->each) > (uint64_t)1 << log2 && log2 < v->slots_log2_max)
            rebuild_slots(v, ++log2);
        for (uint32_t c = 0; c < v->each; c++) {
            uint32_t id = cell[c];
            mesh_vertex_slot *s = slot_of(v, id, log2);
            if (s->id == NO_VERTEX) {
                *s = (mesh_vertex_slot){id, v->count};
                v->ids[v->count] = (uint64_t)id << 32 | v->count;
                v->count++;
            }
            *corner++ = (uint16_t)s->number;
        }
    }
}

/* ---- sorting by ids: digit by digit, the lowest first ---- */

static void move_by_digit(const uint64_t *from, uint64_t *to, uint32_t count, int shift) {
    uint32_t next[DIGITS] = {0}, sum = 0;
    for (uint32_t i = 0; i < count; i++)
        next[from[i] >> shift & (DIGITS - 1)]++;
    for (int d = 0; d < DIGITS; d++) {
        uint32_t many = next[d];
        next[d] = sum;
        sum += many;
    }
    for (uint32_t i = 0; i < count; i++)
        to[next[from[i] >> shift & (DIGITS - 1)]++] = from[i];
}

static void sort_ids(mesh_vertices *v) {
    uint64_t differ = 0;
    for (uint32_t i = 1; i < v->count; i++)
        differ |= v->ids[i] ^ v->ids[0];
    for (int shift = 32; shift < 64; shift += 8) {
        if (!(differ >> shift & (DIGITS - 1)))
            continue;
        move_by_digit(v->ids, v->other, v->count, shift);
        uint64_t *sorted = v->other;
        v->other = v->ids;
        v->ids = sorted;
    }
}

void mesh_vertices_number_met(mesh_vertices *v, const uint32_t *ids, size_t stride, size_t cells) {
    collect(v, ids, stride, cells);
    sort_ids(v);
}

void mesh_vertices_number(mesh_vertices *v, const uint32_t *ids, size_t stride, size_t cells) {
    mesh_vertices_number_met(v, ids, stride, cells);
    for (uint32_t i = 0; i < v->count; i++) {
        v->local[mesh_vertices_local(v, i)] = (uint16_t)i;
        v->ids[i] = (v->ids[i] & ~(uint64_t)UINT32_MAX) | i;
    }
    for (size_t i = 0; i < v->each * cells; i++)
        v->corners[i] = v->local[v->corners[i]];
}
