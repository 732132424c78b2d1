/* hdf5_field.h - a data set of an HDF5 file as a grid: its axes, the type of its numbers, its
 * place.
 *
 * Axes are letters: x, y, z, t (time steps) and c (components), the fastest last: "zyx". Their
 * order is the first known of: --axes; the attribute axistags (of vigra and ilastik); the labels of
 * the dimensions (DIMENSION_LABELS); tzyx, if the first dimension has a scale of times. Else it
 * depends on the number of dimensions:
 * - 3: zyx
 * - 4: zyxc if the last has at most 4 samples, else tzyx
 * - 5: tzyxc if the last has at most 4 samples, else tczyx
 *
 * In VTKHDF files it is zyx, zyxc, or with time steps tzyx, tzyxc.
 */
#ifndef PREP_IMPORT_HDF5_HDF5_FIELD_H
#define PREP_IMPORT_HDF5_HDF5_FIELD_H

#include <hdf5.h>
#include <stdbool.h>

#include "formats/grid/grid.h"
#include "prep/import/hdf5/hdf5_walk.h"
#include "prep/import/importer.h"
#include "prep/import/packed_samples.h"

enum { HDF5_TEXT = 600, HDF5_AXES = 5 };
enum { HDF5_X, HDF5_Y, HDF5_Z, HDF5_T, HDF5_C };

typedef struct hdf5_field {
    hid_t set;
    hid_t memory; /* memory type of an element */
    int rank;
    hsize_t dims[H5S_MAX_RANK];
    hsize_t chunk[H5S_MAX_RANK]; /* all 0 if samples are not in chunks */
    uint64_t chunk_bytes;
    int at[HDF5_AXES];      /* the dimension of x, y, ..; -1: none */
    packed_samples packed;  /* components: only those inside of an element */
    absent_parts absent;    /* parts known to be missing */
    bool minc;              /* an image of MINC 2 (hdf5_minc.h) */
    bool scale;             /* it is a dimension's scale */
    bool map;               /* refused, because it is a map that changes in time */
    bool denied;            /* refused, because it may not be read or parts are missing; see
                               refuse */
    char type[HDF5_TEXT];   /* a description for people */
    char refuse[HDF5_TEXT]; /* why it cannot be read; "": it can */
} hdf5_field;

/* hdf5_field_open() - describe a data set of the open file called `name`. axes: of --axes, or NULL.
 * Returns false if it cannot be opened. Release it in any case. */
bool hdf5_field_open(hid_t file, const char *name, const char *path, const char *axes,
                     hdf5_field *out);
void hdf5_field_release(hdf5_field *f);

/* hdf5_field_count() - samples along an axis, HDF5_X ..; 1 if there is no such axis. */
hsize_t hdf5_field_count(const hdf5_field *f, int axis);

/* hdf5_field_place() - set spacing, directions and origin in to_world: from VTKHDF image data, else
 * from attributes of the data set or its group (see the manual). The grid's dims must be set.
 * ST_CORRUPT, ST_UNSUPPORTED. */
CHECKED status hdf5_field_place(hid_t file, const char *name, const char *path, const hdf5_field *f,
                                grid *g);

/* hdf5_vtk_array() - returns whether a path is an array of VTKHDF image data. refuse: why its group
 * cannot be read. */
bool hdf5_vtk_array(hid_t file, const char *path, char *refuse, size_t room);

#endif
