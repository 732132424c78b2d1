#include "formats/surface/plc_stl.h"

#include <endian.h>
#include <string.h>
#include <strings.h>

#include "formats/input/text_tokens.h"

enum { HEADER = 84, TRIANGLE = 50, LOOK = 1024 };

static status no_field(const plc_source *s) {
    if (!s->hints.field || s->hints.optional)
        return ST_OK;
    return status_describe(ST_UNSUPPORTED, "%s: no field \"%s\": STL has none",
                           byte_stream_name(s->data), s->hints.field);
}

static uint32_t word_at(const uint8_t *at) {
    uint32_t word;
    memcpy(&word, at, 4);
    return le32toh(word);
}

static status add_triangle(const plc_source *s, uint64_t number) {
    plc *x = s->out;
    const uint64_t first = x->points.count;
    status st = plc_add_facet(x, number);
    if (st == ST_OK)
        st = plc_add_polygon(x);
    for (uint64_t c = 0; st == ST_OK && c < 3; c++)
        st = plc_add_corner(x, first + c);
    return st;
}

/* ---- binary ---- */

static status read_triangle(const plc_source *s, uint64_t number) {
    uint8_t bytes[TRIANGLE];
    size_t got;
    status st = byte_stream_read(s->data, bytes, sizeof bytes, &got);
    if (st == ST_OK && got < sizeof bytes)
        return status_describe(
            ST_CORRUPT, "%s: ends at byte %llu, inside triangle %llu (counted from 0)",
            byte_stream_name(s->data), (unsigned long long)byte_stream_position(s->data),
            (unsigned long long)number);
    if (st == ST_OK)
        st = add_triangle(s, number);
    for (int c = 0; st == ST_OK && c < 3; c++) {
        double xyz[3];
        for (int a = 0; a < 3; a++) {
            const uint32_t word = word_at(bytes + 12 + 12 * c + 4 * a);
            float f;
            memcpy(&f, &word, 4);
            xyz[a] = (double)f;
        }
        st = plc_add_point(s, xyz, 0);
    }
    return st;
}

static status read_binary(const plc_source *s) {
    uint8_t header[HEADER];
    const uint8_t *more;
    size_t got;
    status st = byte_stream_read(s->data, header, sizeof header, &got);
    if (st == ST_OK && got < sizeof header)
        return status_describe(ST_CORRUPT, "%s: ends at byte %zu, expected a header of 84 bytes",
                               byte_stream_name(s->data), got);
    const uint64_t triangles = st == ST_OK ? word_at(header + 80) : 0;
    for (uint64_t i = 0; st == ST_OK && i < triangles; i++)
        st = read_triangle(s, i);
    if (st == ST_OK)
        st = byte_stream_peek(s->data, 1, &more, &got);
    if (st == ST_OK && got > 0)
        return status_describe(
            ST_CORRUPT, "%s: more bytes at %llu, expected the end behind %llu triangles",
            byte_stream_name(s->data), (unsigned long long)byte_stream_position(s->data),
            (unsigned long long)triangles);
    return st;
}

/* ---- text ---- */

static status expect(text_tokens *t, const char *word) {
    status st = text_tokens_next(t);
    return st == ST_OK && strcasecmp(t->token, word) != 0 ? text_tokens_fault(t, "\"%s\"", word)
                                                          : st;
}

static status read_facet(const plc_source *s, text_tokens *t, uint64_t number) {
    double n;
    status st = expect(t, "normal");
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = text_tokens_double(t, "a number of the normal", &n);
    if (st == ST_OK)
        st = expect(t, "outer");
    if (st == ST_OK)
        st = expect(t, "loop");
    if (st == ST_OK)
        st = add_triangle(s, number);
    for (int c = 0; st == ST_OK && c < 3; c++) {
        double xyz[3];
        st = expect(t, "vertex");
        for (int a = 0; st == ST_OK && a < 3; a++)
            st = text_tokens_double(t, "a coordinate", &xyz[a]);
        if (st == ST_OK)
            st = plc_add_point(s, xyz, t->line);
    }
    if (st == ST_OK)
        st = expect(t, "endloop");
    return st == ST_OK ? expect(t, "endfacet") : st;
}

/* Read solid NAME, facets, endsolid NAME. Several solids are one surface. */
static status read_text(const plc_source *s) {
    text_tokens t = {.s = s->data, .line = 1};
    char name[512];
    uint64_t facets = 0;
    status st = expect(&t, "solid");
    while (st == ST_OK) {
        st = text_tokens_rest(&t, name, sizeof name);
        if (st == ST_OK)
            st = text_tokens_next(&t);
        while (st == ST_OK && strcasecmp(t.token, "facet") == 0) {
            st = read_facet(s, &t, facets++);
            if (st == ST_OK)
                st = text_tokens_next(&t);
        }
        if (st == ST_OK && strcasecmp(t.token, "endsolid") != 0)
            return text_tokens_fault(&t, "\"facet\" or \"endsolid\"");
        if (st == ST_OK)
            st = text_tokens_rest(&t, name, sizeof name);
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
static status is_text(const plc_source *s, bool *text) {
    const uint8_t *start;
    size_t size;
    status st = byte_stream_peek(s->data, LOOK, &start, &size);
    if (st != ST_OK)
        return st;
    const uint64_t left = byte_stream_left(s->data);
    *text = size >= 5 && strncasecmp((const char *)start, "solid", 5) == 0;
    if (size >= HEADER && left != UINT64_MAX &&
        left == HEADER + TRIANGLE * (uint64_t)word_at(start + 80))
        *text = false;
    for (size_t i = 0; i < size && *text; i++)
        *text = start[i] != 0;
    return ST_OK;
}

status plc_stl_read(plc_source *s) {
    bool text = false;
    status st = no_field(s);
    if (st == ST_OK)
        st = is_text(s, &text);
    if (st != ST_OK)
        return st;
    return text ? read_text(s) : read_binary(s);
}
