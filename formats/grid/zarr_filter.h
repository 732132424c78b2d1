/* zarr_filter.h - undo numcodecs' filters, which were applied to the bytes of a Zarr chunk before
 * packing, and the predictor of TIFF. They are undone in reverse order.
 *
 *   shuffle            bytes of one place of all elements side by side
 *   delta              differences, of numbers of the same kind
 *   fixedscaleoffset   (value - offset) * scale, rounded
 *   quantize, astype   another type
 *   rows               differences to the element before, in rows; not in Zarr
 *
 * Computed as numcodecs does, in the type that NumPy would choose; whole numbers wrap around.
 */
#ifndef FORMATS_GRID_ZARR_FILTER_H
#define FORMATS_GRID_ZARR_FILTER_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/sample.h"
#include "formats/base/status.h"

enum { ZARR_FILTERS = 8, ZARR_FILTER_KINDS = 6 };

/* Kinds that are not found by name: rows of the table in zarr_filter.c. */
enum { ZARR_FILTER_SHUFFLE = 0, ZARR_FILTER_ROWS = 5 };

typedef struct zarr_number {
    sample_type type;
    bool big_endian;
} zarr_number;

typedef struct zarr_filter {
    int kind; /* a row of the table in zarr_filter.c, which treelet files store (leaf_filter) */
    zarr_number plain,
        coded; /* numbers before and after the filter was applied; of shuffle the same */
    double scale, offset;
    uint32_t element; /* bytes; of rows numbers */
    uint32_t row;     /* numbers of a row, a multiple of element; else 0 */
} zarr_filter;

typedef struct zarr_filters {
    int count;
    zarr_filter of[ZARR_FILTERS];
} zarr_filters;

/* zarr_filters_read() - read the list "filters" of an array of such numbers; NULL and null mean no
 * filters. ST_UNSUPPORTED, ST_CORRUPT. json: the name of the file, for messages. */
CHECKED status zarr_filters_read(const json_t *list, zarr_number array, const char *json,
                                 zarr_filters *out);

/* zarr_filters_sound() - returns whether filters, as read from elsewhere, are such as
 * zarr_filters_read() makes for an array of such numbers. */
bool zarr_filters_sound(const zarr_filters *f, zarr_number array);

/* zarr_filters_width() - returns the bytes of a number behind the last filter. most: out, the
 * widest number on the way, the array's own included. */
size_t zarr_filters_width(const zarr_filters *f, zarr_number array, size_t *most);

/* zarr_filters_undo() - undo the filters of a chunk of so many numbers, from `coded`, which is
 * destroyed, into `plain`. Both have room for the widest numbers. path: the chunk's. ST_CORRUPT for
 * values that the array's type cannot have. */
CHECKED status zarr_filters_undo(const zarr_filters *f, const char *path, size_t numbers,
                                 void *coded, void *plain);

#endif
