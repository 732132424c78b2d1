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
    SUBFILE = 254,
    WIDTH = 256,
    HEIGHT = 257,
    BITS = 258,
    COMPRESSION = 259,
    PHOTOMETRIC = 262,
    FILL_ORDER = 266,
    STRIP_OFFSETS = 273,
    SAMPLES = 277,
    ROWS = 278,
    STRIP_BYTES = 279,
    PLANES = 284,
    PREDICTOR = 317,
    TILE_WIDTH = 322,
    TILE_HEIGHT = 323,
    TILE_OFFSETS = 324,
    TILE_BYTES = 325,
    FORMAT = 339
};

enum { SMALLER = 1, MASK = 4 };                 /* bits of SUBFILE */
enum { LETTERS = 2, SHORTS = 3, DOUBLES = 12 }; /* types of numbers */

static int width_of(uint64_t type) {
    switch (type) {
    case 1:
    case LETTERS: return 1;
    case SHORTS: return 2;
    case 4: return 4;
    case DOUBLES:
    case 16: return 8;
    default: return 0;
    }
}

/* The tags of maps, and the types of their numbers. */
static const struct {
    uint16_t tag;
    uint8_t type;
} geo_tags[TIFF_GEOS] = {
    [TIFF_GEO_SCALE] = {33550, DOUBLES},    [TIFF_GEO_TIES] = {33922, DOUBLES},
    [TIFF_GEO_MAP] = {34264, DOUBLES},      [TIFF_GEO_KEYS] = {34735, SHORTS},
    [TIFF_GEO_METADATA] = {42112, LETTERS}, [TIFF_GEO_MISSING] = {42113, LETTERS}};

/* Find where an entry's numbers are stored. *type: theirs. */
static status find_numbers(const tiff *t, uint64_t entry, uint64_t *tag, uint64_t *type,
                           tiff_numbers *out) {
    const int count_bytes = t->big ? 8 : 4;
    const uint64_t value = entry + 4 + (uint64_t)count_bytes;
    uint64_t count = 0;
    status st = tiff_number(t, entry, 2, tag);
    if (st == ST_OK)
        st = tiff_number(t, entry + 2, 2, type);
    if (st == ST_OK)
        st = tiff_number(t, entry + 4, count_bytes, &count);
    *out = (tiff_numbers){.count = count, .at = value, .width = width_of(*type)};
    if (st != ST_OK || out->width == 0 || count > file_size(t->file)) {
        out->count = 0;
        return st;
    }
    const bool inside = count * (uint64_t)out->width <= (uint64_t)count_bytes;
    return inside ? ST_OK : tiff_number(t, value, count_bytes, &out->at);
}

enum { SAMPLES_MAX = 256 }; /* whose sizes are compared */

/* Compare a number of each sample with that of the first. */
static status compare_samples(const tiff *t, const tiff_numbers *n, uint64_t first, tiff_page *p) {
    status st = ST_OK;
    for (uint64_t i = 1; i < n->count && i < SAMPLES_MAX && st == ST_OK; i++) {
        uint64_t value = 0;
        st = tiff_number(t, n->at + i * (uint64_t)n->width, n->width, &value);
        p->uneven |= st == ST_OK && value != first;
    }
    return st;
}

static status take_entry(const tiff *t, uint64_t entry, tiff_page *p) {
    uint64_t tag, type = 0, value = 0;
    tiff_numbers n;
    status st = find_numbers(t, entry, &tag, &type, &n);
    for (int i = 0; i < TIFF_GEOS && st == ST_OK; i++)
        if (tag == geo_tags[i].tag && type == geo_tags[i].type)
            p->geo[i] = n;
    if (st != ST_OK || !n.count || type == LETTERS || type == DOUBLES)
        return st;
    st = tiff_number(t, n.at, n.width, &value);
    if (st != ST_OK)
        return st;
    switch (tag) {
    case SUBFILE: p->beside = (value & (SMALLER | MASK)) != 0; break;
    case WIDTH: p->width = value; break;
    case HEIGHT: p->height = value; break;
    case BITS: p->bits = value; return compare_samples(t, &n, value, p);
    case COMPRESSION: p->compression = value; break;
    case PHOTOMETRIC: p->photometric = value; break;
    case FILL_ORDER: p->fill_order = value; break;
    case SAMPLES: p->samples = value; break;
    case ROWS: p->rows = value; break;
    case PLANES: p->planar = value == 2; break;
    case PREDICTOR: p->predictor = value; break;
    case TILE_WIDTH: p->tile_width = value; break;
    case TILE_HEIGHT: p->tile_height = value; break;
    case STRIP_OFFSETS:
    case TILE_OFFSETS: p->offsets = n; break;
    case STRIP_BYTES:
    case TILE_BYTES: p->bytes = n; break;
    case FORMAT: p->format = value; return compare_samples(t, &n, value, p);
    default: break;
    }
    return ST_OK;
}

status tiff_page_read(const tiff *t, uint64_t at, uint64_t entries, tiff_page *out) {
    status st = ST_OK;
    *out = (tiff_page){.bits = 1,
                       .samples = 1,
                       .rows = UINT32_MAX,
                       .compression = 1,
                       .predictor = 1,
                       .photometric = TIFF_UNTOLD,
                       .format = 1,
                       .fill_order = 1};
    for (uint64_t i = 0; i < entries && st == ST_OK; i++)
        st = take_entry(t, at + i * (t->big ? 20 : 12), out);
    return st;
}

/* ---- its pieces ---- */

uint64_t tiff_page_piece_bytes(const tiff_page *p, uint64_t piece) {
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

enum { AT_ONCE = 256 }; /* pieces whose numbers are read together */

/* Read numbers first .. first + count - 1 of an entry; those that it lacks are 0. */
static status load(const tiff *t, const tiff_numbers *n, uint64_t first, uint64_t count,
                   uint64_t out[AT_ONCE]) {
    uint8_t raw[AT_ONCE * 8];
    const uint64_t left = n->count > first ? n->count - first : 0;
    const size_t there = (size_t)(left < count ? left : count), width = (size_t)n->width;
    memset(out, 0, AT_ONCE * sizeof *out);
    if (!there)
        return ST_OK;
    const status st = file_read_at(t->file, n->at + first * width, raw, there * width);
    for (size_t i = 0; i < there * width && st == ST_OK; i++) {
        const size_t k = i % width, byte = t->big_endian ? k : width - 1 - k;
        out[i / width] = out[i / width] << 8 | raw[i - k + byte];
    }
    return st;
}

status tiff_pieces_each(const tiff *t, const tiff_page *p, const tiff_piece_visit *to) {
    uint64_t offsets[AT_ONCE], bytes[AT_ONCE];
    status st = ST_OK;
    for (uint64_t first = 0, count; first < p->offsets.count && st == ST_OK; first += count) {
        const uint64_t left = p->offsets.count - first;
        count = left < AT_ONCE ? left : AT_ONCE;
        st = load(t, &p->offsets, first, count, offsets);
        if (st == ST_OK)
            st = load(t, &p->bytes, first, count, bytes);
        for (uint64_t i = 0; i < count && st == ST_OK; i++)
            st = to->take(to->ctx, &(tiff_piece){first + i, offsets[i], bytes[i]});
    }
    return st;
}

/* ---- checking ---- */

typedef struct check {
    const tiff *t;
    const tiff_page *page;
    uint64_t number; /* of the page */
} check;

enum { YCBCR = 6 }; /* which may have fewer colours than pixels */

static status check_piece(void *ctx, const tiff_piece *piece) {
    const check *c = ctx;
    const tiff_page *p = c->page;
    const char *kind = p->tile_width ? "tile" : "strip", *path = c->t->path;
    const bool packed = p->compression != 1 || p->photometric == YCBCR;
    if (piece->offset == 0 || (p->bytes.count && piece->bytes == 0))
        return status_describe(
            ST_CORRUPT, "%s: page %llu: %s %llu of %llu has no bytes: a sparse TIFF", path,
            (whole)c->number, kind, (whole)piece->number, (whole)p->offsets.count);
    const uint64_t least = packed ? 0 : tiff_page_piece_bytes(p, piece->number);
    const uint64_t need = piece->bytes > least ? piece->bytes : least, size = file_size(c->t->file);
    if (piece->offset <= size && need <= size - piece->offset)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: page %llu: %s %llu of %llu has %llu bytes from %llu; the file ends "
                           "at byte %llu",
                           path, (whole)c->number, kind, (whole)piece->number,
                           (whole)p->offsets.count, (whole)need, (whole)piece->offset, (whole)size);
}

status tiff_pieces_check(const tiff *t, const tiff_page *p, uint64_t page) {
    check c = {t, p, page};
    return tiff_pieces_each(t, p, &(tiff_piece_visit){check_piece, &c});
}
