/* ray_box.h - where a ray is inside a box, and which of the box tests to use where.
 *
 * A ray passes the planes of an axis at (lo - o) / d and (hi - o) / d. The tests differ in how far
 * they widen the box, according to who relies on them:
 *
 *   exact     the planes divided as in the cell kernel, nothing added. The kernel's own crossings
 *             are these very numbers, so that nothing it accepts lies outside.
 *               the volume   tracer_box(): ray_box_slab(); box_rays(): ray_slabs(), for vectors
 *               a treelet    rays_into() and passes(), of a grid
 *               a cell       cell_visit_of(), and visit() for a batch: they decide which cells a
 *                            ray visits, ties included. No other test may decide that.
 *
 *   floats    visits(), group_visits(): near_slab() of cells as seen from the eye; 16 units of
 *             2^-24 of t for reciprocals, products, t0 and t1, which err by 4 at most.
 *             children_met() of a batch through a grid: see widening() in grid_rays_template.h
 *
 *   tets      hits in a tet are not computed by planes, so t of a box and t of a hit in it differ
 *             by rounding: BOX_INTERVAL_MARGIN, 2^-20 of t.
 *             box_interval_in() for one ray (monotone: a box inside another is not entered
 *             before it); box_interval_meets(), for vectors: rays_through(), rays_meet();
 *             packet_slab() for all rays of a packet at once, by intervals, twice that
 *
 *   codes     meet_children(): planes of 8 bits, whose t are multiples of the code. They widen by
 *             BOX_INTERVAL_MARGIN, by the rounding of a plane (2^-22 of the treelet's coordinates
 *             and size), and by 2^-30 of the way across the treelet.
 *
 *   beams     beams_through(), boxes_in(): intervals of origins and of directions, in floats of a
 *             mesh's own frame. flat_beams_template.h says by how much they widen.
 */
#ifndef RENDER_RAY_RAY_BOX_H
#define RENDER_RAY_RAY_BOX_H

/* ray_box_slab() - cut [t0, t1] to where o + t d lies in [lo, hi] of one axis; d must not be 0. */
static inline void ray_box_slab(double lo, double hi, double o, double d, double *t0, double *t1) {
    const double near = ((d < 0.0 ? hi : lo) - o) / d, far = ((d < 0.0 ? lo : hi) - o) / d;
    *t0 = near > *t0 ? near : *t0;
    *t1 = far < *t1 ? far : *t1;
}

#endif
