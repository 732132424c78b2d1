/* octree_step.h - the one step of traversal: which children of a node a ray passes, in order, and
 * in which intervals.
 *
 * The implicit kd-tree (M08 4.3.1) is walked three splits at a time: x, y and z through the node's
 * middle make eight children, of which a ray passes at most four. The same step leads from the
 * directory's root over the treelets' trees to single cells.
 *
 * The step is conservative for the cell kernel's rules. Crossings are the kernel's own (plane - o)
 * / d, taken in (t, axis) order. A crossing at the interval's very start counts as still to come,
 * so zero-length visits are kept. The kernel refuses cells that are offered in vain.
 */
#ifndef RENDER_GRID_OCTREE_STEP_H
#define RENDER_GRID_OCTREE_STEP_H

#include <math.h>

#include "render/ray/ray.h"

typedef struct octree_child {
    double t_in, t_out;
    unsigned octant; /* x + 2y + 4z */
} octree_child;

/* octree_step() - sets children[] to the children that the ray passes, in order. Returns their
 * number, 1 to 4. middle: the three split planes; [t_in, t_out]: the ray's interval in the node. */
static inline int octree_step(const ray *r, const double middle[3], double t_in, double t_out,
                              octree_child children[4]) {
    double t[3];
    int order[3];
    int crossings = 0;
    unsigned octant = 0;
    for (int a = 0; a < 3; a++) {
        const double d = r->d[a];
        if (d == 0.0) {
            octant |= (unsigned)(r->held[a] >= middle[a]) << a;
            continue;
        }
        t[a] = (middle[a] - r->o[a]) / d;
        const bool to_come = t[a] >= t_in;
        octant |= (unsigned)(to_come == (d < 0.0)) << a;
        if (!to_come || t[a] > t_out)
            continue;
        /* Insert by (t, axis): axes come in ascending order, so equal t stay so. */
        int i = crossings++;
        for (; i > 0 && t[order[i - 1]] > t[a]; i--)
            order[i] = order[i - 1];
        order[i] = a;
    }
    double from = t_in;
    for (int i = 0; i < crossings; i++) {
        children[i] = (octree_child){from, t[order[i]], octant};
        from = t[order[i]];
        octant ^= 1u << order[i];
    }
    children[crossings] = (octree_child){from, t_out, octant};
    return crossings + 1;
}

#endif
