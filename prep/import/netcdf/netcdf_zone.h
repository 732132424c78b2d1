/* netcdf_zone.h - a netCDF variable, and those on the same nodes, as one zone of a curvilinear
 * grid: its nodes lie where longitudes, latitudes and heights say.
 *
 * On a globe: z to the north pole, x to longitude 0; on a plane: x to the east, y to the north, z
 * upwards, from the middle. In metres, heights times a factor. Nodes without a place are blanked;
 * so are the cells of a plane that would reach across it.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_ZONE_H
#define PREP_IMPORT_NETCDF_NETCDF_ZONE_H

#include "prep/import/importer.h"
#include "prep/import/netcdf/netcdf_choice.h"

/* netcdf_zone_open() - q's variables, or the largest field, at q's step. As importer.open_mesh().
 * ST_USAGE: variables lie on different nodes. */
CHECKED status netcdf_zone_open(mem *m, const import_request *q, const netcdf_wish *wish,
                                import_mesh *out);

/* netcdf_zone_list() - list all variables; those that lie on other nodes than the one that is taken
 * are refused. */
CHECKED status netcdf_zone_list(mem *m, const import_request *q, const netcdf_wish *wish,
                                const import_list *to);

#endif
