/* netcdf_heights.h - the heights of the nodes of a netCDF variable, in metres, upwards.
 *
 * They are those of a variable of three dimensions that its attribute `coordinates' names; else, of
 * WRF, its geopotential; else the coordinates of its third last dimension: by a formula that they
 * name (netcdf_formulas.h), or if they are lengths or pressures.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_HEIGHTS_H
#define PREP_IMPORT_NETCDF_NETCDF_HEIGHTS_H

#include "formats/grid/slice_source.h"
#include "prep/import/netcdf/netcdf_formulas.h"
#include "prep/import/netcdf/netcdf_frame.h"

/* A number of a formula. */
typedef struct netcdf_part {
    double *levels; /* of each level; or */
    float *map;     /* of each column; or */
    double alone;
} netcdf_part;

/* A variable of three dimensions, one plane after the other. */
typedef struct netcdf_planes {
    char path[NETCDF_PATH];
    size_t has[3];
    double factor;
    uint32_t step;       /* its own, counted through its dimensions */
    slice_source source; /* zeros: it is to be opened */
    uint32_t next;       /* its next plane */
    double *last[2];     /* the planes before that, over the frame's columns; [1] is the later */
} netcdf_planes;

enum { NETCDF_VOLUMES = 2 };

typedef struct netcdf_heights {
    mem *m;
    const netcdf_frame *fr;
    const import_request *q;
    bool moves; /* they differ from step to step */
    bool pressure;
    double *levels; /* of each level; or */
    const netcdf_formula *formula;
    netcdf_part parts[NETCDF_TERMS]; /* or */
    netcdf_planes planes[NETCDF_VOLUMES];
    int volumes;
    uint32_t turned; /* level, from 1 on, that they have been turned to */
    void *raw;       /* room for a plane as it is stored */
    double *plane;   /* and for its numbers */
} netcdf_heights;

/* netcdf_heights_find() - ST_UNSUPPORTED: nothing tells them. q: the request that opens variables
 * of three dimensions; it and fr must live as long. Release *h in any case. */
CHECKED status netcdf_heights_find(const netcdf_frame *fr, const import_request *q,
                                   netcdf_heights *h);
void netcdf_heights_release(netcdf_heights *h);

/* netcdf_heights_turn() - turn to a level: the next one, or any lower one. netcdf_heights_at() -
 * the height of a column there; NaN: missing. */
CHECKED status netcdf_heights_turn(netcdf_heights *h, uint32_t level);
double netcdf_heights_at(const netcdf_heights *h, size_t column, uint32_t level);

#endif
