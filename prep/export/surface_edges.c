#include "prep/export/surface_edges.h"

#define NO_VERTEX UINT32_MAX

enum { LEAST = 1024 };

/* ---- the table ---- */

void surface_edges_clear(surface_edges *e) {
    for (uint32_t i = 0; i < e->slots; i++)
        e->crossing[i].vertex = NO_VERTEX;
    e->count = 0;
}

/* The slot that has the key, or is free for it. */
static surface_crossing *slot_of(const surface_edges *e, hash_id key) {
    uint32_t slot = (uint32_t)key.lo & (e->slots - 1);
    while (e->crossing[slot].vertex != NO_VERTEX &&
           (e->crossing[slot].key.lo != key.lo || e->crossing[slot].key.hi != key.hi))
        slot = (slot + 1) & (e->slots - 1);
    return &e->crossing[slot];
}

static bool grow(surface_edges *e) {
    surface_edges wider = {.m = e->m, .slots = e->slots ? 2 * e->slots : LEAST};
    wider.crossing = mem_array(e->m, wider.slots, sizeof *wider.crossing);
    if (!wider.crossing)
        return false;
    surface_edges_clear(&wider);
    for (uint32_t i = 0; i < e->slots; i++)
        if (e->crossing[i].vertex != NO_VERTEX)
            *slot_of(&wider, e->crossing[i].key) = e->crossing[i];
    wider.count = e->count;
    mem_free(e->m, e->crossing);
    *e = wider;
    return true;
}

uint32_t *surface_edges_find(surface_edges *e, hash_id key, bool *known) {
    if (2 * e->count >= e->slots && !grow(e))
        return NULL;
    surface_crossing *slot = slot_of(e, key);
    *known = slot->vertex != NO_VERTEX;
    e->count += !*known;
    slot->key = key;
    return &slot->vertex;
}

/* ---- keys ---- */

hash_id surface_edge_key(const float from[3], float from_value, const float to[3], float to_value,
                         double isovalue) {
    float ends[] = {from[0], from[1], from[2], from_value, to[0], to[1], to[2], to_value};
    const struct {
        hash_id ends;
        double isovalue;
    } name = {piece_key(ends, sizeof ends / sizeof *ends), isovalue};
    return hash_identity(&name, sizeof name);
}
