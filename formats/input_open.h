/* input_open.h - what a conversion starts from: a grid or a mesh, told apart and opened.
 *
 * The one front door of all formats: grids by volume.h's table, meshes by mesh_input.h's, and what
 * is known by sight alone is named (formats/input/foreign.h).
 */
#ifndef FORMATS_INPUT_OPEN_H
#define FORMATS_INPUT_OPEN_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/grid/volume.h"
#include "formats/mesh/mesh_input.h"

/* One of the two; the other is NULL. */
typedef struct input {
    volume *v;
    mesh_input *x;
} input;

/* input_open() - a path, a folder, or "-", by its first bytes and its name. Each of the hints may
 * be NULL; those of meshes must live as long as the input. Errors as volume_open(),
 * mesh_input_open(). */
CHECKED status input_open(mem *m, const char *path, const volume_hints *of_grids,
                          const mesh_hints *of_meshes, input *out);
void input_close(input *in); /* zeros are fine */

#endif
