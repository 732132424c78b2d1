/* tiff_pieces.h - a page of a TIFF: what its directory says, and the strips or tiles that it is in.
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

/* An entry's numbers; count 0: there is no such entry. */
typedef struct tiff_numbers {
    uint64_t count, at; /* offset of the first number in the file */
    int width;          /* bytes per number */
} tiff_numbers;

/* What places a page on a map, and says what stands for no data (geotiff.h): doubles, but for the
 * keys, of 16 bits, and letters. */
typedef enum tiff_geo {
    TIFF_GEO_SCALE,
    TIFF_GEO_TIES,
    TIFF_GEO_MAP,
    TIFF_GEO_KEYS,
    TIFF_GEO_METADATA, /* letters */
    TIFF_GEO_MISSING,  /* letters */
    TIFF_GEOS
} tiff_geo;

/* What a directory says; else what the format says of a tag that is not there. */
typedef struct tiff_page {
    tiff_numbers offsets, bytes; /* of pieces */
    tiff_numbers geo[TIFF_GEOS];
    uint64_t width, height, bits, samples, rows, tile_width, tile_height; /* no tiles: 0 */
    uint64_t compression, predictor, photometric, format, fill_order;
    bool uneven; /* samples of several sizes or formats */
    bool planar; /* each channel has its own pieces */
    bool beside; /* it is a smaller copy of another page, or its mask */
} tiff_page;

enum { TIFF_UNTOLD = UINT16_MAX }; /* photometric without its tag */

/* tiff_page_read() - read a directory of `entries` entries from offset `at` on. ST_CORRUPT, ST_IO.
 */
CHECKED status tiff_page_read(const tiff *t, uint64_t at, uint64_t entries, tiff_page *out);

/* tiff_page_piece_bytes() - returns the bytes of an unpacked piece; UINT64_MAX for sizes that no
 * file has. */
uint64_t tiff_page_piece_bytes(const tiff_page *p, uint64_t piece);

/* A piece as its page tells it. */
typedef struct tiff_piece {
    uint64_t number, offset;
    uint64_t bytes; /* 0: not told */
} tiff_piece;

typedef struct tiff_piece_visit {
    status (*take)(void *ctx, const tiff_piece *piece);
    void *ctx;
} tiff_piece_visit;

/* tiff_pieces_each() - visit all pieces of a page, in order. */
CHECKED status tiff_pieces_each(const tiff *t, const tiff_page *p, const tiff_piece_visit *to);

/* tiff_pieces_check() - check that the pieces of a page are in the file. page: counted from 0, for
 * messages. ST_CORRUPT, ST_IO. */
CHECKED status tiff_pieces_check(const tiff *t, const tiff_page *p, uint64_t page);

#endif
