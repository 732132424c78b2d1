/* grid_reader.h - a row of volume.c's table: how a format of grids is recognised and opened. */
#ifndef FORMATS_GRID_GRID_READER_H
#define FORMATS_GRID_GRID_READER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/status.h"
#include "formats/grid/slice_source.h"
#include "formats/grid/volume_hints.h"
#include "formats/grid/volume_layout.h"

enum { GRID_READER_PEEK = 4096 };

typedef struct grid_reader {
    const char *format; /* for messages: "NRRD" */
    /* The file's first bytes (up to GRID_READER_PEEK) say so, or its path ("-": standard input). */
    bool (*known)(const char *path, const uint8_t *start, size_t size);
    /* One of the two; each may use l->m, and l->data, which is at the start of the file, and may
     * exchange the latter. Whoever calls releases l in any case.
     *   layout   read the header and say in l where and how the samples lie, in order;
     *   slices   give a source of another order. It may keep l->data: then l->data becomes NULL. */
    status (*layout)(volume_layout *l, const volume_hints *hints);
    status (*slices)(volume_layout *l, const volume_hints *hints, slice_source *out);
} grid_reader;

#endif
