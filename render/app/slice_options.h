/* slice_options.h - the flags of `leafcast slice` that say where the slice lies. */
#ifndef RENDER_APP_SLICE_OPTIONS_H
#define RENDER_APP_SLICE_OPTIONS_H

#include <argp.h>
#include <stdbool.h>

#include "formats/base/mem.h"
#include "render/leafcast.h"

/* How a slice was described. */
typedef enum slice_way {
    SLICE_ACROSS, /* perpendicular to a world axis, at a coordinate or in the middle */
    SLICE_LAYER,  /* perpendicular to a grid axis, through the nodes of one index */
    SLICE_PLANE,  /* given by an equation */
    SLICE_FRAME,  /* given by a corner and two edges */
    SLICE_LINE    /* given by a polyline that is swept */
} slice_way;

/* Zero all but m before the first flag. */
typedef struct slice_options {
    mem *m;
    uint64_t given; /* one bit for each flag */
    int axis;
    double at, plane[4];
    uint32_t index;
    bool fit; /* no --size was given */
    slice_way way;
    double (*line)[3];           /* allocated from m */
    leafcast_slice_pixels slice; /* from flags; slice_options_place() fills in the rest */
} slice_options;

/* The table of these flags, for argp; keys begin at SLICE_OPTIONS_FIRST. */
enum { SLICE_OPTIONS_FIRST = 0x3100, SLICE_OPTIONS_END = 0x3120 };
extern const struct argp_option slice_options_table[];
enum { SLICE_OPTIONS_COUNT = 15 };

/* slice_options_set() - apply one flag. ST_USAGE, ST_NOMEM; ST_AGAIN: not one of these flags. */
CHECKED status slice_options_set(slice_options *o, int key, const char *text);

/* slice_options_check() - returns ST_USAGE for flags that contradict each other. */
CHECKED status slice_options_check(slice_options *o);

/* slice_options_place() - fill in all of o->slice, for this volume. */
CHECKED status slice_options_place(slice_options *o, const leafcast *volume);

void slice_options_release(slice_options *o);

#endif
