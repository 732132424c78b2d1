/* zarr.h - Zarr arrays of version 2, folders of chunks, and OME-Zarr: the array of full resolution.
 *
 * Format: https://zarr-specs.readthedocs.io/en/latest/v2/v2.0.html,
 * https://ngff.openmicroscopy.org. Understood: chunks of any size, whose order in memory is C or
 * Fortran; absent chunks have the fill value, and are counted (absent.h); raw, or packed as zlib,
 * gzip, zstd, bz2, lzma, lz4, and, where libblosc is there, blosc; types as in npy.h, but for
 * complex ones; both dimension_separators. Axes as OME names them (x, y, z, t: steps, c: numbers of
 * a sample, the first by default), else as npy.h has them, or (t, c, z, y, x). Spacings, origin and
 * times by OME's scales and translations, with the units of its axes. In a group, the one array
 * that there is, or hints' field. Filters: zarr_filter.h. Refused with ST_UNSUPPORTED: version 3,
 * other filters, structures.
 */
#ifndef FORMATS_GRID_ZARR_H
#define FORMATS_GRID_ZARR_H

#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_hints.h"

/* zarr_known() - returns whether a folder is a Zarr array or group. */
bool zarr_known(const char *folder);

/* zarr_open() - open the slices of a folder. Holds a layer of chunks, or as much of it as fits a
 * quarter of the budget: chunks are then unpacked more than once. */
CHECKED status zarr_open(mem *m, const char *folder, const volume_hints *hints, slice_source *out);

#endif
