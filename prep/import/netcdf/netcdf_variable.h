/* netcdf_variable.h - a variable of a netCDF file as a grid, by the CF conventions.
 *
 * Its last three dimensions are z, y and x. All in front of them are time steps, counted as one
 * axis. The coordinate variables of the dimensions give its place.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_VARIABLE_H
#define PREP_IMPORT_NETCDF_NETCDF_VARIABLE_H

#include <netcdf.h>
#include <stdbool.h>
#include <stdint.h>

#include "formats/grid/grid.h"
#include "prep/import/packed_samples.h"

enum { NETCDF_TEXT = 240, NETCDF_RANK = 16, NETCDF_PATH = 4 * NC_MAX_NAME };

typedef struct netcdf_variable {
    int group, id;          /* the library's ids */
    char path[NETCDF_PATH]; /* "TEMP"; inside a group "model/TEMP" */
    int rank;
    int dim[NETCDF_RANK];
    size_t count[NETCDF_RANK];
    bool grows;                /* the first dimension is unlimited */
    uint64_t steps;            /* over all dimensions in front of the last three; 1: none */
    int time;                  /* the dimension that counts times; -1: none */
    size_t chunk[NETCDF_RANK]; /* all 0 if samples are not in chunks */
    uint64_t chunk_bytes;
    packed_samples packed;
    bool minc;                /* an image of MINC 1 (netcdf_minc.h) */
    char units[64];           /* "": unknown */
    char type[NETCDF_TEXT];   /* a description for people */
    char refuse[NETCDF_TEXT]; /* why it cannot be read; "": it can */
} netcdf_variable;

/* netcdf_variable_find() - describe variable id of a group. prefix: the group's path, "" or "a/".
 */
void netcdf_variable_find(int group, int id, const char *prefix, netcdf_variable *out);

/* netcdf_variable_prefix() - the path of a group as netcdf_variable_find() takes it: "", "a/b/".
 * Returns false where there is no room for it, and "". */
bool netcdf_variable_prefix(int group, char *to, size_t room);

/* netcdf_variable_stacked() - returns whether its times would be slices: they are among the last
 * three dimensions, and the rest is no volume. */
bool netcdf_variable_stacked(const netcdf_variable *v);

/* netcdf_variable_place() - set spacing and origin, or axes, by the coordinates of the last three
 * dimensions. Those without coordinates keep indices; with `indices`, all do. The grid's dims must
 * be set. Distances are equal if no coordinate is off by more than a thousandth of the step.
 * Longitudes that turn over from 360 to 0 go on. Coordinates that grow downwards
 * (netcdf_goes_down()) are negated, so that up is up. The grid's note tells of that, and of
 * coordinates that are not used. ST_CORRUPT: coordinates are not monotonic. */
CHECKED status netcdf_variable_place(mem *m, const char *file, const netcdf_variable *v,
                                     bool indices, grid *g);

/* netcdf_variable_times() - times of its steps and their unit, if the steps are one dimension with
 * coordinates. *times is allocated from m, or NULL: unknown. */
CHECKED status netcdf_variable_times(mem *m, const char *file, const netcdf_variable *v,
                                     double **times, char unit[WORLD_TIME_UNIT]);

/* netcdf_text() - read a text attribute; "": there is none. */
void netcdf_text(int group, int id, const char *name, char *to, size_t room);

/* netcdf_number() - read a numeric attribute of one number, or the i-th of several. */
bool netcdf_number(int group, int id, const char *name, size_t i, long double *out);

#endif
