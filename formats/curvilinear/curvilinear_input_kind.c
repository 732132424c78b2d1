#include "formats/curvilinear/curvilinear_input_kind.h"

#include <string.h>

#include "formats/curvilinear/curvilinear_imported.h"
#include "formats/curvilinear/curvilinear_input.h"

/* CGNS is a mesh, unless all of its cells are implied by zones. */
static status takes_over(mem *m, byte_stream *s, const input_hints *hints, bool *takes) {
    const uint8_t *start;
    size_t size;
    *takes = false;
    if (byte_stream_is_pipe(s) || strcmp(byte_stream_path(s), byte_stream_kind(s)) != 0)
        return ST_OK;
    const status st = byte_stream_peek(s, CURVILINEAR_READER_PEEK, &start, &size);
    if (st == ST_OK)
        *takes = curvilinear_imported_is(m, byte_stream_path(s), start, size,
                                         hints ? &hints->curvilinear.trust : NULL);
    return st;
}

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

static unsigned library_traits(const void *own) {
    if (!curvilinear_input_has_library(own))
        return 0;
    return INPUT_FILES | INPUT_PARTS |
           (unsigned)(curvilinear_input_is_placed(own) ? INPUT_PLACED : INPUT_MEANS);
}

static unsigned traits(const void *own) {
    return INPUT_ONE_LEVEL | INPUT_CHOICES |
           (curvilinear_input_names_files(own) ? INPUT_FILES : 0U) | library_traits(own) |
           (curvilinear_input_may_have_steps(own) ? INPUT_STEPS | INPUT_SERIES : 0U);
}

const input_kind curvilinear_input_kind = {.name = "curvilinear",
                                           .recognises = curvilinear_input_recognise,
                                           .is_asked = is_asked,
                                           .takes_over = takes_over,
                                           .last_first = true,
                                           .open = open_stream,
                                           .close = close_grid,
                                           .format = format,
                                           .traits = traits};
