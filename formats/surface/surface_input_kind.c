#include "formats/surface/surface_input_kind.h"

#include "formats/surface/surface_readers.h"

static status recognises(byte_stream *s, bool *known) {
    return mesh_input_recognise_by(&surface_readers, s, known);
}

static status open_stream(mem *m, byte_stream *s, const input_hints *hints, void **own) {
    mesh_input *x = NULL;
    const status st = mesh_input_open_by(m, &surface_readers, s, hints ? &hints->mesh : NULL, &x);
    *own = x;
    return st;
}

static void close_surface(void *own) {
    mesh_input_close(own);
}

static const char *format(const void *own) {
    return mesh_input_format(own);
}

static unsigned traits(const void *own) {
    return INPUT_CELLS | INPUT_ONE_LEVEL | INPUT_CHOICES |
           (mesh_input_names_files(own) ? INPUT_FILES : 0U);
}

const input_kind surface_input_kind = {.name = "surface",
                                       .recognises = recognises,
                                       .open = open_stream,
                                       .close = close_surface,
                                       .format = format,
                                       .traits = traits};
