/* zarr_writer.h - samples of a treelet file as OME-Zarr: a folder, in version 2 of Zarr, with one
 * array in chunks.
 *
 *   PATH/.zgroup  PATH/.zattrs   an image of one resolution, after OME-NGFF 0.4: axes, their units,
 *                                scale and translation
 *   PATH/0/.zarray               the array, (z, y, x), or (t, z, y, x) of several steps
 *   PATH/0/K/J/I                 a chunk of up to 64^3 samples, packed by zstd; each is there
 *
 * Chunks are made by many threads, each of as few treelets as it needs. The bytes depend on neither
 * threads nor budget.
 */
#ifndef PREP_EXPORT_ZARR_WRITER_H
#define PREP_EXPORT_ZARR_WRITER_H

#include "prep/export/sample_format.h"

/* zarr_writer_check() - ST_UNSUPPORTED for a rectilinear grid, or axes that are turned, sheared or
 * reversed against the world's. zarr_writer_loses(), .._times() - see sample_format.h. */
CHECKED status zarr_writer_check(const grid *g);
const char *zarr_writer_loses(const grid *g);
const char *zarr_writer_loses_times(const sample_times *times);

/* zarr_writer_run() - write the whole folder; see out_folder.h. ST_NOMEM names the smallest budget
 * that would do. */
CHECKED status zarr_writer_run(mem *m, const sample_export *e);

#endif
