/* hex_resident.h - the row of resident.h for kinds whose cells are hexahedra (hex_treelet.h): a
 * treelet's payloads, checked, and what its kind makes of them, which hex_blocks says.
 *
 * Between steps (leaf_between.h), a payload that is of a set has those of both steps behind its
 * own. Its own, and what follows from nodes and values, are made with the masks.
 */
#ifndef STREAM_HEX_RESIDENT_H
#define STREAM_HEX_RESIDENT_H

#include "formats/leaf/hex_treelet.h"
#include "stream/resident.h"

/* A treelet; the first member of what a kind has. */
typedef struct resident_hexes {
    treelet head;                     /* its payload: the first part */
    const void *part[LEAF_PARTS_MAX]; /* payloads, as leaf_geometry.parts() lists them */
    int parts;
} resident_hexes;

/* What a kind makes of a treelet. */
typedef struct hex_blocks {
    size_t size; /* of its struct */
    /* The memory that make() takes for treelet t. */
    size_t (*bytes)(const leaf_file *f, uint32_t t);
    /* make(): make it, given where nodes and corners are; boxes follow from the nodes. On failure
     * nothing is left. release(): free what it has, if anything. */
    status (*make)(resident_hexes *tr, mem *m, const hex_treelet *h);
    void (*release)(resident_hexes *tr);
    /* move(): nodes have other places now. fill(): give it the nodes' values, kept by reference; no
     * cell is active then. select(): activate the cells that meet an interest. */
    void (*move)(resident_hexes *tr);
    void (*fill)(resident_hexes *tr, const float *values);
    void (*select)(resident_hexes *tr, const interest *in);
} hex_blocks;

/* The functions of resident_kind; those of a kind are all of them, and .hexes = its hex_blocks.
 * What sets share is the first part: unless it has the places of its step alone. */
bool hex_resident_shares(const leaf_file *f);
const treelet_bounds *hex_resident_boxes(const leaf_file *f, uint32_t set);
size_t hex_resident_scratch(const resident_store *s);
size_t hex_resident_bytes(const resident_store *s, uint32_t t);
size_t hex_resident_shared_bytes(const resident_store *s, uint32_t t);
uint64_t hex_resident_stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family);
uint32_t hex_resident_ahead(const resident_store *s, uint32_t set, uint32_t t,
                            uint32_t payloads[RESIDENT_PAYLOADS]);
bool hex_resident_helps(const resident_store *s, const treelet *tr, uint32_t set);
CHECKED status hex_resident_load(const resident_store *s, uint32_t t, uint32_t set,
                                 const void *shared, const treelet *earlier,
                                 resident_scratch *scratch, treelet **out, uint64_t *read);
bool hex_resident_same(const resident_store *s, const treelet *tr, uint32_t set);
void hex_resident_adopt(const resident_store *s, treelet *tr, uint32_t set);
bool hex_resident_keep(const resident_store *s, treelet *tr);
void hex_resident_strip(const resident_store *s, treelet *tr);
void hex_resident_destroy(const resident_store *s, treelet *tr);
void hex_resident_mask(const resident_store *s, treelet *tr, const interest *in);

#define HEX_RESIDENT_FUNCTIONS                                                                   \
    .shares = hex_resident_shares, .boxes = hex_resident_boxes, .scratch = hex_resident_scratch, \
    .bytes = hex_resident_bytes, .shared_bytes = hex_resident_shared_bytes,                      \
    .stored = hex_resident_stored, .ahead = hex_resident_ahead, .helps = hex_resident_helps,     \
    .load = hex_resident_load, .same = hex_resident_same, .adopt = hex_resident_adopt,           \
    .keep = hex_resident_keep, .strip = hex_resident_strip, .destroy = hex_resident_destroy,     \
    .mask = hex_resident_mask

#endif
