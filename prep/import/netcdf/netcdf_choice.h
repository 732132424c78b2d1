/* netcdf_choice.h - which variable of a netCDF file is taken, and the list of all. */
#ifndef PREP_IMPORT_NETCDF_NETCDF_CHOICE_H
#define PREP_IMPORT_NETCDF_NETCDF_CHOICE_H

#include "prep/import/importer.h"
#include "prep/import/netcdf/netcdf_file.h"

/* Options beside an import_request. */
typedef struct netcdf_wish {
    bool indices;    /* ignore coordinates */
    bool stack_time; /* times may be slices: a map that changes in time becomes a volume */
} netcdf_wish;

/* netcdf_choice_find() - find q's variable, or the largest field (netcdf_roles.h) that can be read
 * and has q's step. ST_USAGE, ST_UNSUPPORTED: there is none. */
CHECKED status netcdf_choice_find(const netcdf_file *f, const import_request *q,
                                  const netcdf_wish *wish, netcdf_variable *out);

/* netcdf_choice_list() - list all variables of all groups. judge(): set v's reason of refusal, if
 * it does not go with the one that is taken; NULL: each is judged by itself. */
CHECKED status netcdf_choice_list(const netcdf_file *f, const import_request *q,
                                  const netcdf_wish *wish,
                                  void (*judge)(const netcdf_variable *taken, netcdf_variable *v),
                                  const import_list *to);

/* netcdf_choice_start() - the index of q's step in each dimension of a variable; 0 in the last
 * three. ST_USAGE: it has no such step. */
CHECKED status netcdf_choice_start(const import_request *q, const netcdf_variable *v,
                                   size_t start[NETCDF_RANK]);

#endif
