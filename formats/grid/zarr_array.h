/* zarr_array.h - read the JSONs of a Zarr folder: which array, how it is stored, where its nodes
 * lie. */
#ifndef FORMATS_GRID_ZARR_ARRAY_H
#define FORMATS_GRID_ZARR_ARRAY_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/base/world_frame.h"
#include "formats/grid/sample_order.h"
#include "formats/grid/stored_samples.h"
#include "formats/grid/volume_hints.h"
#include "formats/grid/zarr_chunk.h"
#include "formats/grid/zarr_filter.h"

enum { ZARR_AXES = 8, ZARR_PATH = 4096 };

typedef struct zarr_array {
    char path[ZARR_PATH]; /* path of the array's folder */
    char name[GRID_NAME_MAX];
    int axes;
    uint32_t shape[ZARR_AXES], chunk[ZARR_AXES];
    int role[ZARR_AXES];  /* ORDER_X .. ORDER_STEP; -1: none, the axis has one sample */
    int axis[ORDER_AXES]; /* the axis that has a role; -1: none */
    double scale[ZARR_AXES], translation[ZARR_AXES]; /* node i lies at translation + i * scale */
    char unit[ZARR_AXES][WORLD_TIME_UNIT];           /* "um"; "": unknown */
    stored_samples stored;
    bool big_endian, fortran;
    char separator;
    zarr_codec codec;
    zarr_filters filters;
    uint8_t fill[8]; /* one number, native byte order */
} zarr_array;

/* zarr_array_read() - read a folder. ST_CORRUPT, ST_UNSUPPORTED, ST_IO, naming the JSON. *out is
 * about 5 KB. */
CHECKED status zarr_array_read(mem *m, const char *folder, const volume_hints *hints,
                               zarr_array *out);

#endif
