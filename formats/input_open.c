#include "formats/input_open.h"

#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/grid/volume_kind.h"
#include "formats/mesh/mesh_input_kind.h"

/* The last row takes what no other does. rather: the kind that an input is of where that kind, too,
 * can open it: that nodes of a structured grid lie as in a regular one is only seen in all of them.
 * NULL: there is none. */
static const struct row {
    const input_kind *kind, *rather;
} rows[] = {
    {&mesh_input_kind, NULL}, {&curvilinear_input_kind, &volume_kind}, {&volume_kind, NULL}};
enum { ROWS = sizeof rows / sizeof *rows };

static const input_kind *kind_of_folder(const char *path) {
    for (int i = 0; i < ROWS; i++)
        if (rows[i].kind->is_folder && rows[i].kind->is_folder(path))
            return rows[i].kind;
    return NULL;
}

static status recognise(byte_stream *s, const struct row **row) {
    bool known = false;
    for (int i = 0; i < ROWS && !known; i++) {
        *row = &rows[i];
        known = !rows[i].kind->recognises;
        const status st = known ? ST_OK : rows[i].kind->recognises(s, &known);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static const input_kind *asked_kind(const input_hints *hints) {
    for (int i = 0; hints && i < ROWS; i++)
        if (rows[i].kind->is_asked && rows[i].kind->is_asked(hints))
            return rows[i].kind;
    return NULL;
}

/* The kind is set only once the input is open. */
static status opened(status st, const input_kind *kind, input *out) {
    out->kind = st == ST_OK ? kind : NULL;
    return st;
}

static status open_stream(mem *m, byte_stream *s, const input_hints *hints, const input_kind *kind,
                          input *out) {
    return opened(kind->open(m, s, hints, &out->own), kind, out);
}

static status open_recognised(mem *m, const char *path, const input_hints *hints, input *out) {
    const struct row *row = NULL;
    byte_stream *s = NULL;
    status st = byte_stream_open(m, path, &s);
    if (st == ST_OK)
        st = recognise(s, &row);
    if (st != ST_OK) {
        byte_stream_close(s);
        return st;
    }
    if (!row->rather)
        return open_stream(m, s, hints, row->kind, out);
    st = open_stream(m, s, hints, row->rather, out);
    if (st != ST_UNSUPPORTED)
        return st;
    st = byte_stream_open(m, path, &s);
    return st == ST_OK ? open_stream(m, s, hints, row->kind, out) : st;
}

status input_open(mem *m, const char *path, const input_hints *hints, input *out) {
    byte_stream *s = NULL;
    *out = (input){0};
    const input_kind *kind = kind_of_folder(path);
    if (kind)
        return opened(kind->open_folder(m, path, hints, &out->own), kind, out);
    kind = asked_kind(hints);
    if (!kind)
        return open_recognised(m, path, hints, out);
    status st = byte_stream_open(m, path, &s);
    return st == ST_OK ? open_stream(m, s, hints, kind, out) : st;
}

void input_close(input *in) {
    if (in->kind)
        in->kind->close(in->own);
    *in = (input){0};
}
