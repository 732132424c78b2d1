/* leafcast_grid.h - what the public headers share: a grid of samples in memory, described. */
#ifndef FORMATS_LEAFCAST_GRID_H
#define FORMATS_LEAFCAST_GRID_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum leafcast_sample_type {
    LEAFCAST_U8 = 1,
    LEAFCAST_I8 = 2,
    LEAFCAST_U16 = 3,
    LEAFCAST_I16 = 4,
    LEAFCAST_F32 = 5,
    LEAFCAST_U32 = 6, /* this type and the following ones are stored as f32 */
    LEAFCAST_I32 = 7,
    LEAFCAST_F64 = 8
} leafcast_sample_type;

/* Samples at the nodes of a grid, in the machine's own byte order; cells lie between eight nodes.
 * Node (i, j, k) is at to_world (i, j, k, 1), or at to_world (axis[0][i], axis[1][j], axis[2][k],
 * 1).
 */
typedef struct leafcast_grid {
    size_t size;
    uint32_t dims[3]; /* 2 to 2^20 on each axis */
    leafcast_sample_type type;
    double spacing[3]; /* magnitude 1e-100 to 1e100; 0: 1 */
    double origin[3];  /* of node (0, 0, 0); within 1e100 */
    /* 12 numbers, 3 rows of 4, within 1e100: replaces spacing and origin. NULL: they hold. */
    const double *to_world;
    /* Rectilinear grids: coordinates, ascending or descending. NULL: 0, 1, 2, .. */
    const double *axis[3];
} leafcast_grid;

#ifdef __cplusplus
}
#endif

#endif
