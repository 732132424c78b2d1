#include "render/app/picture_png.h"

#include <png.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

#include "render/look/picture_bytes.h"

/* tests/measurements/picture_files.md compares other levels and filters. */
enum { LEVEL = 1, WINDOW_BITS = 15, MEMORY_LEVEL = 8, FILTER_UP = 2 };
enum { WIDTH_MAX = 1 << 28 }; /* zlib counts a row in 32 bits */
enum { BAND_BYTES = 256 << 10, SLOTS_PER_THREAD = 2, PIXEL_MAX = 4 };

/* ---- Bands: rows, filtered and deflated ---- */

typedef struct slot {
    z_stream z;
    bool started;
    uint8_t *rows[2];  /* the row above, and this one */
    uint8_t *filtered; /* the whole band */
    uint8_t *deflated;
    size_t size;      /* bytes in `deflated` */
    uint32_t adler;   /* of filtered */
    size_t raw_bytes; /* of filtered */
} slot;

typedef struct bands {
    mem *m;
    const picture *p;
    byte_table table;
    uint32_t rows, count; /* rows of a band; number of bands */
    uint32_t first;       /* first band of this wave */
    size_t stride;        /* bytes of a filtered row */
    bool alpha;
    size_t room; /* size of slot.deflated */
    slot *slots;
    int slot_count;
} bands;

static size_t stride_of(uint32_t width, bool alpha) {
    return (size_t)(alpha ? PIXEL_MAX : 3) * width + 1;
}

static uint32_t rows_of(size_t stride) {
    return stride < BAND_BYTES ? (uint32_t)(BAND_BYTES / stride) : 1;
}

static bool slot_init(const bands *b, slot *s) {
    s->z = (z_stream){.zalloc = mem_zlib_alloc, .zfree = mem_zlib_free, .opaque = b->m};
    s->rows[0] = mem_alloc(b->m, b->stride);
    s->rows[1] = mem_alloc(b->m, b->stride);
    s->filtered = mem_alloc(b->m, b->stride * b->rows);
    s->deflated = mem_alloc(b->m, b->room);
    if (!s->rows[0] || !s->rows[1] || !s->filtered || !s->deflated)
        return false;
    /* Deflate without zlib's header and trailer: the bands are parts of one stream. */
    s->started = deflateInit2(&s->z, LEVEL, Z_DEFLATED, -WINDOW_BITS, MEMORY_LEVEL,
                              Z_DEFAULT_STRATEGY) == Z_OK;
    return s->started;
}

static status bands_init(bands *b, mem *m, const picture *p, int threads) {
    *b = (bands){.m = m, .p = p, .alpha = p->image->a != NULL};
    b->stride = stride_of(p->width, b->alpha);
    b->rows = rows_of(b->stride);
    b->count = (p->height + b->rows - 1) / b->rows;
    /* deflateBound() without a stream gives the largest bound of all settings. A flush adds 5
     * bytes, the end of zlib's stream 4. */
    b->room = deflateBound(NULL, (uLong)(b->stride * b->rows)) + 64;
    const uint32_t most = (uint32_t)threads * SLOTS_PER_THREAD;
    b->slot_count = (int)(b->count < most ? b->count : most);
    b->slots = mem_array(m, (size_t)b->slot_count, sizeof *b->slots);
    picture_bytes_init(&b->table);
    bool good = b->slots != NULL;
    for (int i = 0; i < b->slot_count && good; i++)
        good = slot_init(b, &b->slots[i]);
    return good ? ST_OK : status_describe(ST_NOMEM, "no memory for writing a PNG");
}

static void bands_release(bands *b) {
    for (int i = 0; b->slots && i < b->slot_count; i++) {
        slot *s = &b->slots[i];
        if (s->started)
            deflateEnd(&s->z);
        mem_free(b->m, s->rows[0]);
        mem_free(b->m, s->rows[1]);
        mem_free(b->m, s->filtered);
        mem_free(b->m, s->deflated);
    }
    mem_free(b->m, b->slots);
}

static void encode_row(const bands *b, uint32_t y, uint8_t *out) {
    const size_t first = (size_t)y * b->p->width;
    if (b->alpha)
        picture_bytes_rgba(&b->table, b->p->image, first, b->p->width, out);
    else
        picture_bytes_rgb(&b->table, b->p->image, first, b->p->width, out);
}

/* Encode and filter rows y0 to y1 - 1: from each byte subtract the byte above. */
static void filter_rows(const bands *b, slot *s, uint32_t y0, uint32_t y1) {
    const size_t bytes = b->stride - 1;
    uint8_t *above = s->rows[0], *now = s->rows[1], *out = s->filtered;
    if (y0 > 0)
        encode_row(b, y0 - 1, above);
    else
        memset(above, 0, bytes);
    for (uint32_t y = y0; y < y1; y++) {
        encode_row(b, y, now);
        *out++ = FILTER_UP;
        for (size_t i = 0; i < bytes; i++)
            out[i] = (uint8_t)(now[i] - above[i]);
        out += bytes;
        uint8_t *next = above;
        above = now;
        now = next;
    }
    s->raw_bytes = (size_t)(out - s->filtered);
}

static status deflate_band(void *ctx, size_t index, int worker) {
    (void)worker;
    const bands *b = ctx;
    slot *s = &b->slots[index];
    const uint32_t band = b->first + (uint32_t)index, y0 = band * b->rows;
    const uint32_t left = b->p->height - y0, rows = left < b->rows ? left : b->rows;
    filter_rows(b, s, y0, y0 + rows);
    s->adler = (uint32_t)adler32_z(1, s->filtered, s->raw_bytes);
    deflateReset(&s->z);
    s->z.next_in = s->filtered;
    s->z.avail_in = (uInt)s->raw_bytes;
    s->z.next_out = s->deflated;
    s->z.avail_out = (uInt)b->room;
    /* A flushed band ends at a byte boundary, and the next band does not refer to it. */
    const bool last = band + 1 == b->count;
    const int code = deflate(&s->z, last ? Z_FINISH : Z_FULL_FLUSH);
    if (code != (last ? Z_STREAM_END : Z_OK) || s->z.avail_in > 0)
        return status_describe(ST_FAILED, "zlib cannot deflate a band of a PNG");
    s->size = b->room - s->z.avail_out;
    return ST_OK;
}

/* ---- The file ---- */

typedef struct png_out {
    mem *m;
    const byte_sink *to;
    status st; /* of the sink, or ST_NOMEM; after a fault nothing more goes to it */
} png_out;

static png_voidp take_memory(png_structp png, png_alloc_size_t size) {
    png_out *o = png_get_mem_ptr(png);
    void *block = mem_alloc(o->m, size);
    if (!block && o->st == ST_OK)
        o->st = ST_NOMEM;
    return block;
}

static void give_memory(png_structp png, png_voidp block) {
    const png_out *o = png_get_mem_ptr(png);
    mem_free(o->m, block);
}

static void put(png_structp png, png_bytep data, size_t size) {
    png_out *o = png_get_io_ptr(png);
    if (o->st == ST_OK)
        o->st = o->to->put(o->to->ctx, data, size);
}

static void flush(png_structp png) {
    (void)png;
}

static void complain(png_structp png, png_const_charp what) {
    png_out *o = png_get_error_ptr(png);
    if (o->st == ST_OK)
        o->st = status_describe(ST_FAILED, "libpng: %s", what);
    longjmp(png_jmpbuf(png), 1);
}

static void keep_quiet(png_structp png, png_const_charp what) {
    (void)png;
    (void)what;
}

static bool plain(const char *text) {
    for (; *text; text++)
        if (*text < ' ' || *text > '~')
            return false;
    return true;
}

/* Copy text, cut to less than `room` bytes between two UTF-8 characters. */
static void copy_text(char *to, size_t room, const char *from) {
    size_t n = strnlen(from, room - 1);
    while (n > 0 && ((unsigned char)from[n] & 0xC0) == 0x80)
        n--;
    memcpy(to, from, n);
    to[n] = 0;
}

static void add_text(png_structp png, png_infop info, const char *key, const char *value) {
    char name[80], copy[PICTURE_PNG_TEXT];
    snprintf(name, sizeof name, "%s", key);
    copy_text(copy, sizeof copy, value);
    png_text text = {.compression =
                         plain(copy) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE,
                     .key = name,
                     .text = copy,
                     .text_length = strlen(copy)};
    png_set_text(png, info, &text, 1);
}

static void describe(png_structp png, png_infop info, const picture *p) {
    png_set_user_limits(png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_set_IHDR(png, info, p->width, p->height, 8,
                 p->image->a ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    add_text(png, info, "Software", "leafcast " LEAFCAST_VERSION);
    for (size_t i = 0; i < p->meta_count; i++) {
        char key[80];
        snprintf(key, sizeof key, "leafcast:%s", p->meta[i].key);
        add_text(png, info, key, p->meta[i].value);
    }
}

/* Write a band as one chunk. zlib's header goes before the first band, the checksum of all behind
 * the last. */
static void put_band(png_structp png, const bands *b, const slot *s, uint32_t band, uLong adler) {
    static const uint8_t head[2] = {0x78, 0x01}, name[] = "IDAT";
    const bool first = band == 0, last = band + 1 == b->count;
    const uint8_t sum[4] = {(uint8_t)(adler >> 24), (uint8_t)(adler >> 16), (uint8_t)(adler >> 8),
                            (uint8_t)adler};
    png_write_chunk_start(
        png, name, (png_uint_32)(s->size + (first ? sizeof head : 0) + (last ? sizeof sum : 0)));
    if (first)
        png_write_chunk_data(png, head, sizeof head);
    png_write_chunk_data(png, s->deflated, s->size);
    if (last)
        png_write_chunk_data(png, sum, sizeof sum);
    png_write_chunk_end(png);
}

/* Write the bands wave by wave: deflate as many as there are slots in parallel, then pass them to
 * the sink in order. */
static status put_bands(png_structp png, bands *b, pool *threads, const png_out *o) {
    uLong adler = 1;
    status st = ST_OK;
    while (st == ST_OK && b->first < b->count) {
        const uint32_t left = b->count - b->first;
        const uint32_t wave = left < (uint32_t)b->slot_count ? left : (uint32_t)b->slot_count;
        st = pool_run(threads, wave, deflate_band, b);
        for (uint32_t i = 0; i < wave && st == ST_OK; i++) {
            const slot *s = &b->slots[i];
            adler = adler32_combine(adler, s->adler, (z_off_t)s->raw_bytes);
            put_band(png, b, s, b->first + i, adler);
            st = o->st;
        }
        b->first += wave;
    }
    return st;
}

static status put_picture(bands *b, pool *threads, const byte_sink *to) {
    png_out o = {.m = b->m, .to = to, .st = ST_OK};
    png_structp png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, &o, complain, keep_quiet, &o,
                                                take_memory, give_memory);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    volatile status st = ST_OK;
    if (!info) {
        st = status_describe(ST_NOMEM, "no memory for writing a PNG");
    } else if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_write_fn(png, &o, put, flush);
        describe(png, info, b->p);
        png_write_info(png, info);
        st = put_bands(png, b, threads, &o);
        if (st == ST_OK)
            png_write_chunk(png, (png_const_bytep) "IEND", NULL, 0);
    }
    if (st == ST_OK)
        st = o.st;
    png_destroy_write_struct(&png, &info);
    return st;
}

status picture_png_write(mem *m, pool *threads, const picture *p, const byte_sink *to) {
    bands b;
    if (p->width > WIDTH_MAX)
        return status_describe(ST_UNSUPPORTED, "a PNG of %u columns: at most %d are possible",
                               p->width, WIDTH_MAX);
    status st = bands_init(&b, m, p, pool_threads(threads));
    if (st == ST_OK)
        st = put_picture(&b, threads, to);
    bands_release(&b);
    return st;
}

size_t picture_png_bytes(int threads, uint32_t width) {
    const size_t stride = stride_of(width, true), band = stride * rows_of(stride);
    return (size_t)threads * SLOTS_PER_THREAD * (2 * stride + 2 * band + band / 8 + (300 << 10));
}
