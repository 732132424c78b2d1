#include "formats/grid/mgh.h"

#include <math.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/input/binary_fields.h"

/* Offsets in the header, in bytes. */
enum {
    HEADER_BYTES = 284,
    KNOWN_BYTES = 28,
    AT_SIZES = 4,
    AT_FRAMES = 16,
    AT_TYPE = 20,
    AT_PLACED = 28,
    AT_SPACING = 30,
    AT_DIRECTION = 42,
    AT_CENTRE = 78
};

typedef struct mgh {
    volume_layout *l;
    const char *name;
    uint8_t bytes[HEADER_BYTES];
} mgh;

static const struct {
    uint32_t code;
    sample_type type;
} types[] = {{0, SAMPLE_U8}, {1, SAMPLE_I32}, {3, SAMPLE_F32}, {4, SAMPLE_I16}, {10, SAMPLE_U16}};

static int64_t word(const uint8_t *bytes, int at) {
    return binary_signed(bytes + at, 4, true);
}

/* Returns whether a file begins as one. The version alone says little, so possible sizes and a type
 * are demanded, too. */
static bool begins_so(const uint8_t *start, size_t size) {
    if (size < KNOWN_BYTES || word(start, 0) != 1)
        return false;
    for (int at = AT_SIZES; at <= AT_FRAMES; at += 4)
        if (word(start, at) < 1)
            return false;
    return word(start, AT_TYPE) >= 0 && word(start, AT_TYPE) <= 10;
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    return text_ends_in(path, ".mgh") || begins_so(start, size);
}

static status read_sizes(mgh *h) {
    if (word(h->bytes, 0) != 1)
        return status_describe(ST_UNSUPPORTED, "%s: byte 0: version %lld, expected 1", h->name,
                               (long long)word(h->bytes, 0));
    for (int a = 0; a < 4; a++) {
        const int64_t size = word(h->bytes, AT_SIZES + 4 * a);
        if (size < 1)
            return status_describe(ST_CORRUPT, "%s: byte %d: %lld %s", h->name, AT_SIZES + 4 * a,
                                   (long long)size, a < 3 ? "samples along an axis" : "frames");
        if (a < 3)
            h->l->g.dims[a] = (uint32_t)size;
        else
            h->l->steps = (uint32_t)size;
    }
    return ST_OK;
}

static status read_type(mgh *h) {
    const int64_t code = word(h->bytes, AT_TYPE);
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].code == code) {
            h->l->stored.type = types[i].type;
            return ST_OK;
        }
    return status_describe(ST_UNSUPPORTED,
                           "%s: byte %d: type %lld: supported are 0, 1, 3, 4 and 10 (8, 16 and 32 "
                           "bit integers, float)",
                           h->name, AT_TYPE, (long long)code);
}

/* Find the place. The file's centre is half the number of samples along each axis: between samples
 * where the number is even. */
static status read_placement(mgh *h) {
    double direction[3][3] = {{-1, 0, 0}, {0, 0, -1}, {0, 1, 0}}; /* coronal */
    double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    const bool placed = binary_signed(h->bytes + AT_PLACED, 2, true) > 0;
    for (int i = 0; i < 9 && placed; i++)
        direction[i / 3][i % 3] = binary_real(h->bytes + AT_DIRECTION + (ptrdiff_t)4 * i, 4, true);
    for (int a = 0; a < 3 && placed; a++) {
        spacing[a] = binary_real(h->bytes + AT_SPACING + (ptrdiff_t)4 * a, 4, true);
        origin[a] = binary_real(h->bytes + AT_CENTRE + (ptrdiff_t)4 * a, 4, true);
    }
    for (int a = 0; a < 3; a++)
        for (int row = 0; row < 3; row++)
            origin[row] -= 0.5 * h->l->g.dims[a] * spacing[a] * direction[a][row];
    volume_layout_place(h->l, direction, spacing, origin);
    world_frame_set(&h->l->g.frame, WORLD_RAS, "mm");
    return grid_check(&h->l->g, h->name);
}

static status find_samples(mgh *h) {
    h->l->has_tail = true; /* times and tags of the scanner */
    return volume_layout_skip(h->l, 0, HEADER_BYTES);
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    static status (*const steps[])(mgh *) = {read_sizes, read_type, read_placement, find_samples};
    const uint32_t none[3] = {0, 0, 0};
    (void)hints;
    mgh h = {.l = l, .name = byte_stream_name(l->data)};
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, HEADER_BYTES, &start, &size);
    if (st != ST_OK)
        return st;
    if (size < HEADER_BYTES)
        return status_describe(ST_CORRUPT, "%s: ends at byte %zu, expected a header of %d", h.name,
                               size, HEADER_BYTES);
    memcpy(h.bytes, start, sizeof h.bytes);
    l->big_endian = true;
    grid_init(&l->g, none, SAMPLE_U8);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof *steps; i++)
        st = steps[i](&h);
    return st;
}

const grid_reader mgh_reader = {.format = "FreeSurfer", .known = known, .layout = open_layout};
