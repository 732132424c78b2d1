#include "formats/surface/surface_stl.h"

#include <string.h>
#include <strings.h>

#include "formats/base/text.h"
#include "formats/input/binary_fields.h"
#include "formats/input/text_tokens.h"
#include "formats/surface/surface_flow.h"

enum { HEADER = 84, TRIANGLE = 50, LOOK = 1024 };

typedef struct stl {
    surface_choice choice; /* of nothing */
    mem *m;
    byte_stream *s;
    bool text;
    uint64_t triangles; /* binary: by the header */
} stl;

static status put_triangle(surface_flow *flow, const double xyz[3][3], uint64_t number) {
    const uint64_t ids[3] = {3 * number, 3 * number + 1, 3 * number + 2};
    status st = ST_OK;
    for (int c = 0; st == ST_OK && c < 3; c++)
        st = surface_flow_point(flow, xyz[c]);
    return st == ST_OK ? surface_flow_polygon(flow, ids, 3, NULL) : st;
}

/* ---- binary ---- */

static status read_triangle(const stl *s, surface_flow *flow, uint64_t number) {
    const uint8_t *at;
    size_t size;
    double xyz[3][3];
    status st = byte_stream_peek(s->s, TRIANGLE, &at, &size);
    if (st == ST_OK && size < TRIANGLE)
        return status_describe(
            ST_CORRUPT, "%s: ends at byte %llu, inside triangle %llu (counted from 0)",
            byte_stream_name(s->s), (unsigned long long)(byte_stream_position(s->s) + size),
            (unsigned long long)number);
    if (st != ST_OK)
        return st;
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            xyz[c][a] = binary_real(at + 12 + 12 * (ptrdiff_t)c + 4 * (ptrdiff_t)a, 4, false);
    byte_stream_take(s->s, TRIANGLE);
    return put_triangle(flow, (const double(*)[3])xyz, number);
}

static status read_binary(const stl *s, surface_flow *flow) {
    const uint8_t *more;
    size_t size = 0;
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < s->triangles; i++)
        st = read_triangle(s, flow, i);
    if (st == ST_OK)
        st = byte_stream_peek(s->s, 1, &more, &size);
    if (st == ST_OK && size > 0)
        return status_describe(
            ST_CORRUPT, "%s: more bytes at %llu, expected the end behind %llu triangles",
            byte_stream_name(s->s), (unsigned long long)byte_stream_position(s->s),
            (unsigned long long)s->triangles);
    return st;
}

static status open_binary(stl *s) {
    uint8_t header[HEADER];
    size_t got;
    status st = byte_stream_read(s->s, header, sizeof header, &got);
    if (st == ST_OK && got < sizeof header)
        return status_describe(ST_CORRUPT, "%s: ends at byte %zu, expected a header of 84 bytes",
                               byte_stream_name(s->s), got);
    if (st != ST_OK)
        return st;
    const uint64_t left = byte_stream_left(s->s);
    s->triangles = binary_unsigned(header + 80, 4, false);
    if (left != UINT64_MAX && s->triangles * TRIANGLE > left)
        return status_describe(
            ST_CORRUPT,
            "%s: the header says %llu triangles of 50 bytes, but only %llu bytes follow",
            byte_stream_name(s->s), (unsigned long long)s->triangles, (unsigned long long)left);
    return ST_OK;
}

/* ---- text ---- */

static status expect(text_tokens *t, const char *word) {
    status st = text_tokens_next(t);
    return st == ST_OK && strcasecmp(t->token, word) != 0 ? text_tokens_fault(t, "\"%s\"", word)
                                                          : st;
}

static status read_facet(text_tokens *t, surface_flow *flow, uint64_t number) {
    double n, xyz[3][3];
    status st = expect(t, "normal");
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = text_tokens_double(t, "a number of the normal", &n);
    if (st == ST_OK)
        st = expect(t, "outer");
    if (st == ST_OK)
        st = expect(t, "loop");
    for (int c = 0; st == ST_OK && c < 3; c++) {
        st = expect(t, "vertex");
        for (int a = 0; st == ST_OK && a < 3; a++)
            st = text_tokens_double(t, "a coordinate", &xyz[c][a]);
    }
    if (st == ST_OK)
        st = expect(t, "endloop");
    if (st == ST_OK)
        st = expect(t, "endfacet");
    return st == ST_OK ? put_triangle(flow, (const double(*)[3])xyz, number) : st;
}

/* Read a solid behind its first word: its name, facets, endsolid, its name. */
static status read_solid(text_tokens *t, surface_flow *flow, uint64_t *facets) {
    char name[512];
    status st = text_tokens_rest(t, name, sizeof name);
    if (st == ST_OK)
        st = text_tokens_next(t);
    while (st == ST_OK && strcasecmp(t->token, "facet") == 0) {
        st = read_facet(t, flow, (*facets)++);
        if (st == ST_OK)
            st = text_tokens_next(t);
    }
    if (st == ST_OK && strcasecmp(t->token, "endsolid") != 0)
        return text_tokens_fault(t, "\"facet\" or \"endsolid\"");
    return st == ST_OK ? text_tokens_rest(t, name, sizeof name) : st;
}

/* Several solids are one surface. */
static status read_text(const stl *s, surface_flow *flow) {
    text_tokens t = {.s = s->s, .line = 1};
    uint64_t facets = 0;
    status st = expect(&t, "solid");
    while (st == ST_OK) {
        st = read_solid(&t, flow, &facets);
        if (st == ST_OK)
            st = text_tokens_next(&t);
        if (st == ST_OK && !t.token[0])
            return ST_OK;
        if (st == ST_OK && strcasecmp(t.token, "solid") != 0)
            return text_tokens_fault(&t, "\"solid\" or the end");
    }
    return st;
}

/* Find out whether the file is text. Headers of binary files may begin with "solid", too. */
static status is_text(const stl *s, bool *text) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(s->s, LOOK, &start, &size);
    if (st != ST_OK)
        return st;
    const uint64_t left = byte_stream_left(s->s);
    *text = size >= 5 && strncasecmp((const char *)start, "solid", 5) == 0;
    if (size >= HEADER && left != UINT64_MAX &&
        left == HEADER + TRIANGLE * binary_unsigned(start + 80, 4, false))
        *text = false;
    *text = *text && !memchr(start, 0, size);
    return ST_OK;
}

/* ---- the reader ---- */

static bool known(const char *path, const uint8_t *start, size_t size) {
    return text_ends_in(path, ".stl") ||
           (size >= 6 && strncasecmp((const char *)start, "solid", 5) == 0 && start[5] <= ' ' &&
            !memchr(start, 0, size) && memmem(start, size, "facet", 5));
}

static status open_file(mesh_source *source, void **state) {
    stl *s = mem_zalloc(source->m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *state = s;
    s->m = source->m;
    s->s = source->data;
    s->choice.source = source;
    status st = is_text(s, &s->text);
    return st == ST_OK && !s->text ? open_binary(s) : st;
}

static status pass(void *state, surface_flow *flow) {
    const stl *s = state;
    status st = surface_flow_piece(flow, s->text ? UINT64_MAX : 3 * s->triangles);
    if (st == ST_OK)
        st = s->text ? read_text(s, flow) : read_binary(s, flow);
    return st == ST_OK ? surface_flow_end_piece(flow) : st;
}

static status read(void *state, mesh_feed *feed) {
    stl *s = state;
    mesh_feed_expect_cells(feed, s->triangles);
    return surface_flow_run(&s->choice, feed, s->text ? UINT64_MAX : 3 * s->triangles, false, pass,
                            s);
}

static void counts(const void *state, uint64_t *points, uint64_t *cells) {
    const stl *s = state;
    *points = s->text ? UINT64_MAX : 3 * s->triangles;
    *cells = s->triangles;
}

static void close_file(void *state) {
    stl *s = state;
    if (!s)
        return;
    surface_choice_release(&s->choice);
    mem_free(s->m, s);
}

const mesh_reader surface_stl_reader = {.format = "STL",
                                        .known = known,
                                        .open = open_file,
                                        .read = read,
                                        .close = close_file,
                                        .take = surface_choice_take,
                                        .fields = surface_choice_fields,
                                        .counts = counts};
