/* input_open.h - what a conversion starts from: a grid or a mesh, recognized and opened.
 *
 * The one entry for all formats: grids by volume.h's table, meshes by mesh_input.h's. A format that
 * is only recognized (formats/input/foreign.h) is named in the error.
 */
#ifndef FORMATS_INPUT_OPEN_H
#define FORMATS_INPUT_OPEN_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"

/* One of the two is set; the other is NULL. */
typedef struct input {
    volume *v;
    mesh_input *x;
} input;

/* input_open() - open a path, a folder, or "-"; first bytes and name decide the format. Each of the
 * hints may be NULL. of_meshes must live as long as the input. Errors as of volume_open(),
 * mesh_input_open(). */
CHECKED status input_open(mem *m, const char *path, const volume_hints *of_grids,
                          const mesh_hints *of_meshes, input *out);
void input_close(input *in); /* all zeros are fine */

#endif
