#include "prep/import/dicom/dicom_j2k.h"

#include <string.h>

#include "formats/input/binary_fields.h"

#ifndef DICOM_J2K

bool dicom_j2k_is_there(void) {
    return false;
}

status dicom_j2k_decode(const char *path, const void *stream, size_t size,
                        const dicom_j2k_form *form, void *out) {
    (void)stream, (void)size, (void)form, (void)out;
    return status_describe(ST_UNSUPPORTED, "%s: built without OpenJPEG", path);
}

#else

#include <openjpeg.h>

#include "formats/base/mem.h"
#include "formats/base/text.h"

bool dicom_j2k_is_there(void) {
    return true;
}

/* ---- its header ---- */

/* Offsets of fields in the markers SOC and SIZ at the start (ISO 15444-1, A.5.1). */
enum {
    SIZE_X = 8,
    SIZE_Y = 12,
    OFFSET_X = 16,
    OFFSET_Y = 20,
    TILE_X = 24,
    TILE_Y = 28,
    COMPONENTS = 40,
    COMPONENT = 42, /* precision - 1 and sign, distances along x and y: 3 bytes per component */
    TILES_MAX = 4096,
    DECODER_BYTES = 1 << 20
};

static uint32_t field(const uint8_t *bytes, int at, int width) {
    return (uint32_t)binary_unsigned(bytes + at, width, true);
}

static status differs(const char *path, const char *what, uint32_t is, uint32_t expected) {
    return status_describe(ST_CORRUPT, "%s: its JPEG 2000 has %u %s, expected %u", path, is, what,
                           expected);
}

static status check_component(const char *path, const uint8_t *c, const dicom_j2k_form *form) {
    const uint32_t bits = (c[0] & 127u) + 1;
    const bool is_signed = c[0] >> 7;
    if (bits > form->allocated)
        return differs(path, "bits a number", bits, form->allocated);
    if (c[1] != 1 || c[2] != 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: its JPEG 2000 leaves out samples of a component", path);
    /* Writers may omit the sign in the codestream. Then the highest bit is the sign. */
    if (is_signed != form->is_signed && (is_signed || bits != form->stored))
        return status_describe(ST_UNSUPPORTED,
                               "%s: its JPEG 2000 has %u bits %s a sign, its header %u bits %s",
                               path, bits, is_signed ? "with" : "without", form->stored,
                               form->is_signed ? "with" : "without");
    return ST_OK;
}

static status check_tiles(const char *path, const uint8_t *b) {
    const uint64_t w = field(b, TILE_X, 4), h = field(b, TILE_Y, 4);
    if (w == 0 || h == 0)
        return status_describe(ST_CORRUPT, "%s: its JPEG 2000 has tiles without extent", path);
    const uint64_t across = (field(b, SIZE_X, 4) + w - 1) / w;
    const uint64_t down = (field(b, SIZE_Y, 4) + h - 1) / h;
    if (across <= TILES_MAX && down <= TILES_MAX && across * down <= TILES_MAX)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: its JPEG 2000 has more than %d tiles", path,
                           TILES_MAX);
}

static status check_header(const char *path, const uint8_t *b, size_t size,
                           const dicom_j2k_form *form) {
    static const uint8_t start[4] = {0xff, 0x4f, 0xff, 0x51};
    if (size < COMPONENT + 3 * (size_t)form->samples || memcmp(b, start, sizeof start) != 0)
        return status_describe(ST_CORRUPT, "%s: its pixels: expected a codestream of JPEG 2000",
                               path);
    if (field(b, SIZE_X, 4) < field(b, OFFSET_X, 4) || field(b, SIZE_Y, 4) < field(b, OFFSET_Y, 4))
        return status_describe(ST_CORRUPT, "%s: its JPEG 2000 ends before it begins", path);
    const uint32_t columns = field(b, SIZE_X, 4) - field(b, OFFSET_X, 4);
    const uint32_t rows = field(b, SIZE_Y, 4) - field(b, OFFSET_Y, 4);
    const uint32_t components = field(b, COMPONENTS, 2);
    if (columns != form->columns)
        return differs(path, "columns", columns, form->columns);
    if (rows != form->rows)
        return differs(path, "rows", rows, form->rows);
    if (components != form->samples)
        return differs(path, "components", components, form->samples);
    status st = check_tiles(path, b);
    for (uint32_t i = 0; i < components && st == ST_OK; i++)
        st = check_component(path, b + COMPONENT + 3 * i, form);
    return st;
}

/* ---- input for OpenJPEG ---- */

typedef struct source {
    const uint8_t *bytes;
    size_t size, at;
} source;

static OPJ_SIZE_T read_bytes(void *to, OPJ_SIZE_T count, void *ctx) {
    source *s = ctx;
    const size_t left = s->size - s->at, n = count < left ? count : left;
    if (n == 0)
        return (OPJ_SIZE_T)-1;
    memcpy(to, s->bytes + s->at, n);
    s->at += n;
    return n;
}

static OPJ_BOOL seek_bytes(OPJ_OFF_T to, void *ctx) {
    source *s = ctx;
    if (to < 0 || (uint64_t)to > s->size)
        return OPJ_FALSE;
    s->at = (size_t)to;
    return OPJ_TRUE;
}

static OPJ_OFF_T skip_bytes(OPJ_OFF_T count, void *ctx) {
    const source *s = ctx;
    const bool done = count >= 0 && (uint64_t)count <= s->size - s->at;
    return done && seek_bytes((OPJ_OFF_T)s->at + count, ctx) ? count : -1;
}

static opj_stream_t *make_stream(source *s) {
    opj_stream_t *stream = opj_stream_default_create(OPJ_TRUE);
    if (!stream)
        return NULL;
    opj_stream_set_user_data(stream, s, NULL);
    opj_stream_set_user_data_length(stream, s->size);
    opj_stream_set_read_function(stream, read_bytes);
    opj_stream_set_seek_function(stream, seek_bytes);
    opj_stream_set_skip_function(stream, skip_bytes);
    return stream;
}

/* ---- decoding ---- */

typedef struct job {
    source from;
    opj_stream_t *stream;
    opj_codec_t *codec;
    opj_image_t *image;
    char said[160]; /* first error message of OpenJPEG */
} job;

static void keep_first_error(const char *words, void *ctx) {
    job *j = ctx;
    if (j->said[0])
        return;
    text_name(j->said, sizeof j->said, words);
    for (char *end = j->said + strcspn(j->said, "\n"); *end; end++)
        *end = 0;
}

static bool decode(job *j) {
    opj_dparameters_t parameters;
    opj_set_default_decoder_parameters(&parameters);
    j->stream = make_stream(&j->from);
    j->codec = opj_create_decompress(OPJ_CODEC_J2K);
    return j->stream && j->codec && opj_set_error_handler(j->codec, keep_first_error, j) &&
           opj_setup_decoder(j->codec, &parameters) &&
           opj_read_header(j->stream, j->codec, &j->image) &&
           opj_decode(j->codec, j->stream, j->image) && opj_end_decompress(j->codec, j->stream);
}

static void release(job *j) {
    opj_image_destroy(j->image);
    if (j->codec)
        opj_destroy_codec(j->codec);
    if (j->stream)
        opj_stream_destroy(j->stream);
}

static bool is_as_told(const opj_image_t *image, const dicom_j2k_form *form) {
    if (image->numcomps != form->samples)
        return false;
    for (uint32_t i = 0; i < image->numcomps; i++) {
        const opj_image_comp_t *c = &image->comps[i];
        if (!c->data || c->w != form->columns || c->h != form->rows)
            return false;
    }
    return true;
}

/* Store the low bits of each number. Its sign bit, or the highest stored bit, is the sign. */
static void put_numbers(const opj_image_t *image, const dicom_j2k_form *form, void *out) {
    const size_t pixels = (size_t)form->columns * form->rows, samples = form->samples;
    for (size_t c = 0; c < samples; c++) {
        const OPJ_INT32 *v = image->comps[c].data;
        for (size_t i = 0; i < pixels; i++)
            switch (form->allocated) {
            case 8: ((uint8_t *)out)[i * samples + c] = (uint8_t)v[i]; break;
            case 16: ((uint16_t *)out)[i * samples + c] = (uint16_t)v[i]; break;
            default: ((uint32_t *)out)[i * samples + c] = (uint32_t)v[i]; break;
            }
    }
}

status dicom_j2k_decode(const char *path, const void *stream, size_t size,
                        const dicom_j2k_form *form, void *out) {
    job j = {.from = {.bytes = stream, .size = size}};
    status st = check_header(path, stream, size, form);
    if (st != ST_OK)
        return st;
    const bool done = decode(&j);
    if (done && is_as_told(j.image, form))
        put_numbers(j.image, form, out);
    else if (!done && !mem_room(3 * sizeof(OPJ_INT32) * form->samples * form->columns * form->rows +
                                DECODER_BYTES))
        st =
            status_describe(ST_NOMEM, "%s: the system has no memory to decode its JPEG 2000", path);
    else
        st = status_describe(ST_CORRUPT, "%s: decoding its JPEG 2000: OpenJPEG: %s", path,
                             done        ? "another size than its header says"
                             : j.said[0] ? j.said
                                         : "no reason given");
    release(&j);
    return st;
}

#endif
