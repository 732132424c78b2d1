/* slice_source.h - samples as z slices, wherever they come from: what every reader of grids gives.
 *
 * A reader whose samples lie in order in one stream fills in a volume_layout, and
 * layout_slices_open() makes a source of that; others (chunks, one file a slice, a library) fill in
 * a source themselves. volume.h hands the slices out, with what hints say done to them.
 */
#ifndef FORMATS_GRID_SLICE_SOURCE_H
#define FORMATS_GRID_SLICE_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/grid/slice_tiles.h"

/* One of the fields that a file has: an array, a grid, a data set, a variable. */
typedef struct slice_field {
    const char *name;      /* as volume_hints.field takes it; "": the only one has none */
    uint32_t steps;        /* of time that it has; 1 or more */
    bool taken;            /* it is the one that the slices are of */
    const double *times;   /* of its steps, until take() returns; NULL: untold */
    const char *time_unit; /* "s", "days since 2000-01-01"; NULL: untold */
    uint32_t components;   /* numbers a sample; 0: 1 */
    uint32_t component;    /* of several, which one is read, from 1; 0: all, */
    bool colours;          /* as their luminance, or else as their magnitude */
} slice_field;

/* Whom they are told to, in the file's order. What is not ST_OK ends it, and is passed on. */
typedef struct slice_fields {
    status (*take)(void *ctx, const slice_field *field);
    void *ctx;
} slice_fields;

/* Zeros: none. */
typedef struct slice_source {
    const char *format;   /* "NRRD"; constant */
    const char *importer; /* the verb's end, "vdb", where it reads the file; NULL: this process */
    const char *name;     /* for messages: the file; lives as long as the source */
    bool has_fields;      /* hints' field, component and step were looked at */
    mem *m;               /* the grid's axes are of it */
    grid g;               /* passes grid_check() */
    /* Slices first, first + 1, .. of g.type in native byte order, count * grid_slice_bytes() of
     * them. Called for all slices in order, from 0 on, by one thread. What is not ST_OK ends the
     * reading, and is what volume_read() returns. */
    status (*read)(void *ctx, uint32_t first, uint32_t count, void *slices);
    /* The same where large parts may be one value, with a map for each slice (slice_tiles.h):
     * before, what `slices` holds, after, what has been read. NULL: this is not told. */
    status (*read_tiles)(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy);
    uint8_t quiet[SLICE_SAMPLE_MAX]; /* that value, a sample of g.type */
    /* Behind the last slice: check what follows, and count it; see volume_finish(). NULL: nothing
     * can follow. */
    status (*finish)(void *ctx, uint64_t *trailing);
    /* Behind the last slice of a step that is not the file's last: on to the next step's, where the
     * hints' all_steps was given. NULL: it has to be opened for each. */
    void (*next_step)(void *ctx);
    void (*close)(void *ctx); /* NULL: nothing to do */
    void *ctx;
    /* The most that a sample read so far was rounded by on its way to g.type, as by a slope; of
     * ctx. NULL: none is. */
    const double *rounding;
    /* All fields that could have been asked for. NULL: there is one, without a name, of one step.
     */
    status (*fields)(void *fields_ctx, const slice_fields *to);
    void *fields_ctx;
} slice_source;

/* slice_source_close() - and release its grid. Zeros are fine. */
static inline void slice_source_close(slice_source *s) {
    if (s->close)
        s->close(s->ctx);
    grid_release(&s->g, s->m);
    *s = (slice_source){0};
}

#endif
