/* peer_field.h - the full resolution of a treelet file as one array of floats in memory, for the
 * peers that know nothing else. */
#ifndef RENDER_BENCH_PEER_FIELD_H
#define RENDER_BENCH_PEER_FIELD_H

#include <stdint.h>

#include "formats/base/pool.h"
#include "render/ray/affine.h"

typedef struct peer_field {
    uint32_t dims[3];
    float *samples;  /* x fastest */
    double *axis[3]; /* node coordinates in grid space */
    affine space;
    mem *m;
} peer_field;

/* peer_field_load() - ST_UNSUPPORTED when a sample is not finite: meshes have no word for it.
 * peer_field_release() in any case. */
CHECKED status peer_field_load(mem *m, const char *path, pool *threads, peer_field *field);
void peer_field_release(peer_field *field);

static inline size_t peer_field_at(const peer_field *f, uint32_t x, uint32_t y, uint32_t z) {
    return x + f->dims[0] * (y + (size_t)f->dims[1] * z);
}

#endif
