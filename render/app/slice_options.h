/* slice_options.h - where a slice lies, by the flags of `leafcast slice`. */
#ifndef RENDER_APP_SLICE_OPTIONS_H
#define RENDER_APP_SLICE_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "formats/base/mem.h"
#include "render/leafcast.h"

/* How a slice was described. */
typedef enum slice_way {
    SLICE_ACROSS, /* an axis of the world, at a coordinate or in the middle */
    SLICE_LAYER,  /* an axis of the grid, through its nodes of a number */
    SLICE_PLANE,  /* as an equation */
    SLICE_FRAME,  /* a corner and two edges */
    SLICE_LINE    /* a polyline that is swept */
} slice_way;

/* Zeroed but for m before the first flag. */
typedef struct slice_options {
    mem *m;
    uint64_t given; /* which flags */
    int axis;
    double at, plane[4];
    uint32_t index;
    bool fit; /* no --size */
    slice_way way;
    double (*line)[3];           /* of m */
    leafcast_slice_pixels slice; /* what flags said; slice_options_place() makes the rest */
} slice_options;

/* The rows that these options are, for argp; their keys begin at SLICE_OPTIONS_FIRST. */
enum { SLICE_OPTIONS_FIRST = 0x3100, SLICE_OPTIONS_END = 0x3120 };
extern const struct argp_option slice_options_table[];
enum { SLICE_OPTIONS_COUNT = 15 };

/* slice_options_set() - one flag; ST_USAGE, ST_NOMEM, ST_AGAIN: it is none of these. */
CHECKED status slice_options_set(slice_options *o, int key, const char *text);

/* slice_options_check() - that they go together: ST_USAGE. */
CHECKED status slice_options_check(slice_options *o);

/* slice_options_place() - all of o->slice, through this volume. */
CHECKED status slice_options_place(slice_options *o, const leafcast *volume);

void slice_options_release(slice_options *o);

#endif
