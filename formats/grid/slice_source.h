/* slice_source.h - samples as z slices, wherever they come from: the result of every reader of
 * grids.
 *
 * A reader whose samples lie in order in one stream fills in a volume_layout, and
 * layout_slices_open() makes a source from it. Other readers (chunks, one file a slice, a library)
 * fill in a source themselves. volume.h applies the hints to the slices and hands them out.
 */
#ifndef FORMATS_GRID_SLICE_SOURCE_H
#define FORMATS_GRID_SLICE_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/grid.h"
#include "formats/grid/slice_tiles.h"

struct sample_place;

/* One of a file's fields: an array, a grid, a data set, a variable. */
typedef struct slice_field {
    const char *name;      /* as volume_hints.field names it; "": the only field, without a name */
    uint32_t steps;        /* number of its time steps; 1 or more */
    bool taken;            /* the slices are of this field */
    const double *times;   /* times of its steps, valid until take() returns; NULL: unknown */
    const char *time_unit; /* "s", "days since 2000-01-01"; NULL: unknown */
    uint32_t components;   /* numbers a sample; 0: 1 */
    uint32_t component;    /* the component that is read, from 1; 0: all together */
    bool colours;          /* all together are their luminance; false: their magnitude */
} slice_field;

/* Receives the fields in the file's order. A status other than ST_OK ends the list and is passed
 * on. */
typedef struct slice_fields {
    status (*take)(void *ctx, const slice_field *field);
    void *ctx;
} slice_fields;

/* Zeros: no source. */
typedef struct slice_source {
    const char *format;   /* "NRRD"; a constant */
    const char *importer; /* "vdb" where leafcast-import-vdb reads it; NULL: this process */
    const char *name;     /* the file, for messages; lives as long as the source */
    bool
        has_missing; /* samples that are `missing` are to be read as NaN, unless a hint says else */
    double missing;
    bool has_fields; /* the hints' field, component and step have been applied */
    mem *m;          /* owns the grid's axes */
    grid g;          /* passes grid_check() */
    /* Read slices first, first + 1, .. of g.type in native byte order: count * grid_slice_bytes().
     * Called for all slices in order, from 0 on, by one thread. A status other than ST_OK ends the
     * reading, and volume_read() returns it. */
    status (*read)(void *ctx, uint32_t first, uint32_t count, void *slices);
    /* The same where large parts may be one value, with a map for each slice (slice_tiles.h). On
     * entry the map says what `slices` holds, on return what has been read. NULL: the source has no
     * maps. */
    status (*read_tiles)(void *ctx, uint32_t first, uint32_t count, void *slices, uint8_t *busy);
    uint8_t quiet[SLICE_SAMPLE_MAX]; /* that value, as a sample of g.type */
    /* Move on by so many slices, without reading them. NULL: they have to be read. */
    status (*skip)(void *ctx, uint32_t count);
    /* Say where the samples lie as they are, missing data aside; false: nowhere. NULL likewise. */
    bool (*place)(void *place_ctx, struct sample_place *out);
    void *place_ctx;
    /* Called behind the last slice: check and count what follows, see volume_finish(). NULL:
     * nothing can follow. */
    status (*finish)(void *ctx, uint64_t *trailing);
    /* Called behind the last slice of a step that is not the file's last, if the hints had
     * all_steps: go on to the next step. NULL: each step has to be opened. */
    void (*next_step)(void *ctx);
    void (*close)(void *ctx); /* NULL: nothing to do */
    void *ctx;
    /* The largest error so far of rounding a sample to g.type, as after a slope. Belongs to ctx.
     * NULL: nothing is rounded. */
    const double *rounding;
    /* Tell all fields that can be asked for. NULL: there is one, without a name, of one step. */
    status (*fields)(void *fields_ctx, const slice_fields *to);
    void *fields_ctx;
} slice_source;

/* slice_source_close() - close it and release its grid. Zeros are fine. */
static inline void slice_source_close(slice_source *s) {
    if (s->close)
        s->close(s->ctx);
    grid_release(&s->g, s->m);
    *s = (slice_source){0};
}

#endif
