#include "formats/grid/mrc.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "formats/input/binary_fields.h"

/* Indices of the header's words, four bytes each. */
enum {
    HEADER_BYTES = 1024,
    WORD_SIZE = 0,
    WORD_MODE = 3,
    WORD_START = 4,
    WORD_SAMPLING = 7,
    WORD_CELL = 10,
    WORD_ANGLES = 13,
    WORD_AXES = 16,
    WORD_GROUP = 22,
    WORD_EXTENDED = 23,
    WORD_IMOD = 38,
    WORD_ORIGIN = 49,
    WORD_MAP = 52,
    WORD_STAMP = 53
};

enum { STACK_OF_VOLUMES = 401, IMOD_STAMP = 1146047817 };

typedef struct mrc {
    volume_layout *l;
    const char *name;
    bool big;
    uint8_t bytes[HEADER_BYTES];
} mrc;

static bool known(const char *path, const uint8_t *start, size_t size) {
    (void)path;
    return size >= 216 && memcmp(start + (size_t)4 * WORD_MAP, "MAP", 3) == 0;
}

static int64_t word(const mrc *h, int at) {
    return binary_signed(h->bytes + (ptrdiff_t)4 * at, 4, h->big);
}

static double real(const mrc *h, int at) {
    return binary_real(h->bytes + (ptrdiff_t)4 * at, 4, h->big);
}

/* Returns the byte order by the stamp. Without a stamp: big, if the number of columns is impossible
 * otherwise. */
static bool is_big(const mrc *h) {
    const uint8_t stamp = h->bytes[4 * WORD_STAMP];
    if (stamp == 0x11 || stamp == 0x44)
        return stamp == 0x11;
    return binary_unsigned(h->bytes, 4, false) > GRID_DIM_MAX;
}

static status read_sizes(mrc *h) {
    for (int a = 0; a < 3; a++) {
        const int64_t size = word(h, WORD_SIZE + a);
        if (size < 1)
            return status_describe(ST_CORRUPT, "%s: byte %d: %lld samples along axis %d", h->name,
                                   4 * a, (long long)size, a + 1);
        h->l->g.dims[a] = (uint32_t)size;
    }
    const int64_t depth = word(h, WORD_SAMPLING + 2), all = h->l->g.dims[2];
    if (word(h, WORD_GROUP) < STACK_OF_VOLUMES || depth < 1 || all % depth != 0)
        return ST_OK;
    h->l->steps = (uint32_t)(all / depth);
    h->l->g.dims[2] = (uint32_t)depth;
    return ST_OK;
}

static status read_type(mrc *h) {
    static const struct {
        int64_t mode;
        sample_type type;
    } types[] = {
        {0, SAMPLE_I8}, {1, SAMPLE_I16}, {2, SAMPLE_F32}, {6, SAMPLE_U16}, {12, SAMPLE_F16}};
    const int64_t mode = word(h, WORD_MODE);
    /* IMOD's flag says whether bytes are signed. By default they are not. */
    const bool imod = word(h, WORD_IMOD) == IMOD_STAMP && !(word(h, WORD_IMOD + 1) & 1);
    h->l->stored.type = (sample_type)0;
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (types[i].mode == mode)
            h->l->stored.type = mode == 0 && imod ? SAMPLE_U8 : types[i].type;
    if (h->l->stored.type)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED,
                           "%s: byte %d: mode %lld: supported are 0, 1, 2, 6 and 12 (8 and 16 bit "
                           "integers, half, float)",
                           h->name, 4 * WORD_MODE, (long long)mode);
}

/* ---- where the nodes lie ---- */

/* Returns an angle's cosine; 0 if the angle is not given, NaN if no cell can have it. */
static double cosine(double degrees) {
    if (degrees == 0 || degrees == 90)
        return 0;
    return degrees > 0 && degrees < 180 ? portable_cos(degrees / 360) : (double)NAN;
}

/* Compute the directions of the cell's edges: the first along x, the second in the plane of x and
 * y. */
static void edges_of(const mrc *h, double edge[3][3]) {
    const double alpha = cosine(real(h, WORD_ANGLES)), beta = cosine(real(h, WORD_ANGLES + 1)),
                 gamma = cosine(real(h, WORD_ANGLES + 2));
    const double sine = sqrt(1 - gamma * gamma), y = (alpha - beta * gamma) / sine;
    const double of[3][3] = {{1, 0, 0}, {gamma, sine, 0}, {beta, y, sqrt(1 - beta * beta - y * y)}};
    memcpy(edge, of, sizeof of);
}

/* Find which edge each of the file's axes follows. Without a valid permutation: in order. */
static void read_axes(const mrc *h, int axes[3]) {
    int seen = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t axis = word(h, WORD_AXES + i);
        axes[i] = axis >= 1 && axis <= 3 ? (int)axis - 1 : i;
        seen |= 1 << axes[i];
    }
    for (int i = 0; i < 3 && seen != 7; i++)
        axes[i] = i;
}

static status read_placement(mrc *h) {
    double edge[3][3], direction[3][3], spacing[3], origin[3];
    int axes[3];
    bool given = false;
    edges_of(h, edge);
    read_axes(h, axes);
    for (int a = 0; a < 3; a++) {
        origin[a] = real(h, WORD_ORIGIN + a);
        given |= origin[a] != 0;
    }
    for (int i = 0; i < 3; i++) {
        const int64_t sampling = word(h, WORD_SAMPLING + axes[i]);
        const double length = real(h, WORD_CELL + axes[i]);
        spacing[i] = sampling > 0 && length != 0 ? length / (double)sampling : 1;
        memcpy(direction[i], edge[axes[i]], sizeof direction[i]);
        for (int row = 0; row < 3 && !given; row++)
            origin[row] += (double)word(h, WORD_START + i) * spacing[i] * direction[i][row];
    }
    volume_layout_place(h->l, direction, spacing, origin);
    world_frame_set(&h->l->g.frame, WORLD_UNTOLD, "angstrom");
    return grid_check(&h->l->g, h->name);
}

static status find_samples(mrc *h) {
    const int64_t extended = word(h, WORD_EXTENDED);
    if (extended < 0)
        return status_describe(ST_CORRUPT, "%s: byte %d: an extended header of %lld bytes", h->name,
                               4 * WORD_EXTENDED, (long long)extended);
    return volume_layout_skip(h->l, 0, HEADER_BYTES + extended);
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    static status (*const steps[])(mrc *) = {read_sizes, read_type, read_placement, find_samples};
    const uint32_t none[3] = {0, 0, 0};
    (void)hints;
    mrc h = {.l = l, .name = byte_stream_name(l->data)};
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(l->data, HEADER_BYTES, &start, &size);
    if (st != ST_OK)
        return st;
    if (size < HEADER_BYTES)
        return status_describe(ST_CORRUPT, "%s: ends at byte %zu, expected a header of %d", h.name,
                               size, HEADER_BYTES);
    memcpy(h.bytes, start, sizeof h.bytes);
    h.big = l->big_endian = is_big(&h);
    grid_init(&l->g, none, SAMPLE_U8);
    for (size_t i = 0; st == ST_OK && i < sizeof steps / sizeof *steps; i++)
        st = steps[i](&h);
    return st;
}

const grid_reader mrc_reader = {.format = "MRC", .known = known, .layout = open_layout};
