/* grid_reader.h - how one format of grids is recognised and opened: a row of volume.c's table. */
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
    /* Returns whether the path or the first bytes are this format's. path: "-": standard input.
     * start: up to GRID_READER_PEEK bytes. */
    bool (*known)(const char *path, const uint8_t *start, size_t size);
    /* One of these two. Each may use l->m and l->data, which is at the start of the file, and may
     * replace l->data. The caller releases l in any case.
     *   layout   read the header, and say in l where and how the samples lie, in order;
     *   slices   make a source for another order. It may keep l->data: then l->data becomes NULL.
     */
    status (*layout)(volume_layout *l, const volume_hints *hints);
    status (*slices)(volume_layout *l, const volume_hints *hints, slice_source *out);
} grid_reader;

#endif
