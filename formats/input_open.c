#include "formats/input_open.h"

#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/grid/volume_kind.h"
#include "formats/mesh/mesh_input_kind.h"
#include "formats/surface/surface_input_kind.h"

/* The last row takes what no other does. */
static const input_kind *const kinds[] = {&mesh_input_kind, &surface_input_kind,
                                          &curvilinear_input_kind, &volume_kind};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const input_kind *kind_of_folder(const char *path) {
    for (int i = 0; i < KINDS; i++)
        if (kinds[i]->is_folder && kinds[i]->is_folder(path))
            return kinds[i];
    return NULL;
}

/* Let later rows have a closer look. */
static status look_closer(mem *m, byte_stream *s, const input_hints *hints, int at,
                          const input_kind **kind) {
    bool takes = false;
    status st = ST_OK;
    for (int i = at + 1; i < KINDS && !takes && st == ST_OK; i++)
        if (kinds[i]->takes_over) {
            st = kinds[i]->takes_over(m, s, hints, &takes);
            *kind = takes ? kinds[i] : *kind;
        }
    return st;
}

static status recognise(mem *m, byte_stream *s, const input_hints *hints, const input_kind **kind) {
    bool known = false;
    for (int i = 0; i < KINDS; i++) {
        *kind = kinds[i];
        known = !kinds[i]->recognises;
        const status st = known ? ST_OK : kinds[i]->recognises(s, &known);
        if (st != ST_OK)
            return st;
        if (known)
            return look_closer(m, s, hints, i, kind);
    }
    return ST_OK;
}

static const input_kind *asked_kind(const input_hints *hints) {
    for (int i = 0; hints && i < KINDS; i++)
        if (kinds[i]->is_asked && kinds[i]->is_asked(hints))
            return kinds[i];
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
    const input_kind *kind = NULL;
    byte_stream *s = NULL;
    status st = byte_stream_open(m, path, &s);
    if (st == ST_OK)
        st = recognise(m, s, hints, &kind);
    if (st != ST_OK) {
        byte_stream_close(s);
        return st;
    }
    if (!kind->last_first || byte_stream_is_pipe(s))
        return open_stream(m, s, hints, kind, out);
    st = open_stream(m, s, hints, kinds[KINDS - 1], out);
    if (st != ST_UNSUPPORTED)
        return st;
    st = byte_stream_open(m, path, &s);
    return st == ST_OK ? open_stream(m, s, hints, kind, out) : st;
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
