/* hdf5_storage.h - where the samples of a data set are, when they are not where one expects them.
 *
 * An HDF5 file can name others in three ways: external links, whose target is an object of another
 * file; external storage, raw samples in any file; virtual data sets, put together from data sets
 * of others. All follow the rule of formats/input/named_file.h; relative names are looked for
 * beside the file that has them. And it can lack samples, for which the library gives zeros or the
 * fill value, and says nothing: an external file that is short, a source that is not there, chunks
 * that were never written.
 */
#ifndef PREP_IMPORT_HDF5_HDF5_STORAGE_H
#define PREP_IMPORT_HDF5_HDF5_STORAGE_H

#include <hdf5.h>
#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/absent.h"
#include "formats/input/input_trust.h"

/* hdf5_storage_begin() - before the process opens any HDF5 file: from then on external links keep
 * to the rule, whoever follows them. The environment's HDF5_EXTFILE_PREFIX and HDF5_VDS_PREFIX
 * count only where trust lets names lead anywhere. */
CHECKED status hdf5_storage_begin(mem *m, const input_trust *trust);

/* hdf5_storage_denied() - of the external links followed since the last call, why one was refused;
 * ST_OK: none was. */
CHECKED status hdf5_storage_denied(void);

/* hdf5_storage_access() - how data sets have to be opened for relative names to be found; to be
 * closed by H5Pclose(). */
hid_t hdf5_storage_access(void);

/* hdf5_storage_check() - of an open data set, before its space is asked for: it may read what it
 * names, and that is there. file, path: of the set. ST_CORRUPT and ST_UNSUPPORTED name the file;
 * absent: parts that are known to be missing where trust allows it, and chunks never written. */
CHECKED status hdf5_storage_check(hid_t set, const char *file, const char *path, absent_parts *out);

#endif
