/* grid_legs_template.h - which rays of a batch go through a grid together, and where they meet its
 * box; included by the units of an ISA (see formats/base/simd.h).
 */
#ifndef RENDER_GRID_GRID_LEGS_TEMPLATE_H
#define RENDER_GRID_GRID_LEGS_TEMPLATE_H

#include "formats/base/simd.h"

#ifdef SIMD_NAME

#include "render/grid/grid_rays_template.h"
#include "render/grid/walk.h"
#include "render/ray/tracer.h"

/* The middle of all planes on each axis, the distance from there to the last, and 1 / it. */
typedef struct grid_extent {
    double middle[3], size[3], per_size[3];
} grid_extent;

/* grid_extent_of() - sets *e. Returns false if it is out of floats' range. */
static bool grid_extent_of(grid_extent *e, const tracer *tr) {
    const walk_scene *scene = tr->own;
    const leaf_layout *layout = tr->layout;
    const level_planes *top = &scene->levels[layout->level_of[0]];
    bool usable = true;
    for (int a = 0; a < 3; a++) {
        const double lo = top->at[a][0], hi = top->at[a][1u << layout->cells_log2];
        e->middle[a] = 0.5 * (lo + hi);
        e->size[a] = 0.5 * (hi - lo);
        e->per_size[a] = 1.0 / e->size[a];
        usable &= e->size[a] >= EXTENT_MIN && e->size[a] <= EXTENT_MAX;
    }
    return usable;
}

/* A ray that may go to the kernel: 1 / d, where it begins and ends, where it enters the box. */
typedef struct grid_approach {
    double per_d[3], t_in, t_out, t_box;
    unsigned octant;
} grid_approach;

/* grid_way_ordinary() - returns whether the kernels can handle a ray's direction; sets way->per_d.
 */
static bool grid_way_ordinary(const grid_extent *e, const ray *r, grid_approach *way) {
    double least = INFINITY, most = 0.0;
    bool usable = true;
    way->octant = 0;
    for (int a = 0; a < 3; a++) {
        const double d = fabs(r->d[a]), across = d * e->per_size[a];
        way->octant |= (unsigned)(r->d[a] < 0.0) << a;
        way->per_d[a] = d > 0.0 ? 1.0 / r->d[a] : PER_NOTHING;
        if (d == 0.0)
            continue;
        usable &= d >= EXTENT_MIN && d <= EXTENT_MAX;
        least = across < least ? across : least;
        most = across > most ? across : most;
    }
    return usable && least >= COMPONENT_MIN * most;
}

/* grid_way_meets_box() - cuts the ray to the volume's box, as tracer_box() but with room for
 * rounding. Returns whether something is left. */
static bool grid_way_meets_box(const tracer *tr, const ray *r, grid_approach *way) {
    const double(*box)[3] = tr->box;
    double t_in = -INFINITY, t_out = INFINITY;
    for (int a = 0; a < 3; a++) {
        const bool back = way->octant >> a & 1u;
        if (r->d[a] == 0.0 && (r->o[a] < box[0][a] || r->o[a] > box[1][a]))
            return false;
        if (r->d[a] == 0.0)
            continue;
        const double near = (box[back][a] - r->o[a]) * way->per_d[a];
        const double far = (box[!back][a] - r->o[a]) * way->per_d[a];
        t_in = near > t_in ? near : t_in;
        t_out = far < t_out ? far : t_out;
    }
    way->t_box = t_in - 0x1p-50 * fabs(t_in);
    t_out += 0x1p-50 * fabs(t_out);
    way->t_in = way->t_box > way->t_in ? way->t_box : way->t_in;
    way->t_out = t_out < way->t_out ? t_out : way->t_out;
    return way->t_in <= way->t_out;
}

/* grid_legs_add() - adds ray i. */
static void grid_legs_add(grid_legs *legs, const ray rays[], unsigned i, const grid_approach *way) {
    const unsigned to = legs->count++;
    legs->number[to] = (uint8_t)i;
    legs->r[to] = &rays[i];
    legs->t_in[to] = way->t_in;
    legs->t_out[to] = way->t_out;
    legs->t_box[to] = way->t_box;
    for (int a = 0; a < 3; a++)
        legs->per_d[to][a] = way->per_d[a];
}

#endif
#endif
