/* integrator.h - what makes a pixel of a ray: a row of functions for each way of looking.
 *
 * A frame (frame.h) begins a record for each ray that tiles leave over, advances it until it is
 * done or needs a treelet that is absent, keeps it meanwhile, and knows no more of it than its
 * head. Integrators ask kinds of geometry (kind.h) for what is on a ray's way, and write what comes
 * of it. Whoever makes a frame says which one, and gives it its description: frame.integrator,
 * frame.look.
 */
#ifndef RENDER_INTEGRATOR_H
#define RENDER_INTEGRATOR_H

#include "render/frame.h"
#include "render/ray_bundle.h"
#include "render/tile.h"

/* All that a frame knows of a ray; the integrator's part follows. */
typedef struct ray_record {
    uint32_t pixel;
    uint32_t next;    /* in its bucket, or among those that are free */
    uint32_t blocked; /* the treelet that it waits for, */
    uint16_t volume;  /* of this volume, */
    uint16_t leg;     /* on this leg of its way; treelets for lower ones come first */
} ray_record;

typedef struct integrator {
    size_t record_bytes; /* head and part */

    /* The ray of a pixel before anything is traced. */
    void (*begin)(const frame *f, uint32_t pixel, ray_record *r);
    /* Go on until the pixel is written (true), or a treelet is needed: the head says which. */
    bool (*advance)(const frame *f, ray_record *r, ray_counters *counters);
    /* The bundle of all rays on a leg of their way. */
    ray_bundle (*bundle)(const frame *f, uint32_t leg);

    /* Returns what begins whole tiles of pixels, or NULL: ray by ray. */
    tile_fn (*tile)(const frame *f);
} integrator;

#endif
