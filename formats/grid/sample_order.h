/* sample_order.h - samples whose order differs from a grid's: z fastest, say, or all first
 * components before all second ones. */
#ifndef FORMATS_GRID_SAMPLE_ORDER_H
#define FORMATS_GRID_SAMPLE_ORDER_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"

/* The axes of samples. In a grid ORDER_COMPONENT is fastest, then ORDER_X. */
enum { ORDER_X, ORDER_Y, ORDER_Z, ORDER_COMPONENT, ORDER_STEP, ORDER_AXES };

typedef struct sample_order {
    uint8_t axis[ORDER_AXES];   /* the input's axes, the fastest first */
    uint32_t count[ORDER_AXES]; /* numbers along ORDER_X, .. */
    size_t width;               /* bytes of a number */
} sample_order;

/* Reads the input's bytes, in the input's order. */
typedef struct sample_bytes {
    status (*read)(void *ctx, void *to, size_t bytes);
    status (*skip)(void *ctx, uint64_t bytes);
    void *ctx;
} sample_bytes;

/* sample_order_gather() - read past all numbers, from the first to the last, and put those within
 * first .. end - 1 along each axis into out, in the order of a grid. run: room for the numbers
 * along axis[0]. */
CHECKED status sample_order_gather(const sample_order *o, const sample_bytes *from,
                                   const uint32_t first[ORDER_AXES], const uint32_t end[ORDER_AXES],
                                   void *run, void *out);

#endif
