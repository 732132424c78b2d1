/* moving_order.h - in which order the triangles of a surface in memory lie: along the Morton curve,
 * by the means of their corners, as in a file (formats/TRIANGLES.md); of one place in the host's
 * order.
 */
#ifndef STREAM_MOVING_ORDER_H
#define STREAM_MOVING_ORDER_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* A surface, as a host gives it. */
typedef struct moving_source {
    uint32_t vertices, triangles; /* 1 or more */
    const float (*positions)[3];  /* of the vertices, finite */
    const uint32_t (*rows)[3];    /* of the triangles: vertices */
    const float *values;          /* a vertex; or NULL */
    const uint32_t *colours;      /* a vertex, 0xRRGGBB; or NULL */
    const char *name;             /* of the values */
    bool smooth;                  /* vertices have normals, made from the triangles */
} moving_source;

/* moving_order_sort() - write the triangles' numbers in their order. bounds: of the triangles.
 * moving_order_memory() - the memory that it takes meanwhile. */
CHECKED status moving_order_sort(mem *m, const moving_source *s, const float bounds[6],
                                 uint32_t numbers[]);
size_t moving_order_memory(uint32_t triangles);

#endif
