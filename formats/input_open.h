/* input_open.h - what a conversion starts from, recognized and opened by the row of its kind.
 *
 * The one entry for all formats: grids by volume.h's table, meshes by mesh_input.h's, surfaces
 * by surface_readers.h's, curvilinear grids by curvilinear_input.h's. A format that is only
 * recognized (formats/input/foreign.h) is named in the error.
 */
#ifndef FORMATS_INPUT_OPEN_H
#define FORMATS_INPUT_OPEN_H

#include "formats/input_kind.h"

typedef struct input {
    const input_kind *kind; /* NULL: it is not open */
    void *own;              /* what the kind's open() made */
} input;

/* input_open() - open a path, a folder, or "-"; first bytes and name decide the format. The hints
 * may be NULL, and must live as long as the input. Errors as of volume_open(), mesh_input_open().
 */
CHECKED status input_open(mem *m, const char *path, const input_hints *hints, input *out);
void input_close(input *in); /* all zeros are fine */

#endif
