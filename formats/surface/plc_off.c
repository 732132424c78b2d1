#include "formats/surface/plc_off.h"

#include <string.h>

#include "formats/input/text_tokens.h"

/* Skip the other numbers of a vertex or face. */
static status skip_line(text_tokens *t) {
    bool more;
    status st = text_tokens_more(t, &more);
    while (st == ST_OK && more) {
        st = text_tokens_next(t);
        if (st == ST_OK)
            st = text_tokens_more(t, &more);
    }
    return st == ST_OK ? text_tokens_end_line(t) : st;
}

static status read_header(text_tokens *t, int64_t *vertices, int64_t *faces) {
    status st = text_tokens_next(t);
    bool more;
    if (st == ST_OK && strcmp(t->token, "OFF") != 0 && strcmp(t->token, "COFF") != 0 &&
        strcmp(t->token, "NOFF") != 0 && strcmp(t->token, "CNOFF") != 0)
        return text_tokens_fault(t, "OFF, COFF or NOFF");
    if (st == ST_OK)
        st = text_tokens_more(t, &more);
    if (st == ST_OK)
        st = text_tokens_int(t, "the number of vertices", 0, (int64_t)PLC_MAX, vertices);
    if (st != ST_OK && strcmp(t->token, "BINARY") == 0)
        return status_describe(ST_UNSUPPORTED, "%s: binary OFF, expected OFF in text",
                               byte_stream_name(t->s));
    if (st == ST_OK)
        st = text_tokens_int(t, "the number of faces", 0, (int64_t)PLC_MAX, faces);
    return st == ST_OK ? skip_line(t) : st;
}

static status read_vertex(plc_source *s, text_tokens *t) {
    double xyz[3];
    status st = ST_OK;
    for (int a = 0; st == ST_OK && a < 3; a++)
        st = text_tokens_double(t, "a coordinate", &xyz[a]);
    if (st == ST_OK)
        st = plc_add_point(s, xyz, t->line);
    return st == ST_OK ? skip_line(t) : st;
}

static status read_face(plc *x, text_tokens *t, int64_t number, int64_t vertices) {
    int64_t corners, id;
    status st = text_tokens_int(t, "the number of a face's vertices", 0, vertices, &corners);
    if (st == ST_OK)
        st = plc_add_facet(x, (uint64_t)number);
    if (st == ST_OK)
        st = plc_add_polygon(x);
    for (int64_t c = 0; st == ST_OK && c < corners; c++) {
        st = text_tokens_int(t, "the number of a vertex, counted from 0", 0, vertices - 1, &id);
        if (st == ST_OK)
            st = plc_add_corner(x, (uint64_t)id);
    }
    return st == ST_OK ? skip_line(t) : st;
}

status plc_off_read(plc_source *s) {
    text_tokens t = {.s = s->data, .line = 1, .comment = '#'};
    int64_t vertices = 0, faces = 0;
    if (s->hints.field && !s->hints.optional)
        return status_describe(ST_UNSUPPORTED, "%s: no field \"%s\": OFF has none",
                               byte_stream_name(s->data), s->hints.field);
    status st = read_header(&t, &vertices, &faces);
    for (int64_t i = 0; st == ST_OK && i < vertices; i++)
        st = read_vertex(s, &t);
    for (int64_t i = 0; st == ST_OK && i < faces; i++)
        st = read_face(s->out, &t, i, vertices);
    return st;
}
