/* slice_ring.h - memory for slices that follow one another: slice z of a level is in slot z %
 * slots.
 */
#ifndef PREP_GRID_SLICE_RING_H
#define PREP_GRID_SLICE_RING_H

#include <stdint.h>

typedef struct slice_ring {
    char *samples;
    uint8_t *busy; /* their maps (slice_tiles.h) */
    uint32_t slots;
} slice_ring;

#endif
