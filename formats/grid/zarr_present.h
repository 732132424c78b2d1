/* zarr_present.h - count the chunks of a Zarr array that have a file. */
#ifndef FORMATS_GRID_ZARR_PRESENT_H
#define FORMATS_GRID_ZARR_PRESENT_H

#include <stdint.h>

#include "formats/base/status.h"
#include "formats/grid/zarr_array.h"

/* A range of chunks: indices first .. last along each axis. */
typedef struct zarr_range {
    uint32_t first[ZARR_AXES], last[ZARR_AXES];
} zarr_range;

/* zarr_present_count() - count the files of chunks in the range, from the listing of the array's
 * folder. The work depends on the files that are there, however large the array claims to be. ST_IO
 * where a folder cannot be read. */
CHECKED status zarr_present_count(const zarr_array *a, const zarr_range *range, uint64_t *count);

#endif
