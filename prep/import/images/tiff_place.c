#include "prep/import/images/tiff_place.h"

#include <stdio.h>
#include <string.h>

#include "prep/import/images/tiff_pages.h"

/* Strips that are not packed are taken in parts of so many bytes or more, as a box needs few rows;
 * but in so many parts at most, or little more, as all have a place in a table. */
enum { PART_BYTES = 64 << 10, PARTS = 1 << 20 };

/* How the pages that are taken are stored. All are stored alike. */
typedef struct form {
    sample_type type;
    zarr_codec codec;
    bool big_endian, differences, planar, tiled;
    uint64_t width, height, samples;
    uint64_t piece_width, piece_height;
} form;

typedef struct finder {
    const tiff_wish *wish;
    tiff_place *keep;
    form form;               /* of the first page */
    uint32_t z;              /* slices found */
    const char *path;        /* of the file that is looked at, */
    const tiff_page *page;   /* and the page */
    uint32_t rows;           /* of a chunk */
    uint64_t across, down;   /* chunks of a page */
    uint64_t planes, pieces; /* channels apart, and pieces of a page */
    uint64_t start, next;    /* where one piece begins, and would go on */
    bool gaps;               /* it does not go on */
} finder;

/* ---- what a page says ---- */

static sample_type type_of(const tiff_page *p) {
    static const struct {
        uint8_t format, bits, type;
    } types[] = {{1, 8, SAMPLE_U8},   {1, 16, SAMPLE_U16}, {1, 32, SAMPLE_U32},
                 {2, 8, SAMPLE_I8},   {2, 16, SAMPLE_I16}, {2, 32, SAMPLE_I32},
                 {3, 16, SAMPLE_F16}, {3, 32, SAMPLE_F32}, {3, 64, SAMPLE_F64}};
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].format == p->format && types[i].bits == p->bits)
            return (sample_type)types[i].type;
    return (sample_type)0;
}

/* A number that a tag may have: a codec, or why it is refused. */
typedef struct meaning {
    uint64_t number;
    zarr_codec codec; /* 0: refused */
    const char *name;
} meaning;

static const meaning compressions[] = {
    {1, ZARR_RAW, NULL},        {8, ZARR_STREAM, NULL},
    {32946, ZARR_STREAM, NULL}, {50000, ZARR_STREAM, NULL},
    {34925, ZARR_STREAM, NULL}, {5, (zarr_codec)0, "LZW"},
    {7, (zarr_codec)0, "JPEG"}, {32773, (zarr_codec)0, "PackBits"}};
static const meaning photometrics[] = {{0, (zarr_codec)0, "white is zero"},
                                       {3, (zarr_codec)0, "colours of a palette"}};

static const meaning *find_meaning(const meaning *of, size_t count, uint64_t number) {
    for (size_t i = 0; i < count; i++)
        if (of[i].number == number)
            return &of[i];
    return NULL;
}

#define MEANING(of, number) find_meaning(of, sizeof(of) / sizeof *(of), number)

/* Say why numbers cannot be taken as they are. false: they can. */
static bool refuse(const tiff_page *p, char *why, size_t room) {
    const meaning *packed = MEANING(compressions, p->compression);
    const meaning *colours = MEANING(photometrics, p->photometric);
    *why = '\0';
    if (p->uneven)
        snprintf(why, room, "channels of several types");
    else if (p->photometric != 1 && p->photometric != 2)
        snprintf(why, room, "%s", colours ? colours->name : "neither grey nor red, green, blue");
    else if (p->fill_order != 1)
        snprintf(why, room, "bits from right to left");
    else if (!type_of(p))
        snprintf(why, room, "numbers of %llu bits", (unsigned long long)p->bits);
    else if (packed && !packed->codec)
        snprintf(why, room, "%s", packed->name);
    else if (!packed)
        snprintf(why, room, "compression %llu", (unsigned long long)p->compression);
    else if (packed->codec != ZARR_RAW && p->predictor != 1 && p->predictor != 2)
        snprintf(why, room, "predictor %llu", (unsigned long long)p->predictor);
    else if (packed->codec != ZARR_RAW && !p->bytes.count)
        snprintf(why, room, "packed strips whose bytes are not told");
    return *why != '\0';
}

static form form_of(const tiff *t, const tiff_page *p) {
    form f;
    f.type = type_of(p);
    f.codec = MEANING(compressions, p->compression)->codec;
    f.big_endian = t->big_endian;
    f.differences = f.codec != ZARR_RAW && p->predictor == 2;
    f.planar = p->planar && p->samples > 1;
    f.tiled = p->tile_width > 0;
    f.width = p->width;
    f.height = p->height;
    f.samples = p->samples;
    f.piece_width = f.tiled ? p->tile_width : p->width;
    f.piece_height = f.tiled ? p->tile_height : p->rows < p->height ? p->rows : p->height;
    return f;
}

static bool is_alike(const form *a, const form *b) {
    return a->type == b->type && a->codec == b->codec && a->big_endian == b->big_endian &&
           a->differences == b->differences && a->planar == b->planar && a->tiled == b->tiled &&
           a->width == b->width && a->height == b->height && a->samples == b->samples &&
           a->piece_width == b->piece_width && a->piece_height == b->piece_height;
}

/* ---- the array ---- */

/* How many rows of a strip are a chunk: of one strip a page any number, else a divisor. */
static uint32_t rows_at_once(const form *f, uint32_t slices) {
    const uint64_t row = f->width * sample_size(f->type) * (f->planar ? 1 : f->samples);
    const uint64_t share = f->height * row / PARTS * slices;
    uint64_t rows = (share > PART_BYTES ? share : PART_BYTES) / row + 1;
    if (f->tiled || f->codec != ZARR_RAW || rows >= f->piece_height)
        return (uint32_t)f->piece_height;
    while (f->piece_height < f->height && f->piece_height % rows)
        rows--;
    return (uint32_t)rows;
}

/* Numbers side by side in a piece. */
static uint32_t channels_of(const form *f) {
    return f->planar ? 1 : (uint32_t)f->samples;
}

static void add_axis(chunk_array *a, int role, uint64_t count) {
    a->role[a->axes] = role;
    a->chunk[a->axes++] = (uint32_t)count;
}

static void describe(const finder *f, chunk_array *a) {
    const form *o = &f->form;
    const zarr_number number = {o->type, o->big_endian};
    *a = (chunk_array){.type = o->type,
                       .big_endian = o->big_endian,
                       .separator = '.',
                       .codec = o->codec,
                       .rows = (uint32_t)o->height};
    if (o->planar)
        add_axis(a, ORDER_COMPONENT, 1);
    add_axis(a, ORDER_Z, 1);
    add_axis(a, ORDER_Y, f->rows);
    add_axis(a, ORDER_X, o->piece_width);
    if (o->samples > 1 && !o->planar)
        add_axis(a, ORDER_COMPONENT, o->samples);
    if (o->differences)
        a->filters = (zarr_filters){1,
                                    {{.kind = ZARR_FILTER_ROWS,
                                      .plain = number,
                                      .coded = number,
                                      .element = channels_of(o),
                                      .row = (uint32_t)(channels_of(o) * o->piece_width)}}};
}

/* Sizes that fit, so that products below do. */
static bool sizes_suit(const form *f, const tiff_wish *w) {
    const uint64_t most = GRID_DIM_MAX;
    return f->width > 0 && f->width <= most && f->height > 0 && f->height <= most &&
           f->piece_width > 0 && f->piece_width <= most && f->piece_height > 0 &&
           f->piece_height <= most && f->samples > 0 && f->samples <= STORED_SAMPLES_COMPONENTS &&
           w->component <= f->samples;
}

/* Begin with the first page: the array, and room for its table. */
static status begin(finder *f) {
    const form *o = &f->form;
    const tiff_wish *w = f->wish;
    char *why = f->keep->refused;
    const size_t room = sizeof f->keep->refused;
    if (!sizes_suit(o, w) || w->type != sample_widened(o->type))
        snprintf(why, room, "pages of such sizes or types");
    else if (!w->component && sample_is_integer(o->type))
        snprintf(why, room, "the luminance of colours is rounded to whole numbers");
    if (*why)
        return ST_OK;
    f->rows = rows_at_once(o, w->slices);
    f->across = (o->width + o->piece_width - 1) / o->piece_width;
    f->down = (o->height + f->rows - 1) / f->rows;
    f->planes = o->planar ? o->samples : 1;
    f->pieces = f->across * ((o->height + o->piece_height - 1) / o->piece_height) * f->planes;
    f->gaps = w->in_slices || o->tiled || o->codec != ZARR_RAW || o->samples > 1;
    const uint64_t taken = o->planar && !w->component ? f->planes : 1;
    const uint64_t page = f->across * f->down * taken;
    if (page > UINT32_MAX / w->slices) {
        snprintf(why, room, "more than 2^32 chunks");
        return ST_OK;
    }
    f->keep->table = mem_array(f->keep->m, (size_t)page * w->slices, sizeof *f->keep->table);
    return f->keep->table ? ST_OK : ST_NOMEM;
}

/* ---- pieces ---- */

static bool take_one_piece(finder *f, uint64_t offset, uint64_t bytes) {
    if (f->z == 0 && f->next == 0)
        f->start = f->next = offset;
    const bool follows = offset == f->next;
    f->next += bytes;
    return follows;
}

/* Where the table has a chunk of the page; NULL: its channel is not taken. */
static chunk_entry *entry_of(const finder *f, uint64_t plane, uint64_t row, uint64_t column) {
    const uint32_t one = f->wish->component;
    if (f->form.planar && one && plane != one - 1)
        return NULL;
    const uint64_t number = f->form.planar && !one ? plane : 0;
    return &f->keep
                ->table[((number * f->wish->slices + f->z) * f->down + row) * f->across + column];
}

/* Put the parts of a strip that is not packed into the table. */
static void take_strip(finder *f, const tiff_piece *piece, uint64_t plane, uint64_t strip) {
    const form *o = &f->form;
    const uint64_t row = o->width * sample_size(o->type) * channels_of(o);
    const uint64_t first = strip * o->piece_height;
    const uint64_t end = first + o->piece_height < o->height ? first + o->piece_height : o->height;
    for (uint64_t y = first; y < end; y += f->rows) {
        const uint64_t rows = end - y < f->rows ? end - y : f->rows;
        chunk_entry *e = entry_of(f, plane, y / f->rows, 0);
        if (e)
            *e = (chunk_entry){piece->offset + (y - first) * row, (uint32_t)(rows * row), 0};
    }
}

static status take_piece(void *ctx, const tiff_piece *piece) {
    finder *f = ctx;
    const form *o = &f->form;
    const uint64_t of_plane = f->pieces / f->planes, at = piece->number % of_plane;
    const uint64_t plane = piece->number / of_plane;
    const uint64_t plain = tiff_page_piece_bytes(f->page, piece->number);
    const uint64_t bytes = o->codec == ZARR_RAW ? plain : piece->bytes;
    if (piece->number >= f->pieces)
        return ST_OK;
    if (bytes > UINT32_MAX && (o->tiled || o->codec != ZARR_RAW))
        snprintf(f->keep->refused, sizeof f->keep->refused, "strips or tiles of 4 GiB and more");
    f->gaps = f->gaps || !take_one_piece(f, piece->offset, bytes);
    if (o->codec == ZARR_RAW && !o->tiled) {
        take_strip(f, piece, plane, at);
        return ST_OK;
    }
    chunk_entry *e = entry_of(f, plane, at / f->across, at % f->across);
    if (e)
        *e = (chunk_entry){piece->offset, (uint32_t)bytes, 0};
    return ST_OK;
}

/* Refuse a page that is not stored as the first one is. */
static void refuse_page(const finder *f, uint64_t number, const char *why) {
    const char *name = strrchr(f->path, '/');
    char *text = f->keep->refused;
    const size_t room = sizeof f->keep->refused;
    if (f->wish->in_slices)
        snprintf(text, room, "%.48s %s", name ? name + 1 : f->path, why);
    else
        snprintf(text, room, "page %llu %s", (unsigned long long)number, why);
}

static status take_page(void *ctx, const tiff *t, const tiff_page *p, uint64_t number) {
    finder *f = ctx;
    tiff_place *keep = f->keep;
    status st = ST_OK;
    if (f->z == f->wish->slices || f->wish->paths[f->z] != f->path ||
        number != f->wish->pages[f->z] || *keep->refused ||
        refuse(p, keep->refused, sizeof keep->refused))
        return ST_OK;
    const form own = form_of(t, p);
    if (f->z == 0) {
        f->form = own;
        st = begin(f);
    }
    if (st != ST_OK || *keep->refused)
        return st;
    if (!is_alike(&own, &f->form))
        refuse_page(f, number, "is stored in another way");
    else if (p->offsets.count < f->pieces)
        refuse_page(f, number, "lacks strips or tiles");
    if (*keep->refused)
        return ST_OK;
    f->page = p;
    st = tiff_pieces_each(t, p, &(tiff_piece_visit){take_piece, f});
    f->z++;
    return st;
}

/* ---- all of them ---- */

/* Go through the pages of each file. */
static status visit_files(mem *m, finder *f) {
    const tiff_wish *w = f->wish;
    status st = ST_OK;
    while (f->z < w->slices && st == ST_OK && !*f->keep->refused) {
        const uint32_t first = f->z;
        uint64_t pages;
        f->path = w->paths[first];
        st = tiff_pages_each(m, f->path, &(tiff_visit){take_page, f}, &pages);
        if (st == ST_OK && f->z == first && !*f->keep->refused)
            snprintf(f->keep->refused, sizeof f->keep->refused,
                     "pages that are not found in order");
    }
    return st;
}

/* Tell the file of each slice by its name. */
static status name_slices(mem *m, const tiff_wish *w, tiff_place *keep) {
    keep->slices = mem_array(m, w->slices, sizeof *keep->slices);
    if (!keep->slices)
        return ST_NOMEM;
    memset(keep->slices, 0, w->slices * sizeof *keep->slices);
    for (uint32_t z = 0; z < w->slices; z++) {
        const char *name = strrchr(w->paths[z], '/');
        snprintf(keep->slices[z].name, sizeof keep->slices[z].name, "%s",
                 name ? name + 1 : w->paths[z]);
    }
    return ST_OK;
}

status tiff_place_find(mem *m, const tiff_wish *wish, tiff_place *keep, sample_place *out) {
    *keep = (tiff_place){.m = m};
    finder f = {.wish = wish, .keep = keep};
    *out = (sample_place){.path = NULL};
    status st = visit_files(m, &f);
    if (st == ST_OK && wish->in_slices && !*keep->refused)
        st = name_slices(m, wish, keep);
    if (st != ST_OK)
        return st;
    if (*keep->refused) {
        out->refused = keep->refused;
        return ST_OK;
    }
    const bool one = f.form.samples == 1;
    out->big_endian = f.form.big_endian;
    out->stored = (stored_samples){.type = f.form.type,
                                   .components = (uint32_t)f.form.samples,
                                   .component = one ? 0 : wish->component,
                                   .colours = !wish->component};
    out->offset = f.gaps ? 0 : f.start;
    if (!f.gaps)
        return ST_OK;
    describe(&f, &keep->array);
    out->chunks = &keep->array;
    out->table = keep->table;
    out->slices = keep->slices;
    out->table_count =
        (uint32_t)(f.across * f.down * (f.form.planar && !wish->component ? f.planes : 1)) *
        wish->slices;
    return ST_OK;
}

void tiff_place_release(tiff_place *p) {
    if (p->m) {
        mem_free(p->m, p->table);
        mem_free(p->m, p->slices);
    }
    *p = (tiff_place){.m = NULL};
}
