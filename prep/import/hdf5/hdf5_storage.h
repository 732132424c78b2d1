/* hdf5_storage.h - checks data sets whose samples are in other files, or missing.
 *
 * An HDF5 file can name others in three ways. External links: the target is an object of another
 * file. External storage: raw samples in any file. Virtual data sets: put together from data sets
 * of other files. All follow the rule of formats/input/named_file.h. Relative names are looked for
 * beside the file that has them. Samples can also be missing: an external file is too short, a
 * source does not exist, chunks were never written. Then the library silently gives zeros or the
 * fill value.
 */
#ifndef PREP_IMPORT_HDF5_HDF5_STORAGE_H
#define PREP_IMPORT_HDF5_HDF5_STORAGE_H

#include <hdf5.h>
#include <stdbool.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/absent.h"
#include "formats/input/input_trust.h"

/* hdf5_storage_begin() - call it before the process opens any HDF5 file. From then on external
 * links keep to the rule, whoever follows them. The environment's HDF5_EXTFILE_PREFIX and
 * HDF5_VDS_PREFIX count only if trust lets names lead anywhere. */
CHECKED status hdf5_storage_begin(mem *m, const input_trust *trust);

/* hdf5_storage_denied() - why an external link followed since the last call was refused; ST_OK:
 * none was. */
CHECKED status hdf5_storage_denied(void);

/* hdf5_storage_access() - the access list with which to open data sets, so that relative names are
 * found. Close it by H5Pclose(). */
hid_t hdf5_storage_access(void);

/* hdf5_storage_check() - check that an open data set may read the files it names, and that these
 * exist. Call it before asking for its space. file, path: of the set. ST_CORRUPT and ST_UNSUPPORTED
 * name the file. absent: parts known to be missing if trust allows that, and chunks never
 * written. */
CHECKED status hdf5_storage_check(hid_t set, const char *file, const char *path, absent_parts *out);

#endif
