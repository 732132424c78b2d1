/* hdf5_walk.h - all data sets of an HDF5 file, in time that grows with what is there.
 *
 * Hard links are followed, into each group once, so that cycles end; soft and external ones are
 * not. (H5Ovisit() opens every object by its path from the root: 3000 groups, each in the one
 * before, took it half a minute.)
 */
#ifndef PREP_IMPORT_HDF5_HDF5_WALK_H
#define PREP_IMPORT_HDF5_HDF5_WALK_H

#include <hdf5.h>

#include "formats/base/status.h"

enum { HDF5_PATH = 1024, HDF5_DEPTH_MAX = 100 };

/* Told each data set: its full path. What is not ST_OK ends the walk. */
typedef status hdf5_walk_take(void *ctx, const char *path);

/* hdf5_walk() - name: of the file, for messages. ST_UNSUPPORTED for groups nested deeper than
 * HDF5_DEPTH_MAX; what has a path longer than HDF5_PATH is passed over. */
CHECKED status hdf5_walk(hid_t file, const char *name, hdf5_walk_take *take, void *ctx);

#endif
