/* pixel_ray.h - the state of one pixel's ray between two treelets: all that a suspended ray keeps.
 *
 * The rays themselves are made anew from the pixel and the current hit whenever the state is taken
 * up.
 */
#ifndef RENDER_PIXEL_RAY_H
#define RENDER_PIXEL_RAY_H

#include "render/frame.h"

typedef struct pixel_ray {
    uint32_t pixel;
    uint32_t next;       /* in its bucket */
    int32_t light;       /* whose shadow ray is under way; -1: looking for the next surface */
    int32_t layers;      /* surfaces composited so far */
    bool found;          /* the search has been done: best is the first surface */
    bool provisional;    /* something on the way was drawn coarser than asked for */
    float visibility;    /* of that light */
    float rgb[3];        /* shading of the current hit so far */
    float rgba[4];       /* composited so far, premultiplied */
    hit current;         /* the surface being shaded */
    surface_point point; /* there */
    trace_state search;  /* for the next surface, or for what shadows the light */
} pixel_ray;

/* pixel_ray_start() - the primary ray of a pixel, before anything is traced. */
pixel_ray pixel_ray_start(uint32_t pixel);

/* pixel_ray_found() - the same, its first surface known: h, in the treelet `at`. */
pixel_ray pixel_ray_found(const frame *f, uint32_t pixel, const hit *h, const treelet *at);

/* pixel_ray_advance() - go on until the pixel is written (true) or the treelet p->search.blocked is
 * needed (false). */
bool pixel_ray_advance(const frame *f, pixel_ray *p, ray_counters *counters);

/* pixel_ray_towards() - the unit direction to a light from a pixel's hit at t, world space; for a
 * directional light pixel and t do not matter. */
void pixel_ray_towards(const frame *f, uint32_t pixel, double t, const leafcast_light *light,
                       double to[3]);

/* pixel_ray_priority() - of the treelet that blocks it: smaller comes first. Primary rays come
 * first, front to back from the eye; then shadow rays, light by light, from the surfaces towards
 * the light. Along any ray priorities rise. */
uint64_t pixel_ray_priority(const frame *f, const pixel_ray *p);

/* pixel_ray_first_priority() - of treelet t when it blocks a primary ray. */
uint64_t pixel_ray_first_priority(const frame *f, uint32_t t);

#endif
