/* imported.h - grids whose format needs a heavy library: read by the verb that is linked with it.
 *
 * leafcast-import-X runs as a process of its own and writes NRRD into a pipe; what it says of an
 * error is ours, and so is its crash. Of a budget it gets half: the limit is lower as long as the
 * source is open.
 */
#ifndef FORMATS_GRID_IMPORTED_H
#define FORMATS_GRID_IMPORTED_H

#include "formats/grid/grid_reader.h"

/* Knows a file by its first bytes or by its suffix. Of hints, field, component and step are handed
 * on. ST_UNSUPPORTED where the verb is not there, or the file is packed or a pipe. */
extern const grid_reader imported_reader;

/* imported_folder() - a folder of slices, told by the first file in it that tells a format.
 * ST_UNSUPPORTED when none does. */
CHECKED status imported_folder(mem *m, const char *path, const volume_hints *hints,
                               slice_source *out);

#endif
