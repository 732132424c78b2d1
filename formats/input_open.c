#include "formats/input_open.h"

#include "formats/curvilinear/curvilinear_input_kind.h"
#include "formats/grid/volume_kind.h"
#include "formats/mesh/mesh_input_kind.h"

/* The last row takes what no other does. */
static const input_kind *const kinds[] = {&mesh_input_kind, &curvilinear_input_kind, &volume_kind};
enum { KINDS = sizeof kinds / sizeof *kinds };

static const input_kind *kind_of_folder(const char *path) {
    for (int i = 0; i < KINDS; i++)
        if (kinds[i]->is_folder && kinds[i]->is_folder(path))
            return kinds[i];
    return NULL;
}

static status recognise(byte_stream *s, const input_hints *hints, const input_kind **kind) {
    bool known = false;
    for (int i = 0; i < KINDS && !known; i++) {
        *kind = kinds[i];
        known = !kinds[i]->recognises || (hints && kinds[i]->is_asked && kinds[i]->is_asked(hints));
        const status st = known ? ST_OK : kinds[i]->recognises(s, &known);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

/* The kind is set only once the input is open. */
static status opened(status st, const input_kind *kind, input *out) {
    out->kind = st == ST_OK ? kind : NULL;
    return st;
}

status input_open(mem *m, const char *path, const input_hints *hints, input *out) {
    byte_stream *s = NULL;
    *out = (input){0};
    const input_kind *kind = kind_of_folder(path);
    if (kind)
        return opened(kind->open_folder(m, path, hints, &out->own), kind, out);
    status st = byte_stream_open(m, path, &s);
    if (st == ST_OK)
        st = recognise(s, hints, &kind);
    if (st != ST_OK) {
        byte_stream_close(s);
        return st;
    }
    return opened(kind->open(m, s, hints, &out->own), kind, out);
}

void input_close(input *in) {
    if (in->kind)
        in->kind->close(in->own);
    *in = (input){0};
}
