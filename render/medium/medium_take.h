/* medium_take.h - pieces of the one filled volume, of many rays together: plain, shaded, or in a
 * preview with doubts. */
#ifndef RENDER_MEDIUM_MEDIUM_TAKE_H
#define RENDER_MEDIUM_MEDIUM_TAKE_H

#include "render/medium/medium_batch.h"
#include "render/medium/medium_ray.h"

/* Scratch of medium_take(). */
enum { MEDIUM_DOUBTFUL = 64 };
typedef struct medium_take_scratch {
    medium_batch batch;
    /* A cache: the last treelet with each number modulo MEDIUM_DOUBTFUL. */
    uint32_t treelet[MEDIUM_DOUBTFUL];
    medium_doubtful doubtful[MEDIUM_DOUBTFUL];
} medium_take_scratch;

/* medium_take() - integrator.take. scratch: a medium_take_scratch. */
void medium_take(const frame *f, ray_record *const r[], const segment_columns *c, bool stop[],
                 void *scratch);

/* medium_take_settle() - take the part of the ray's doubt before t, if any, and put it behind
 * p->run. */
void medium_take_settle(const frame *f, medium_ray *p, double t);

#endif
