/* convert_input.h - what a conversion starts from: a grid or a mesh, told apart and opened.
 *
 * Of the verb and of the library; what they convert by default is here, too, so that the same input
 * gives the same bytes.
 */
#ifndef PREP_CONVERT_INPUT_H
#define PREP_CONVERT_INPUT_H

#include "formats/grid/volume.h"
#include "formats/leaf/leaf_writer.h"
#include "formats/mesh/mesh_input.h"

#define CONVERT_MEMORY_DEFAULT ((uint64_t)2 << 30)

/* One of the two; the other is NULL. */
typedef struct convert_input {
    volume *v;
    mesh_input *x;
} convert_input;

/* convert_parameters_default() - leaf_parameters_default(), and with histograms. */
leaf_parameters convert_parameters_default(void);

/* convert_input_open() - a path, or "-", by its name and its first bytes. Each of the hints may be
 * NULL; those of meshes must live as long as the input. Errors as volume_open(), mesh_input_open().
 */
CHECKED status convert_input_open(mem *m, const char *path, const volume_hints *of_grids,
                                  const mesh_hints *of_meshes, convert_input *out);
void convert_input_close(convert_input *in); /* zeros are fine */

#endif
