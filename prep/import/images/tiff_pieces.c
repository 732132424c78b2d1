#include "prep/import/images/tiff_pieces.h"

#include <string.h>

typedef unsigned long long whole;

status tiff_number(const tiff *t, uint64_t offset, int bytes, uint64_t *out) {
    unsigned char raw[8];
    const status st = file_read_at(t->file, offset, raw, (size_t)bytes);
    *out = 0;
    for (int i = 0; i < bytes && st == ST_OK; i++)
        *out = *out << 8 | raw[t->big_endian ? i : bytes - 1 - i];
    return st;
}

/* ---- a directory ---- */

enum {
    WIDTH = 256,
    HEIGHT = 257,
    BITS = 258,
    COMPRESSION = 259,
    PHOTOMETRIC = 262,
    STRIP_OFFSETS = 273,
    SAMPLES = 277,
    ROWS = 278,
    STRIP_BYTES = 279,
    PLANES = 284,
    TILE_WIDTH = 322,
    TILE_HEIGHT = 323,
    TILE_OFFSETS = 324,
    TILE_BYTES = 325
};

/* An entry's numbers; count 0: there is no such entry. */
typedef struct numbers {
    uint64_t count, at; /* offset of the first number in the file */
    int width;          /* bytes per number */
} numbers;

typedef struct page {
    numbers offsets, bytes;
    uint64_t width, height, bits, samples, rows, tile_width, tile_height;
    bool packed, planar; /* packed: sizes do not determine bytes; planar: each channel has its own
                            pieces */
} page;

static int width_of(uint64_t type) {
    switch (type) {
    case 1: return 1;
    case 3: return 2;
    case 4: return 4;
    case 16: return 8;
    default: return 0;
    }
}

/* Find where an entry's numbers are stored. */
static status find_numbers(const tiff *t, uint64_t entry, uint64_t *tag, numbers *out) {
    const int count_bytes = t->big ? 8 : 4;
    const uint64_t value = entry + 4 + (uint64_t)count_bytes;
    uint64_t type = 0, count = 0;
    status st = tiff_number(t, entry, 2, tag);
    if (st == ST_OK)
        st = tiff_number(t, entry + 2, 2, &type);
    if (st == ST_OK)
        st = tiff_number(t, entry + 4, count_bytes, &count);
    *out = (numbers){.count = count, .at = value, .width = width_of(type)};
    if (st != ST_OK || out->width == 0 || count > file_size(t->file)) {
        out->count = 0;
        return st;
    }
    const bool inside = count * (uint64_t)out->width <= (uint64_t)count_bytes;
    return inside ? ST_OK : tiff_number(t, value, count_bytes, &out->at);
}

static status take_entry(const tiff *t, uint64_t entry, page *p) {
    uint64_t tag, value = 0;
    numbers n;
    status st = find_numbers(t, entry, &tag, &n);
    if (st == ST_OK && n.count)
        st = tiff_number(t, n.at, n.width, &value);
    if (st != ST_OK || !n.count)
        return st;
    switch (tag) {
    case WIDTH: p->width = value; break;
    case HEIGHT: p->height = value; break;
    case BITS: p->bits = value; break;
    case COMPRESSION: p->packed |= value != 1; break;
    case PHOTOMETRIC: p->packed |= value == 6; break; /* YCbCr may have fewer colours than pixels */
    case SAMPLES: p->samples = value; break;
    case ROWS: p->rows = value; break;
    case PLANES: p->planar = value == 2; break;
    case TILE_WIDTH: p->tile_width = value; break;
    case TILE_HEIGHT: p->tile_height = value; break;
    case STRIP_OFFSETS:
    case TILE_OFFSETS: p->offsets = n; break;
    case STRIP_BYTES:
    case TILE_BYTES: p->bytes = n; break;
    default: break;
    }
    return ST_OK;
}

/* ---- its pieces ---- */

/* Bytes of an unpacked piece; UINT64_MAX for sizes that no file has. */
static uint64_t plain_bytes(const page *p, uint64_t piece) {
    const uint64_t channels = p->planar ? 1 : p->samples;
    const uint64_t across = p->tile_width ? p->tile_width : p->width;
    uint64_t rows = p->tile_width ? p->tile_height : p->rows < p->height ? p->rows : p->height;
    uint64_t bits, bytes;
    if (!p->tile_width && rows) {
        const uint64_t strips = (p->height + rows - 1) / rows, top = piece % strips * rows;
        rows = p->height - top < rows ? p->height - top : rows;
    }
    if (__builtin_mul_overflow(across * channels, p->bits, &bits) ||
        __builtin_mul_overflow((bits + 7) / 8, rows, &bytes))
        return UINT64_MAX;
    return bytes;
}

static status check_piece(const tiff *t, const page *p, uint64_t piece, uint64_t number) {
    uint64_t offset, bytes = 0;
    const char *kind = p->tile_width ? "tile" : "strip";
    status st = tiff_number(t, p->offsets.at + piece * (uint64_t)p->offsets.width, p->offsets.width,
                            &offset);
    if (st == ST_OK && piece < p->bytes.count)
        st = tiff_number(t, p->bytes.at + piece * (uint64_t)p->bytes.width, p->bytes.width, &bytes);
    if (st != ST_OK)
        return st;
    if (offset == 0 || (p->bytes.count && bytes == 0))
        return status_describe(ST_CORRUPT,
                               "%s: page %llu: %s %llu of %llu has no bytes: a sparse TIFF",
                               t->path, (whole)number, kind, (whole)piece, (whole)p->offsets.count);
    const uint64_t least = p->packed ? 0 : plain_bytes(p, piece), size = file_size(t->file);
    const uint64_t need = bytes > least ? bytes : least;
    if (offset <= size && need <= size - offset)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: page %llu: %s %llu of %llu has %llu bytes from %llu; the file ends "
                           "at byte %llu",
                           t->path, (whole)number, kind, (whole)piece, (whole)p->offsets.count,
                           (whole)need, (whole)offset, (whole)size);
}

status tiff_pieces_check(const tiff *t, uint64_t at, uint64_t entries, uint64_t number) {
    page p = {.bits = 1, .samples = 1, .rows = UINT32_MAX};
    status st = ST_OK;
    for (uint64_t i = 0; i < entries && st == ST_OK; i++)
        st = take_entry(t, at + i * (t->big ? 20 : 12), &p);
    for (uint64_t i = 0; i < p.offsets.count && st == ST_OK; i++)
        st = check_piece(t, &p, i, number);
    return st;
}
