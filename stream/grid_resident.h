/* grid_resident.h - a grid's treelet in memory: its samples, and the masks of its active cells. */
#ifndef STREAM_GRID_RESIDENT_H
#define STREAM_GRID_RESIDENT_H

#include "stream/active.h"
#include "stream/resident.h"

typedef struct resident_grid {
    treelet head;
    uint32_t level;
    uint32_t first_cell[3]; /* of its level's grid */
    leaf_payload shape;
    const void *samples; /* at the halo's first sample */
    active_masks *masks;
} resident_grid;

/* resident_grid_of() - the whole of a treelet of a grid; NULL of NULL. */
static inline const resident_grid *resident_grid_of(const treelet *tr) {
    return (const resident_grid *)tr;
}

extern const resident_kind grid_resident;

#endif
