/* zarr_present.h - how many chunks of a Zarr array have a file. */
#ifndef FORMATS_GRID_ZARR_PRESENT_H
#define FORMATS_GRID_ZARR_PRESENT_H

#include <stdint.h>

#include "formats/base/status.h"
#include "formats/grid/zarr_array.h"

/* Chunks by their indices, of each axis first .. last. */
typedef struct zarr_range {
    uint32_t first[ZARR_AXES], last[ZARR_AXES];
} zarr_range;

/* zarr_present_count() - the files of chunks in the range, by what the array's folder lists: the
 * work is that of what is there, however large the array says to be. ST_IO where a folder cannot be
 * read. */
CHECKED status zarr_present_count(const zarr_array *a, const zarr_range *range, uint64_t *count);

#endif
