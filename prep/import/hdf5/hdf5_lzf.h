/* hdf5_lzf.h - the filter of h5py's compression="lzf" for libhdf5, which has none.
 */
#ifndef PREP_IMPORT_HDF5_HDF5_LZF_H
#define PREP_IMPORT_HDF5_HDF5_LZF_H

#include <hdf5.h>
#include <stdbool.h>

enum { HDF5_LZF = 32000 };

/* hdf5_lzf_register() - from now on libhdf5 reads such chunks; it writes none. */
bool hdf5_lzf_register(void);

/* hdf5_lzf_check() - of filter `at` of a data set with chunks of this many bytes: NULL, or why its
 * chunks cannot be read. libhdf5 takes what the last filter gives for a whole chunk without looking
 * at its size, so the size must be told, and be right. */
const char *hdf5_lzf_check(hid_t plist, unsigned at, uint64_t chunk_bytes);

#endif
