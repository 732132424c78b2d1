/* tiff_pieces.h - checks that the strips or tiles of a TIFF's page are in the file.
 *
 * For missing pieces libtiff gives zeros or other bytes of the file, and OpenImageIO drops its
 * warning. So each piece's place and size is checked. Pieces without bytes (a sparse TIFF) or
 * beyond the end are refused.
 */
#ifndef PREP_IMPORT_IMAGES_TIFF_PIECES_H
#define PREP_IMPORT_IMAGES_TIFF_PIECES_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/file.h"
#include "formats/base/status.h"

/* An open TIFF. */
typedef struct tiff {
    file *file;
    const char *path;
    bool big_endian; /* "MM" */
    bool big;        /* BigTIFF: counts and offsets have 8 bytes */
} tiff;

/* tiff_number() - read a number of so many bytes at an offset, in the file's byte order. */
CHECKED status tiff_number(const tiff *t, uint64_t offset, int bytes, uint64_t *out);

/* tiff_pieces_check() - check a page whose directory has `entries` entries from offset `at` on.
 * page: counted from 0, for messages. ST_CORRUPT, ST_IO. */
CHECKED status tiff_pieces_check(const tiff *t, uint64_t at, uint64_t entries, uint64_t page);

#endif
