/* hdf5_roles.h - finds data sets of an HDF5 file that describe others and are no fields: scales of
 * dimensions, and sets named in attributes by the CF conventions (cf_names.h).
 */
#ifndef PREP_IMPORT_HDF5_HDF5_ROLES_H
#define PREP_IMPORT_HDF5_HDF5_ROLES_H

#include <hdf5.h>
#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* Zeros: no such set is known. */
typedef struct hdf5_roles {
    mem *m;
    hid_t file;
    char **paths; /* of data sets named in attributes */
    size_t count, room;
} hdf5_roles;

/* hdf5_roles_find() - visit all data sets of a file. name: for messages. Release it in any case. */
CHECKED status hdf5_roles_find(mem *m, hid_t file, const char *name, hdf5_roles *out);
void hdf5_roles_release(hdf5_roles *r);

/* hdf5_roles_describes() - returns whether a data set describes others. */
bool hdf5_roles_describes(const hdf5_roles *r, const char *path);

/* hdf5_is_scale() - returns whether an open data set is the scale of a dimension.
 * hdf5_time_dimension() - the dimension of a data set whose scale counts times; -1: none does. */
bool hdf5_is_scale(hid_t set);
int hdf5_time_dimension(hid_t set);

#endif
