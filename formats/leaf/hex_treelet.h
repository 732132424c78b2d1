/* hex_treelet.h - a treelet of nodes and cells between them, of whatever kind its file is: nodes,
 * and which of them are at the corners of a cell.
 *
 * All such kinds have the same places: float x[n], y[n], z[n]; if cells are hexahedra, then their
 * hex_code, four a byte, the first one lowest. What differs is a row, leaf_geometry.noded.
 */
#ifndef FORMATS_LEAF_HEX_TREELET_H
#define FORMATS_LEAF_HEX_TREELET_H

#include "formats/curved/curved_cell.h"
#include "formats/leaf/leaf_geometry.h"
#include "formats/leaf/leaf_unpacker.h"

typedef struct hex_treelet {
    const leaf_file *f;
    uint32_t id, nodes, cells;
    const void *topology; /* the payload `id`; only if the kind lists corners in it */
    const float *places;
} hex_treelet;

typedef struct leaf_noded {
    bool listed;    /* corners are in the topology; else they follow from the treelet's COUNTS */
    bool hexahedra; /* cells are, or collapse from them, or are quadratic tets; places have codes */
    /* Set nodes and cells of h. */
    void (*count)(hex_treelet *h);
    /* The nodes of a cell (cell_row.h); of a triangle three, then the last one again. */
    void (*row)(const hex_treelet *h, uint32_t i, uint32_t row[CELL_ROW]);
    /* Of those that are listed (listed_geometry.h): the most cells of a treelet; the fewest nodes
     * of a cell; the most of each in a treelet; and what it cannot have (COUNTS), or NULL. */
    uint32_t cells_max, nodes_least, nodes_each;
    const char *(*counts_fault)(const uint32_t counts[4], uint32_t treelet_cells);
    /* NULL, or set what nodes have behind their places, at a share of the way between two payloads
     * of places. */
    void (*mix)(const hex_treelet *h, const float *const from[2], double share, float *places);
} leaf_noded;

/* hex_treelet_of() - treelet t of a file with leaf_geometry.noded, its payloads not yet known.
 * hex_treelet_places() - the payload of its places at a step. */
hex_treelet hex_treelet_of(const leaf_file *f, uint32_t t);
uint32_t hex_treelet_places(const leaf_layout *l, uint32_t step, uint32_t t);

/* hex_treelet_payload_bytes() - leaf_geometry.payload_bytes of all such kinds.
 * hex_treelet_stored_bytes() - its bytes in a file, before compression. hex_treelet_beside() -
 * leaf_blending.beside of all such kinds. */
uint32_t hex_treelet_payload_bytes(const leaf_layout *l, uint32_t p);
uint32_t hex_treelet_stored_bytes(const leaf_layout *l, uint32_t p, leaf_block *block);
leaf_beside hex_treelet_beside(const leaf_layout *l, uint32_t p);

static inline const float *hex_treelet_coordinates(const hex_treelet *h, int axis) {
    return h->places + (size_t)axis * h->nodes;
}
static inline hex_code hex_treelet_code(const hex_treelet *h, uint32_t i) {
    const uint8_t *codes = (const uint8_t *)(h->places + 3 * (size_t)h->nodes);
    return (hex_code)(codes[i / 4] >> 2 * (i % 4) & 3);
}
/* hex_treelet_write_code() - of a cell whose bits are 0. places: a payload of them, of h's nodes.
 */
static inline void hex_treelet_write_code(const hex_treelet *h, float *places, uint32_t i,
                                          hex_code code) {
    uint8_t *codes = (uint8_t *)(places + 3 * (size_t)h->nodes);
    codes[i / 4] |= (uint8_t)((unsigned)code << 2 * (i % 4));
}
static inline void hex_treelet_row(const hex_treelet *h, uint32_t i, uint32_t row[CELL_ROW]) {
    h->f->geometry->noded->row(h, i, row);
}

/* hex_treelet_cell() - a cell of hexahedra at the places of h; its number is that in the treelet.
 * values: of the nodes; NULL: 0. Its sense is what its code says. */
void hex_treelet_cell(const hex_treelet *h, uint32_t i, const float *values, curved_cell *out);

/* hex_treelet_check() - what the directory says of the treelet at the step of a set holds for
 * payloads as they were read: all nodes lie in its box, all values in its range, unless it says
 * that some are not finite, and all corners are at nodes. ST_CORRUPT names what does not. values:
 * float[n]. hex_treelet_check_places(), _corners(), _values() - each of these alone. */
CHECKED status hex_treelet_check(const hex_treelet *h, uint32_t set, const float *values);
CHECKED status hex_treelet_check_places(const hex_treelet *h, uint32_t step);
CHECKED status hex_treelet_check_corners(const hex_treelet *h);
CHECKED status hex_treelet_check_values(const hex_treelet *h, uint32_t set, const float *values);

/* hex_treelet_load() - read and check treelet t with the values of a set. room: of
 * HEX_TREELET_PAYLOADS times leaf_layout_payload_max() bytes, aligned to LEAF_ALIGN, which *h and
 * *values are of. hex_treelet_in() - the same for a room that was loaded so.
 * hex_treelet_load_values() - those of a further set of the same step. to: room of one payload. */
enum { HEX_TREELET_PAYLOADS = 3 };
CHECKED status hex_treelet_load(leaf_file *f, uint32_t t, uint32_t set, leaf_unpacker *u,
                                void *room, hex_treelet *h, const float **values);
hex_treelet hex_treelet_in(const leaf_file *f, uint32_t t, uint32_t set, const void *room,
                           const float **values);
CHECKED status hex_treelet_load_values(leaf_file *f, const hex_treelet *h, uint32_t set,
                                       leaf_unpacker *u, void *to, const float **values);

#endif
