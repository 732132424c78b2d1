/* hdf5_field.h - a data set of an HDF5 file as a grid: its axes, the type of its numbers, its
 * place.
 *
 * Axes are called by letters: x, y, z, t (time steps) and c (components), the fastest, which is the
 * last, at the end: "zyx". Their order comes from --axes, else from the attribute axistags (of
 * vigra and ilastik), else from the labels of the dimensions (DIMENSION_LABELS), else tzyx where
 * the first has a scale of times, else from their number: 3  zyx 4  zyxc where the last has at most
 * 4 samples, else tzyx 5  tzyxc where the last has at most 4 samples, else tczyx In VTKHDF files it
 * is zyx, zyxc, or with time steps tzyx, tzyxc.
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
    hid_t memory; /* type of an element as it is read */
    int rank;
    hsize_t dims[H5S_MAX_RANK];
    hsize_t chunk[H5S_MAX_RANK]; /* all 0 where samples are not in chunks */
    uint64_t chunk_bytes;
    int at[HDF5_AXES];      /* which dimension is x, y, ..; -1: none */
    packed_samples packed;  /* components: those inside of an element */
    absent_parts absent;    /* what is known to be missing */
    bool minc;              /* an image of MINC 2 (hdf5_minc.h) */
    bool scale;             /* it is the scale of a dimension */
    bool map;               /* refused, since it is a map that changes in time */
    bool denied;            /* refuse says what it may not read, or lacks */
    char type[HDF5_TEXT];   /* for people */
    char refuse[HDF5_TEXT]; /* why it cannot be read; "": it can */
} hdf5_field;

/* hdf5_field_open() - a data set of the open file, whose name is `name`; axes: of --axes, or NULL.
 * false where it cannot even be opened. Release it in any case. */
bool hdf5_field_open(hid_t file, const char *name, const char *path, const char *axes,
                     hdf5_field *out);
void hdf5_field_release(hdf5_field *f);

/* hdf5_field_count() - samples along an axis, HDF5_X ..; 1 where there is none. */
hsize_t hdf5_field_count(const hdf5_field *f, int axis);

/* hdf5_field_place() - spacing, directions and origin into to_world: of VTKHDF image data, else of
 * attributes of the data set or its group (see the manual). The grid's dims are set. ST_CORRUPT,
 * ST_UNSUPPORTED. */
CHECKED status hdf5_field_place(hid_t file, const char *name, const char *path, const hdf5_field *f,
                                grid *g);

/* hdf5_vtk_array() - whether a path is that of an array of VTKHDF image data; refuse: why the group
 * that it is in cannot be read. */
bool hdf5_vtk_array(hid_t file, const char *path, char *refuse, size_t room);

#endif
