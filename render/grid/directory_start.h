/* directory_start.h - where a tile's walk through the treelets begins, when it is tried again.
 *
 * All rays of a tile meet treelets in one order: that of the directory's tree, front to back from
 * the eye. Rays that wait for an absent treelet without having met a surface need none of those
 * before it again. So the next walk begins at the first treelet that one of the rays waits for.
 */
#ifndef RENDER_GRID_DIRECTORY_START_H
#define RENDER_GRID_DIRECTORY_START_H

#include "formats/leaf/leaf_layout.h"
#include "render/grid/level_planes.h"
#include "render/grid/octant_order.h"

typedef struct directory_start {
    const leaf_layout *layout;
    const level_planes *levels;
    const double *eye;
    /* By level: the treelet where the walk begins, and those above it; LEAF_NO_TREELET: none */
    uint32_t path[LEAF_LEVELS_MAX];
    uint32_t missed; /* where the next walk begins; LEAF_NO_TREELET: no ray waits */
} directory_start;

/* octant_of_eye() - returns the octant of a node that the eye is in, or nearest to; the node begins
 * at the plane `first`, its middle is `half` planes further. Children in the order octant ^ 0,
 * octant ^ 1, ... are front to back for any ray. */
static inline unsigned octant_of_eye(const level_planes *planes, const uint32_t first[3],
                                     uint32_t half, const double eye[3]) {
    unsigned octant = 0;
    for (int a = 0; a < 3; a++)
        octant |= (unsigned)(planes->at[a][first[a] + half] <= eye[a]) << a;
    return octant;
}

/* directory_start_begin() - begin at treelet `first`; 0: at the root. The pointers are kept. */
void directory_start_begin(directory_start *s, const leaf_layout *layout,
                           const level_planes *levels, const double eye[3], uint32_t first);

/* directory_start_order() - of the children of the treelet on the path at this level, which is
 * above level 0: those where the walk goes on, as a mask sorted by octants_in_order(). eye: the
 * octant of the eye. */
unsigned directory_start_order(const directory_start *s, uint32_t level, unsigned eye);

/* directory_start_note() - rays wait for treelet t. */
void directory_start_note(directory_start *s, uint32_t t);

/* directory_start_next() - returns where the next walk begins. */
static inline uint32_t directory_start_next(const directory_start *s) {
    return s->missed == LEAF_NO_TREELET ? 0 : s->missed;
}

#endif
