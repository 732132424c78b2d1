/* stepping_ray.h - common part of rays that sum up a medium in equal steps: the way through the
 * volume, and the pixel at its end.
 *
 * They exist for comparison with medium_integrator.h; the error of their pixels is unknown.
 * image.error is +inf, and every pixel counts as uncertified. One volume, no surfaces.
 */
#ifndef RENDER_EXPERIMENTS_STEPPING_RAY_H
#define RENDER_EXPERIMENTS_STEPPING_RAY_H

#include "render/frame/integrator.h"
#include "render/look/transfer.h"

/* frame.look */
typedef struct stepping_look {
    const transfer *medium;
    double step;   /* world length */
    double opaque; /* rays end at this opacity */
    float background[4];
} stepping_look;

static inline const stepping_look *stepping_look_of(const frame *f) {
    return f->look;
}

typedef struct stepping_ray {
    ray_record head;
    bool begun; /* the walk has begun */
    bool provisional;
    double from, to; /* t where the ray is in the volume's box; from > to: nowhere */
    double rgb[3], through;
    segments_state walk;
    segment kept[SEGMENTS_KEPT];
} stepping_ray;

static inline stepping_ray *stepping_ray_of(ray_record *r) {
    return (stepping_ray *)r;
}

/* stepping_ray_begin(), stepping_ray_answer(), stepping_ray_bundle() - members of the integrators'
 * rows. */
void stepping_ray_begin(const frame *f, uint32_t pixel, ray_record *r);
void stepping_ray_answer(const frame *f, ray_record *r, trace_result result);
ray_bundle stepping_ray_bundle(const frame *f, uint32_t leg);

/* stepping_ray_ask() - ask for the pieces on the ray's way. Returns false when there are none, or
 * no more; then call stepping_ray_write(). */
bool stepping_ray_ask(const frame *f, stepping_ray *p, ray_question *q);
void stepping_ray_write(const frame *f, const stepping_ray *p, ray_counters *counters);

/* stepping_ray_join() - add what is seen behind all so far. Returns whether nothing behind it
 * counts. */
static inline bool stepping_ray_join(const stepping_look *look, stepping_ray *p,
                                     const double rgb[3], double through) {
    for (int c = 0; c < 3; c++)
        p->rgb[c] += p->through * rgb[c];
    p->through *= through;
    return 1.0 - p->through >= look->opaque;
}

#endif
