#include "formats/mesh/mesh_input_kind.h"

#include "formats/mesh/mesh_input.h"

static status open_stream(mem *m, byte_stream *s, const input_hints *hints, void **own) {
    mesh_input *x = NULL;
    const status st = mesh_input_open_stream(m, s, hints ? &hints->mesh : NULL, &x);
    *own = x;
    return st;
}

static void close_mesh(void *own) {
    mesh_input_close(own);
}

static const char *format(const void *own) {
    return mesh_input_format(own);
}

static unsigned traits(const void *own) {
    const bool files = mesh_input_names_files(own);
    const unsigned library = mesh_input_by_library(own) ? INPUT_FILES | INPUT_PARTS : 0U;
    return INPUT_CELLS | INPUT_ONE_LEVEL | INPUT_CHOICES | (files ? INPUT_FILES : 0U) | library |
           (files || mesh_input_may_have_steps(own) ? INPUT_STEPS | INPUT_SERIES : 0U);
}

const input_kind mesh_input_kind = {.name = "mesh",
                                    .recognises = mesh_input_recognise,
                                    .open = open_stream,
                                    .close = close_mesh,
                                    .format = format,
                                    .traits = traits};
