/* mesh_vertices.h - lists the vertices of some tets or hexahedra, each once, and numbers them. */
#ifndef PREP_MESH_MESH_VERTICES_H
#define PREP_MESH_MESH_VERTICES_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct mesh_vertex_slot {
    uint32_t id, number;
} mesh_vertex_slot;

/* Scratch and results of mesh_vertices_number(). */
typedef struct mesh_vertices {
    mem *m;
    uint32_t each; /* corners of a cell */
    uint32_t count;
    uint64_t *ids; /* [count]: ascending; the ids are the upper 32 bits, the lower ones numbers */
    uint16_t *corners; /* `each` of each cell, in the input's order: numbers of its vertices */
    uint64_t *other;
    uint16_t *local;
    mesh_vertex_slot *slots;
    uint32_t slots_log2_max;
} mesh_vertices;

/* mesh_vertices_init() - for up to cells_max cells with so many corners each, 2^16 corners in all.
 * mesh_vertices_memory() - bytes it takes. */
CHECKED status mesh_vertices_init(mesh_vertices *v, mem *m, uint32_t cells_max, uint32_t each);
void mesh_vertices_release(mesh_vertices *v); /* a zeroed struct is fine */
uint64_t mesh_vertices_memory(uint32_t cells_max, uint32_t each);

/* mesh_vertices_number() - of so many cells, in the order of ids. ids: of the first one's corners,
 * one after another; those of the next one are `stride` bytes behind. A cell may have a vertex more
 * than once.
 * mesh_vertices_number_met() - in the order in which they are met, cell after cell. */
void mesh_vertices_number(mesh_vertices *v, const uint32_t *ids, size_t stride, size_t cells);
void mesh_vertices_number_met(mesh_vertices *v, const uint32_t *ids, size_t stride, size_t cells);

/* mesh_vertices_id(), mesh_vertices_local() - of the i-th one by ids, its id and its number. */
static inline uint32_t mesh_vertices_id(const mesh_vertices *v, uint32_t i) {
    return (uint32_t)(v->ids[i] >> 32);
}
static inline uint32_t mesh_vertices_local(const mesh_vertices *v, uint32_t i) {
    return (uint32_t)v->ids[i];
}

#endif
