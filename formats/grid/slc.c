#include "formats/grid/slc.h"

#include <ctype.h>
#include <string.h>

#include "formats/base/text.h"
#include "formats/input/text_tokens.h"

enum { NUMBERS = 14, ICON_MAX = 1 << 15, PACKED_MAX = 1 << 30 };

/* ---- recognising by the head ---- */

/* Returns whether an X follows as many numbers as the head has. Other files begin with 11111, too.
 */
static bool is_head(const uint8_t *start, size_t size) {
    size_t at = 0;
    for (int i = 0; i <= NUMBERS; i++) {
        const size_t word = at;
        while (at < size && strchr("+-.0123456789eE", start[at]) && start[at])
            at++;
        if (i == NUMBERS)
            return at == word && at < size && start[at] == 'X';
        if (at == word)
            return false;
        while (at < size && isspace(start[at]))
            at++;
    }
    return false;
}

static bool known(const char *path, const uint8_t *start, size_t size) {
    return size >= 6 && memcmp(start, "11111", 5) == 0 && isspace(start[5]) &&
           (text_ends_in(path, ".slc") || is_head(start, size));
}

/* ---- packed slices as a stream ---- */

typedef struct slc_stream {
    mem *m;
    byte_stream *from;
    uint64_t plane;         /* bytes of a slice */
    uint32_t slices, slice; /* slice: the current one */
    uint64_t given;         /* bytes of the slice handed out */
    uint64_t left;          /* packed bytes of it still to come; valid while it is open */
    bool is_open;
    unsigned run; /* bytes that the control byte still covers */
    bool literal;
    uint8_t value; /* the repeated byte of a run that is not literal */
} slc_stream;

static status damaged(const slc_stream *s, const char *what) {
    return status_describe(ST_CORRUPT, "%s: slice %u (counted from 0): %s",
                           byte_stream_name(s->from), s->slice, what);
}

/* Take an X, behind blanks. */
static status take_x(text_tokens *t) {
    const uint8_t *next;
    size_t size;
    status st = text_tokens_next(t);
    if (st == ST_OK)
        st = byte_stream_peek(t->s, 1, &next, &size);
    if (st != ST_OK)
        return st;
    if (t->token[0] || size == 0 || *next != 'X')
        return text_tokens_fault(t, "expected X");
    byte_stream_take(t->s, 1);
    return ST_OK;
}

static status begin_slice(slc_stream *s) {
    text_tokens t = {.s = s->from, .stop = 'X'};
    int64_t size = 0;
    status st = text_tokens_int(&t, "the bytes of a packed slice", 0, PACKED_MAX, &size);
    if (st == ST_OK)
        st = take_x(&t);
    s->left = (uint64_t)size;
    s->given = 0;
    s->is_open = true;
    return st;
}

static status take_bytes(slc_stream *s, void *to, size_t size) {
    size_t got = 0;
    if (size > s->left)
        return damaged(s, "its packed bytes end before it does");
    status st = byte_stream_read(s->from, to, size, &got);
    s->left -= got;
    return st == ST_OK && got < size
               ? status_describe(ST_CORRUPT, "%s: ends at byte %llu, inside slice %u",
                                 byte_stream_name(s->from),
                                 (unsigned long long)byte_stream_position(s->from), s->slice)
               : st;
}

static status begin_run(slc_stream *s) {
    uint8_t control = 0;
    status st = take_bytes(s, &control, 1);
    s->run = control & 127;
    s->literal = control >> 7;
    if (st == ST_OK && s->run == 0)
        return damaged(s, "its end comes before its last voxel");
    if (st == ST_OK && s->run > s->plane - s->given)
        return damaged(s, "more voxels than it has");
    return st == ST_OK && !s->literal ? take_bytes(s, &s->value, 1) : st;
}

/* End a slice. Packed bytes that are left are skipped. */
static status end_slice(slc_stream *s) {
    status st = byte_stream_skip(s->from, s->left);
    s->is_open = false;
    s->slice++;
    return st;
}

static status read_packed(void *ctx, void *to, size_t size, size_t *got) {
    slc_stream *s = ctx;
    status st = ST_OK;
    *got = 0;
    while (st == ST_OK && *got < size && s->slice < s->slices) {
        if (!s->is_open)
            st = begin_slice(s);
        if (st == ST_OK && s->run == 0)
            st = begin_run(s);
        if (st != ST_OK)
            return st;
        const size_t room = size - *got, n = s->run < room ? s->run : room;
        if (s->literal)
            st = take_bytes(s, (char *)to + *got, n);
        else
            memset((char *)to + *got, s->value, n);
        *got += n;
        s->run -= (unsigned)n;
        s->given += n;
        if (st == ST_OK && s->given == s->plane)
            st = end_slice(s);
    }
    return st;
}

static void close_packed(void *ctx) {
    slc_stream *s = ctx;
    byte_stream_close(s->from);
    mem_free(s->m, s);
}

/* Put the unpacked slices in the place of the file. */
static status unpack(volume_layout *l) {
    slc_stream *s = mem_zalloc(l->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (slc_stream){.m = l->m,
                      .from = l->data,
                      .plane = (uint64_t)l->g.dims[0] * l->g.dims[1],
                      .slices = l->g.dims[2]};
    const byte_source source = {.read = read_packed, .close = close_packed, .ctx = s};
    const char *name = byte_stream_path(l->data);
    l->data = NULL;
    return byte_stream_open_source(l->m, name, &source, &l->data);
}

/* ---- the head ---- */

typedef struct slc_head {
    uint32_t dims[3];
    double spacing[3];
    int64_t bits, packed, icon[2];
} slc_head;

static status read_sizes(text_tokens *t, slc_head *h) {
    int64_t magic = 0, size = 0;
    status st = text_tokens_int(t, "11111", 11111, 11111, &magic);
    for (int a = 0; a < 3 && st == ST_OK; a++) {
        st = text_tokens_int(t, "a number of voxels", 1, INT32_MAX, &size);
        h->dims[a] = (uint32_t)size;
    }
    if (st == ST_OK)
        st = text_tokens_int(t, "bits a voxel", 1, 64, &h->bits);
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = text_tokens_double(t, "the size of a voxel", &h->spacing[a]);
    return st;
}

static status read_rest(text_tokens *t, slc_head *h) {
    static const char *const what[] = {"a unit's number", "where the data comes from",
                                       "what was done to it"};
    int64_t unused;
    status st = ST_OK;
    for (int i = 0; i < 3 && st == ST_OK; i++)
        st = text_tokens_int(t, what[i], INT32_MIN, INT32_MAX, &unused);
    if (st == ST_OK)
        st = text_tokens_int(t, "0 or 1: how it is packed", 0, 1, &h->packed);
    for (int i = 0; i < 2 && st == ST_OK; i++)
        st = text_tokens_int(t, "a size of the icon", 0, ICON_MAX, &h->icon[i]);
    return st == ST_OK ? take_x(t) : st;
}

static status open_layout(volume_layout *l, const volume_hints *hints) {
    double direction[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, origin[3] = {0, 0, 0};
    text_tokens t = {.s = l->data, .line = 1, .stop = 'X'};
    slc_head h = {.bits = 0};
    (void)hints;
    status st = read_sizes(&t, &h);
    if (st == ST_OK)
        st = read_rest(&t, &h);
    if (st == ST_OK && h.bits != 8)
        st = status_describe(ST_UNSUPPORTED, "%s: an SLC volume of %lld bits a voxel: 8 are read",
                             byte_stream_name(l->data), (long long)h.bits);
    if (st == ST_OK)
        st = byte_stream_skip(l->data, 3 * (uint64_t)h.icon[0] * (uint64_t)h.icon[1]);
    if (st != ST_OK)
        return st;
    grid_init(&l->g, h.dims, SAMPLE_U8);
    l->stored.type = SAMPLE_U8;
    volume_layout_place(l, direction, h.spacing, origin);
    st = grid_check(&l->g, byte_stream_name(l->data));
    return st == ST_OK && h.packed ? unpack(l) : st;
}

const grid_reader slc_reader = {.format = "SLC", .known = known, .layout = open_layout};
