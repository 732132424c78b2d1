/* volume_hints.h - facts about a grid from the command line, where its file lacks them or has them
 * wrong. */
#ifndef FORMATS_GRID_VOLUME_HINTS_H
#define FORMATS_GRID_VOLUME_HINTS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/world_frame.h"
#include "formats/input/input_trust.h"

/* Zero/NULL = not given. */
typedef struct volume_hints {
    uint32_t dims[3];  /* raw: samples per axis */
    sample_type type;  /* raw: sample type */
    bool big_endian;   /* raw */
    uint64_t skip;     /* raw: header bytes to skip */
    double spacing[3]; /* overrides the input's spacing, scales an axis' coordinates; may be
                          negative */
    double origin[3];  /* world position of node (0, 0, 0) */
    bool has_origin;
    bool heights;      /* a grid of one slice is a field of elevations (heights_slices.h) */
    double exaggerate; /* scales the world's z (> 0), where degrees stand beside metres. An origin
                          given here stays where it is */
    bool has_axes; /* `axes` is given: which way the world's axes point, whatever the file says */
    world_axes axes;
    const char *unit; /* unit of lengths, whatever the file says */
    bool has_missing; /* samples equal to `missing` are read as NaN, no data; integers are then
                         handed out as f32, and one that f32 cannot hold is ST_UNSUPPORTED */
    double missing;
    const char *axis_file[3]; /* rectilinear: a text file with one coordinate a line (or split by
                                 white space), per axis */
    const char *name;         /* name of the data set, in place of the input's own */
    const char *field;        /* which of several: an array, a grid, a data set, a variable */
    uint32_t component; /* which of several numbers a sample: 1, 2, ..; 0: their magnitude, or the
                           luminance of colours */
    uint32_t step;      /* which of several time steps, from 0 */
    bool all_steps;     /* later steps will be read, too: see volume_next_step() */
    input_trust trust;
} volume_hints;

#endif
