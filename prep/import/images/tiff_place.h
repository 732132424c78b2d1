/* tiff_place.h - where the samples of a stack of pages lie in a TIFF or in several, for those who
 * leave them there: in one piece, or in strips and tiles as chunks of an array.
 *
 * Only for what becomes the same numbers without the library: of 8 to 64 bits, as they are, black
 * is zero, not packed, or packed by deflate, zstd or LZMA, with or without horizontal differences.
 */
#ifndef PREP_IMPORT_IMAGES_TIFF_PLACE_H
#define PREP_IMPORT_IMAGES_TIFF_PLACE_H

#include "formats/base/mem.h"
#include "formats/grid/chunk_array.h"
#include "formats/grid/sample_place.h"
#include "formats/grid/slice_folder.h"

/* The samples that are asked for. */
typedef struct tiff_wish {
    const char *const *paths; /* of the file of each slice; of the same file, the same pointer */
    const uint32_t *pages;    /* of each slice, in its file; of the same file ascending */
    uint32_t slices;
    bool in_slices;     /* slices may lie in several files: none of them is in one piece */
    uint32_t component; /* the channel that is taken, from 1; 0: all, as luminance */
    sample_type type;   /* that the library makes of a number: half becomes f32 */
} tiff_wish;

/* What a place refers to. Zeros: nothing. */
typedef struct tiff_place {
    mem *m;
    chunk_array array;
    chunk_entry *table;
    slice_file *slices;
    char refused[96];
} tiff_place;

/* tiff_place_find() - find the samples. *out refers to *keep; it is refused where samples cannot
 * stay. Its path is NULL, and the files of slices have names alone. Release keep in any case, and
 * before it is used again. ST_CORRUPT, ST_IO, ST_NOMEM. */
CHECKED status tiff_place_find(mem *m, const tiff_wish *wish, tiff_place *keep, sample_place *out);
void tiff_place_release(tiff_place *p);

#endif
