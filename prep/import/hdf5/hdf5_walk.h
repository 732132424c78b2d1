/* hdf5_walk.h - visits all data sets of an HDF5 file, in linear time.
 *
 * Hard links are followed, into each group once, so cycles end. Soft and external links are not
 * followed. (H5Ovisit() opens every object by its path from the root. For 3000 nested groups it
 * took half a minute.)
 */
#ifndef PREP_IMPORT_HDF5_HDF5_WALK_H
#define PREP_IMPORT_HDF5_HDF5_WALK_H

#include <hdf5.h>

#include "formats/base/status.h"

enum { HDF5_PATH = 1024, HDF5_DEPTH_MAX = 100 };

/* Called with the full path of each data set. Any status but ST_OK ends the walk. */
typedef status hdf5_walk_take(void *ctx, const char *path);

/* hdf5_walk() - name: of the file, for messages. ST_UNSUPPORTED: groups are nested deeper than
 * HDF5_DEPTH_MAX. Objects with a path longer than HDF5_PATH are skipped. */
CHECKED status hdf5_walk(hid_t file, const char *name, hdf5_walk_take *take, void *ctx);

#endif
