/* grid_resident.h - a grid's treelet in memory: its samples, and the masks of its active cells. */
#ifndef STREAM_GRID_RESIDENT_H
#define STREAM_GRID_RESIDENT_H

#include "formats/leaf/deviation.h"
#include "stream/active.h"
#include "stream/resident.h"

typedef struct resident_grid {
    treelet head;
    uint32_t level;
    uint32_t first_cell[3]; /* in its level's grid */
    leaf_payload shape;
    const void *samples; /* at the halo's first sample */
    uint64_t stamp;      /* of a live file's samples (leaf_live.h): its checksum when it was read */
    active_masks *masks;
    /* Coarse treelets in a file with deviations, else NULL. wide: the masks for rays where the
     * treelet stands in for finer ones. deviations: a code per brick (deviation.h). */
    active_masks *wide;
    const uint16_t *deviations;
} resident_grid;

/* resident_grid_of() - returns the whole struct of a grid's treelet; NULL gives NULL. */
static inline const resident_grid *resident_grid_of(const treelet *tr) {
    return (const resident_grid *)tr;
}

/* resident_grid_deviation() - returns the deviation at a cell of the level's grid. The treelet must
 * have deviations. */
static inline double resident_grid_deviation(const resident_grid *at, const leaf_layout *l,
                                             const uint32_t cell[3]) {
    return deviation_value(at->deviations[deviation_brick(
        l, cell[0] - at->first_cell[0], cell[1] - at->first_cell[1], cell[2] - at->first_cell[2])]);
}

extern const resident_kind grid_resident;

#endif
