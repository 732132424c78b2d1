/* hdf5_lzf.h - the filter of h5py's compression="lzf", which libhdf5 lacks.
 */
#ifndef PREP_IMPORT_HDF5_HDF5_LZF_H
#define PREP_IMPORT_HDF5_HDF5_LZF_H

#include <hdf5.h>
#include <stdbool.h>

enum { HDF5_LZF = 32000 };

/* hdf5_lzf_register() - from now on libhdf5 can read such chunks; it writes none. */
bool hdf5_lzf_register(void);

/* hdf5_lzf_check() - check filter `at` of a data set with chunks of this many bytes. Returns NULL,
 * or why its chunks cannot be read. libhdf5 takes the last filter's output for a whole chunk
 * without checking its size, so the filter's parameters must give the size, and it must be
 * right. */
const char *hdf5_lzf_check(hid_t plist, unsigned at, uint64_t chunk_bytes);

#endif
