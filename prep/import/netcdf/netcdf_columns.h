/* netcdf_columns.h - where the columns of nodes of a netCDF variable stand: on a globe or a plane.
 *
 * Longitudes and latitudes, of one or two dimensions each, are those that its attribute
 * `coordinates' names, else the coordinates of its dimensions, else any in its group that lie along
 * it. On a plane, lengths along x and y come first if there are any.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_COLUMNS_H
#define PREP_IMPORT_NETCDF_NETCDF_COLUMNS_H

#include "prep/import/netcdf/netcdf_frame.h"

#define NETCDF_EARTH 6371000.0 /* m; the mean radius */

typedef struct netcdf_columns {
    mem *m;
    bool sphere;
    bool closes; /* along x they go around the globe: the first one is behind the last one, too */
    bool seam;   /* a cell of some reaches across the plane: see netcdf_columns_is_torn() */
    bool moves;
    /* On a globe: a unit vector, z to the north pole. On a plane: x and y in metres, and degrees
     * from the middle to the east, or 0. Not finite: nowhere. */
    double (*at)[3];
} netcdf_columns;

/* netcdf_columns_find() - ST_UNSUPPORTED: nothing tells where they are. Release it in any case. */
CHECKED status netcdf_columns_find(const netcdf_frame *fr, bool sphere, netcdf_columns *c);
void netcdf_columns_release(netcdf_columns *c);

/* netcdf_columns_place() - the place of a height above a column's ground. */
void netcdf_columns_place(const netcdf_columns *c, size_t column, double height, double to[3]);

/* netcdf_columns_is_torn() - whether two columns of a plane lie on different sides of the seam,
 * half a turn from its middle. */
bool netcdf_columns_is_torn(const netcdf_columns *c, size_t a, size_t b);

#endif
