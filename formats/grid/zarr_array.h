/* zarr_array.h - read the JSONs of a Zarr folder: which array, how it is stored, where its nodes
 * lie. */
#ifndef FORMATS_GRID_ZARR_ARRAY_H
#define FORMATS_GRID_ZARR_ARRAY_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/base/world_frame.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/sample_order.h"
#include "formats/grid/stored_samples.h"
#include "formats/grid/volume_hints.h"

enum { ZARR_AXES = CHUNK_AXES, ZARR_PATH = CHUNK_FOLDER };

typedef struct zarr_array {
    char path[ZARR_PATH]; /* path of the array's folder */
    char name[GRID_NAME_MAX];
    chunk_array chunks; /* its axes without a role have one sample */
    uint32_t shape[ZARR_AXES];
    int axis[ORDER_AXES];                            /* the axis that has a role; -1: none */
    double scale[ZARR_AXES], translation[ZARR_AXES]; /* node i lies at translation + i * scale */
    char unit[ZARR_AXES][WORLD_TIME_UNIT];           /* "um"; "": unknown */
    stored_samples stored;
} zarr_array;

/* zarr_array_read() - read a folder. ST_CORRUPT, ST_UNSUPPORTED, ST_IO, naming the JSON. *out is
 * about 5 KB. */
CHECKED status zarr_array_read(mem *m, const char *folder, const volume_hints *hints,
                               zarr_array *out);

#endif
