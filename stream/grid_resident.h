/* grid_resident.h - a grid's treelet in memory: its samples, and the masks of its active cells. */
#ifndef STREAM_GRID_RESIDENT_H
#define STREAM_GRID_RESIDENT_H

#include "formats/leaf/deviation.h"
#include "stream/active.h"
#include "stream/resident.h"

typedef struct resident_grid {
    treelet head;
    uint32_t level;
    uint32_t first_cell[3]; /* of its level's grid */
    leaf_payload shape;
    const void *samples; /* at the halo's first sample */
    active_masks *masks;
    /* Of a coarse treelet in a file with deviations, else NULL: what it is to be walked by where it
     * stands in for finer ones; and how far its bricks are off (deviation.h). */
    active_masks *wide;
    const uint16_t *deviations;
} resident_grid;

/* resident_grid_of() - the whole of a treelet of a grid; NULL of NULL. */
static inline const resident_grid *resident_grid_of(const treelet *tr) {
    return (const resident_grid *)tr;
}

/* resident_grid_deviation() - of a treelet that has them, at a cell of its level's grid. */
static inline double resident_grid_deviation(const resident_grid *at, const leaf_layout *l,
                                             const uint32_t cell[3]) {
    return deviation_value(at->deviations[deviation_brick(
        l, cell[0] - at->first_cell[0], cell[1] - at->first_cell[1], cell[2] - at->first_cell[2])]);
}

extern const resident_kind grid_resident;

#endif
