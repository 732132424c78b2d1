#include "formats/grid/nifti.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/num.h"
#include "formats/base/text.h"
#include "formats/input/binary_fields.h"
#include "formats/input/named_file.h"

/* Offsets and widths of the fields in one of the two versions. */
typedef struct nifti_form {
    const char *magic[2]; /* of a single file, and of a header alone; 4 bytes */
    int magic_at, header_bytes;
    int dim, size_width; /* dim[8] */
    int datatype;
    int pixdim, real_width; /* pixdim[8]; bytes of a real */
    int vox_offset;
    int slope, intercept;
    int codes, code_width; /* qform_code, sform_code */
    int quaternion;        /* b, c, d, and the offset x, y, z */
    int rows;              /* srow_x[4], srow_y[4], srow_z[4] */
    int units, unit_width; /* xyzt_units */
    int time_offset;
} nifti_form;

static const nifti_form forms[] = {{.magic = {"n+1", "ni1"},
                                    .magic_at = 344,
                                    .header_bytes = 348,
                                    .dim = 40,
                                    .size_width = 2,
                                    .datatype = 70,
                                    .pixdim = 76,
                                    .time_offset = 136,
                                    .real_width = 4,
                                    .vox_offset = 108,
                                    .slope = 112,
                                    .intercept = 116,
                                    .codes = 252,
                                    .code_width = 2,
                                    .quaternion = 256,
                                    .rows = 280,
                                    .units = 123,
                                    .unit_width = 1},
                                   {.magic = {"n+2", "ni2"},
                                    .magic_at = 4,
                                    .header_bytes = 540,
                                    .dim = 16,
                                    .size_width = 8,
                                    .datatype = 12,
                                    .pixdim = 104,
                                    .time_offset = 216,
                                    .real_width = 8,
                                    .vox_offset = 168,
                                    .slope = 176,
                                    .intercept = 184,
                                    .codes = 344,
                                    .code_width = 4,
                                    .quaternion = 352,
                                    .rows = 400,
                                    .units = 500,
                                    .unit_width = 4}};

enum { HEADER_MAX = 540 };

/* A header that is being interpreted. */
typedef struct nifti {
    const nifti_form *form;
    const char *name; /* the file's name */
    volume_layout *l;
    bool pair, big;
    bool at_image; /* the stream is a pair's .img */
    size_t size;
    uint8_t bytes[HEADER_MAX];
} nifti;

static const nifti_form *find_form(const uint8_t *start, size_t size, bool *pair) {
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
        for (int p = 0; p < 2; p++) {
            const nifti_form *f = &forms[i];
            *pair = p;
            if (size >= (size_t)f->magic_at + 4 && memcmp(start + f->magic_at, f->magic[p], 4) == 0)
                return f;
        }
    return NULL;
}

/* Returns whether the first bytes are those of a header. Sets h->form. */
static bool is_header(nifti *h, const uint8_t *start, size_t size) {
    h->form = find_form(start, size, &h->pair);
    if (!h->form || (binary_unsigned(start, 4, false) != (uint64_t)h->form->header_bytes &&
                     binary_unsigned(start, 4, true) != (uint64_t)h->form->header_bytes))
        return false;
    h->size = size < HEADER_MAX ? size : HEADER_MAX;
    memcpy(h->bytes, start, h->size);
    return true;
}

static bool is_header_file(mem *m, const char *path, nifti *h) {
    byte_stream *s = NULL;
    const uint8_t *start;
    size_t size;
    const bool is = byte_stream_open(m, path, &s) == ST_OK &&
                    byte_stream_peek(s, HEADER_MAX, &start, &size) == ST_OK &&
                    is_header(h, start, size) && h->pair;
    byte_stream_close(s);
    return is;
}

/* Find the header beside an image: x.hdr or x.hdr.gz beside x.img. path: out. */
static bool find_header(mem *m, const char *image, char path[PATH_MAX], nifti *h) {
    static const char *const suffixes[] = {".hdr", ".HDR", ".hdr.gz"};
    const int stem = (int)strlen(image) - 4;
    for (int i = 0; i < 3 && text_ends_in(image, ".img"); i++)
        if (snprintf(path, PATH_MAX, "%.*s%s", stem, image, suffixes[i]) < PATH_MAX &&
            access(path, R_OK) == 0 && named_file_implied(path) == ST_OK &&
            is_header_file(m, path, h))
            return true;
    return false;
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    char header[PATH_MAX];
    nifti h;
    mem m;
    mem_init(&m, 0);
    return is_header(&h, start, size) || find_header(&m, path, header, &h);
}

static double real_at(const nifti *h, int at, int index) {
    const int width = h->form->real_width;
    return binary_real(h->bytes + at + index * width, width, h->big);
}

/* ---- sizes and type ---- */

/* Read the size of axis 1 .. 7; an axis that is not there has one sample. */
static status read_size(const nifti *h, int axis, int64_t axes, uint32_t *out) {
    const int width = h->form->size_width;
    const int64_t size = binary_signed(h->bytes + h->form->dim + axis * width, width, h->big);
    *out = 1;
    if (axis > axes)
        return ST_OK;
    if (size < 1 || size > UINT32_MAX)
        return status_describe(ST_CORRUPT, "%s: dim[%d] is %lld, expected 1 or more", h->name, axis,
                               (long long)size);
    *out = (uint32_t)size;
    return ST_OK;
}

static status read_sizes(nifti *h) {
    const nifti_form *f = h->form;
    const int64_t axes = binary_signed(h->bytes + f->dim, f->size_width, h->big);
    uint32_t size[8] = {0};
    if (axes < 1 || axes > 7)
        return status_describe(ST_CORRUPT, "%s: dim[0] is %lld, expected 1 to 7", h->name,
                               (long long)axes);
    for (int axis = 1; axis < 8; axis++) {
        status st = read_size(h, axis, axes, &size[axis]);
        if (st != ST_OK)
            return st;
    }
    if (size[6] > 1 || size[7] > 1)
        return status_describe(
            ST_UNSUPPORTED,
            "%s: %u x %u x %u x %u x %u x %u x %u samples: beside its three axes "
            "a volume has steps and components",
            h->name, size[1], size[2], size[3], size[4], size[5], size[6], size[7]);
    memcpy(h->l->g.dims, size + 1, sizeof h->l->g.dims);
    h->l->steps = size[4];
    h->l->stored.components = size[5];
    return ST_OK;
}

static status read_type(nifti *h) {
    static const struct {
        int code, components;
        sample_type type;
        bool colours;
    } types[] = {
        {2, 1, SAMPLE_U8, false},     {4, 1, SAMPLE_I16, false},   {8, 1, SAMPLE_I32, false},
        {16, 1, SAMPLE_F32, false},   {64, 1, SAMPLE_F64, false},  {256, 1, SAMPLE_I8, false},
        {512, 1, SAMPLE_U16, false},  {768, 1, SAMPLE_U32, false}, {1024, 1, SAMPLE_I64, false},
        {1280, 1, SAMPLE_U64, false}, {32, 2, SAMPLE_F32, false},  {1792, 2, SAMPLE_F64, false},
        {128, 3, SAMPLE_U8, true},    {2304, 4, SAMPLE_U8, true},
    };
    const int code = (int)binary_signed(h->bytes + h->form->datatype, 2, h->big);
    stored_samples *s = &h->l->stored;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        if (types[i].code != code)
            continue;
        if (types[i].components > 1 && s->components > 1)
            break;
        h->l->ordered = s->components > 1;
        s->type = types[i].type;
        s->colours = types[i].colours;
        s->components *= (uint32_t)types[i].components;
        return ST_OK;
    }
    return status_describe(ST_UNSUPPORTED,
                           "%s: datatype %d%s: supported are 8 to 64 bit integers, float, double, "
                           "complex of these, RGB24 and RGBA32",
                           h->name, code, s->components > 1 ? " of vectors" : "");
}

static status read_scale(nifti *h) {
    const double slope = real_at(h, h->form->slope, 0);
    const double intercept = real_at(h, h->form->intercept, 0);
    char text[NUM_TEXT_MAX];
    if (slope == 0 || !isfinite(slope) || h->l->stored.colours)
        return ST_OK;
    if (!isfinite(intercept))
        return status_describe(ST_CORRUPT, "%s: scl_inter is %s, not finite", h->name,
                               num_print(intercept, text));
    h->l->stored.slope = slope;
    h->l->stored.intercept = intercept;
    return ST_OK;
}

/* ---- where the nodes lie ---- */

static void place_by_rows(nifti *h) {
    for (int row = 0; row < 3; row++)
        for (int column = 0; column < 4; column++)
            h->l->g.to_world[row][column] = real_at(h, h->form->rows, 4 * row + column);
}

/* Column a of the rotation is the direction of axis a. */
static void rotation_of(double b, double c, double d, double r[3][3]) {
    const double rest = 1 - (b * b + c * c + d * d);
    const double length = sqrt(b * b + c * c + d * d);
    double a = 0;
    if (rest > 1e-7)
        a = sqrt(rest);
    else { /* half a turn, up to rounding */
        b /= length;
        c /= length;
        d /= length;
    }
    const double of[3][3] = {
        {a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
        {2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
        {2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}};
    memcpy(r, of, sizeof of);
}

/* Place the nodes by the quaternion, or without one along the world's axes. */
static void place_by_spacings(nifti *h, bool turned) {
    double r[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double direction[3][3], spacing[3], origin[3] = {0, 0, 0};
    const int at = h->form->quaternion;
    if (turned)
        rotation_of(real_at(h, at, 0), real_at(h, at, 1), real_at(h, at, 2), r);
    for (int a = 0; a < 3; a++) {
        spacing[a] = fabs(real_at(h, h->form->pixdim, a + 1));
        if (turned)
            origin[a] = real_at(h, at, 3 + a);
        for (int row = 0; row < 3; row++)
            direction[a][row] = r[row][a];
    }
    if (turned && real_at(h, h->form->pixdim, 0) < 0)
        spacing[2] = -spacing[2];
    volume_layout_place(h->l, direction, spacing, origin);
}

/* Set the world's axes. The standard knows RAS alone; if neither code is set, the axes are unknown.
 */
static void read_frame(nifti *h, bool placed) {
    static const char *const names[8] = {"", "m", "mm", "um"};
    const int code =
        (int)binary_unsigned(h->bytes + h->form->units, h->form->unit_width, h->big) & 7;
    world_frame_set(&h->l->g.frame, placed ? WORLD_RAS : WORLD_UNTOLD,
                    names[code] ? names[code] : "");
}

/* Read the times: multiples of the repetition time, from toffset on. */
static void read_times(nifti *h) {
    static const char *const names[8] = {[1] = "s", [2] = "ms", [3] = "us"};
    const int code =
        (int)binary_unsigned(h->bytes + h->form->units, h->form->unit_width, h->big) >> 3 & 7;
    h->l->time_step = fabs(real_at(h, h->form->pixdim, 4));
    h->l->first_time = real_at(h, h->form->time_offset, 0);
    world_frame_set_time_unit(&h->l->g.frame, names[code] ? names[code] : "");
}

static status read_placement(nifti *h) {
    const int width = h->form->code_width;
    const uint8_t *codes = h->bytes + h->form->codes;
    const bool by_rows = binary_signed(codes + width, width, h->big) > 0;
    const bool turned = binary_signed(codes, width, h->big) > 0;
    if (by_rows)
        place_by_rows(h);
    else
        place_by_spacings(h, turned);
    read_frame(h, by_rows || turned);
    if (h->l->steps > 1)
        read_times(h);
    return grid_check(&h->l->g, h->name);
}

/* ---- where the samples are ---- */

/* Open x.img for x.hdr, and x.img.gz for x.hdr.gz. */
static status open_image(nifti *h) {
    const char *slash = strrchr(h->l->path, '/');
    char *name = mem_copy_text(h->l->m, slash ? slash + 1 : h->l->path);
    if (!name)
        return ST_NOMEM;
    char *suffix = NULL;
    for (char *at = name; (at = strcasestr(at, ".hdr")); at++)
        suffix = at;
    status st = ST_OK;
    if (!suffix || (suffix[4] && suffix[4] != '.'))
        st = status_describe(ST_UNSUPPORTED,
                             "%s: a NIfTI header alone: expected a name that ends in .hdr, beside "
                             "its .img",
                             h->name);
    else {
        memcpy(suffix + 1, suffix[1] == 'h' ? "img" : "IMG", 3);
        st = volume_layout_open(h->l, h->l->path, name, true, byte_stream_open);
    }
    mem_free(h->l->m, name);
    return st;
}

static status find_samples(nifti *h) {
    const int at = h->form->vox_offset;
    const bool real = h->form->real_width == 4;
    double offset = real ? real_at(h, at, 0) : (double)binary_signed(h->bytes + at, 8, h->big);
    char text[NUM_TEXT_MAX];
    if (offset == 0 && !h->pair)
        offset = h->form->header_bytes + 4;
    if (!(offset >= (h->pair ? 0 : h->form->header_bytes) && offset < 0x1p53) ||
        offset != floor(offset))
        return status_describe(ST_CORRUPT,
                               "%s: vox_offset is %s, expected a place behind the header", h->name,
                               num_print(offset, text));
    status st = h->pair && !h->at_image ? open_image(h) : ST_OK;
    return st == ST_OK ? volume_layout_skip(h->l, 0, (int64_t)offset) : st;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    static status (*const steps[])(nifti *) = {read_sizes, read_type, read_scale, read_placement,
                                               find_samples};
    static const uint8_t planar[] = {ORDER_X, ORDER_Y, ORDER_Z, ORDER_STEP, ORDER_COMPONENT};
    const uint32_t none[3] = {0, 0, 0};
    (void)hints;
    char header[PATH_MAX];
    nifti h = {.l = l, .name = byte_stream_name(l->data)};
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, HEADER_MAX, &start, &size);
    if (st != ST_OK)
        return st;
    if (!is_header(&h, start, size)) {
        h.at_image = true;
        h.name = header;
        if (!find_header(l->m, byte_stream_kind(l->data), header,
                         &h)) /* it was there a moment ago */
            return status_describe(ST_IO, "%s: its header is not there", l->path);
    }
    if (h.size < (size_t)h.form->header_bytes)
        return status_describe(ST_CORRUPT, "%s: ends at byte %zu, expected a header of %d", h.name,
                               h.size, h.form->header_bytes);
    h.big = binary_unsigned(h.bytes, 4, true) == (uint64_t)h.form->header_bytes;
    grid_init(&l->g, none, SAMPLE_U8);
    l->big_endian = h.big;
    memcpy(l->order, planar, sizeof l->order);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof *steps; i++)
        st = steps[i](&h);
    return st;
}

const grid_reader nifti_reader = {.format = "NIfTI", .known = known, .layout = open_layout};
