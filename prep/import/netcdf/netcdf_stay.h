/* netcdf_stay.h - where the samples of a step of a variable lie in a classic file, for those who
 * leave them there: in one piece, big endian.
 *
 * Scale, offset and one fill value go along, where they give the same samples as packed_samples.h.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_STAY_H
#define PREP_IMPORT_NETCDF_NETCDF_STAY_H

#include "formats/base/file.h"
#include "formats/grid/sample_place.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* netcdf_stay_find() - the place of a step, which begins at an index per dimension, `start`.
 * Refused where samples cannot stay. Returns false for files of other formats. */
bool netcdf_stay_find(file *f, const netcdf_variable *v, const size_t *start, sample_place *out);

/* netcdf_stay_numbers() - say in *out what numbers become samples. Returns NULL, or a short static
 * text that says why it cannot be told. */
const char *netcdf_stay_numbers(const netcdf_variable *v, sample_place *out);

#endif
