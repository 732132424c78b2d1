#include "formats/curvilinear/curvilinear_input_kind.h"

#include "formats/curvilinear/curvilinear_input.h"

static bool is_asked(const input_hints *hints) {
    return curvilinear_input_is_asked(&hints->curvilinear);
}

static status open_stream(mem *m, byte_stream *s, const input_hints *hints, void **own) {
    curvilinear_input *x = NULL;
    const status st = curvilinear_input_open_stream(m, s, hints ? &hints->curvilinear : NULL, &x);
    *own = x;
    return st;
}

static void close_grid(void *own) {
    curvilinear_input_close(own);
}

static const char *format(const void *own) {
    return curvilinear_input_format(own);
}

static unsigned traits(const void *own) {
    return INPUT_CHOICES | (curvilinear_input_names_files(own) ? INPUT_FILES : 0U) |
           (curvilinear_input_may_have_steps(own) ? INPUT_STEPS | INPUT_SERIES : 0U);
}

const input_kind curvilinear_input_kind = {.name = "curvilinear",
                                           .recognises = curvilinear_input_recognise,
                                           .is_asked = is_asked,
                                           .last_first = true,
                                           .open = open_stream,
                                           .close = close_grid,
                                           .format = format,
                                           .traits = traits};
