/* zarr_files.h - arrays of Zarr made by hand in the scratch folder, of numbers that follow from
 * their indices. */
#ifndef TESTS_SUPPORT_ZARR_FILES_H
#define TESTS_SUPPORT_ZARR_FILES_H

#include <stdbool.h>

#include "formats/base/sample.h"

enum { ZARR_FILES_AXES = 5 };

typedef struct zarr_files {
    int axes; /* 3: z, y, x; 4: z, y, x, numbers, or steps, z, y, x; 5: steps, numbers, z, y, x */
    int shape[ZARR_FILES_AXES], chunk[ZARR_FILES_AXES];
    sample_type type; /* not f16 */
    bool big_endian, fortran;
    char separator;
    const char *packer; /* "zlib", "zstd"; NULL: none */
    bool shuffled;
    int absent; /* each n-th chunk has no file; 0: all have one */
} zarr_files;

/* zarr_files_make() - write the array, in place of one of this name. Returns its path. */
const char *zarr_files_make(const zarr_files *z, const char *name);

/* zarr_files_value() - the number at these indices, if its chunk has a file. */
double zarr_files_value(const zarr_files *z, const int at[ZARR_FILES_AXES]);

#endif
