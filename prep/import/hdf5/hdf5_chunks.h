/* hdf5_chunks.h - where the chunks of a data set lie in its file, for files that leave their
 * samples there (convert --in-place). */
#ifndef PREP_IMPORT_HDF5_HDF5_CHUNKS_H
#define PREP_IMPORT_HDF5_HDF5_CHUNKS_H

#include "formats/grid/chunk_array.h"
#include "prep/import/hdf5/hdf5_field.h"

/* hdf5_chunks_describe() - describe a data set's chunks of plain numbers. Returns NULL, or a short
 * static text that says why nobody but the library can read them. */
const char *hdf5_chunks_describe(const hdf5_field *f, sample_type type, bool big_endian,
                                 chunk_array *out);

/* hdf5_chunks_find() - find the chunks in a range. *table: an entry for each, as in chunk_home, to
 * be freed. ST_CORRUPT: the library does not tell. */
CHECKED status hdf5_chunks_find(mem *m, const hdf5_field *f, const char *path, const chunk_array *a,
                                const chunk_range *range, chunk_entry **table);

#endif
