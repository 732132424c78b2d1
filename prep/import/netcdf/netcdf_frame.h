/* netcdf_frame.h - the nodes of a variable, and other variables that say something of each: along
 * some of its axes.
 *
 * Staggered grids have values on nodes, on faces and on edges, so a variable may have one node more
 * or less along an axis than what tells its places. Means of two neighbours are taken then; at an
 * end where there is but one, that. A dimension of another axis is never taken for one.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_FRAME_H
#define PREP_IMPORT_NETCDF_NETCDF_FRAME_H

#include "prep/import/netcdf/netcdf_file.h"

typedef struct netcdf_frame {
    const netcdf_file *f;
    netcdf_variable v;
    size_t start[NETCDF_RANK]; /* of the step */
    uint32_t n[3];             /* nodes along x, y, z */
    size_t columns;            /* n[0] * n[1] */
} netcdf_frame;

/* Axes of a frame, as bits. */
enum { NETCDF_X = 1, NETCDF_Y = 2, NETCDF_Z = 4 };

typedef struct netcdf_term {
    netcdf_variable v;
    unsigned axes;             /* of its last dimensions */
    size_t start[NETCDF_RANK]; /* at the frame's step */
    bool moves;                /* it differs from step to step */
    bool exact;                /* its dimensions are the frame's own */
} netcdf_term;

/* netcdf_frame_term() - find how a variable lies along the frame. Returns false if it does not: it
 * has other dimensions, or no numbers. */
bool netcdf_frame_term(const netcdf_frame *fr, int group, int id, netcdf_term *t);

/* netcdf_frame_map() - read what a term without NETCDF_Z says of each column (i + n[0] * j), or at
 * NETCDF_Z alone of each level, as numbers of its units; NaN: missing. ST_CORRUPT: bytes of it are
 * missing, or were never written. */
CHECKED status netcdf_frame_map(const netcdf_frame *fr, const netcdf_term *t, double *to);
CHECKED status netcdf_frame_levels(const netcdf_frame *fr, const netcdf_term *t, double *to);

/* netcdf_frame_widen() - spread a plane of `has` numbers along x and y over the frame's columns. */
void netcdf_frame_widen(const netcdf_frame *fr, const double *from, const size_t has[2],
                        double *to);

#endif
