/* imported.h - grids whose format needs a heavy library, read by the importer that is linked with
 * it.
 *
 * leafcast-import-X runs as a process of its own and writes NRRD into a pipe. Its errors are
 * reported as ours, and so is its crash. It gets half of what the budget has; our own limit is
 * lower while the source is open.
 */
#ifndef FORMATS_GRID_IMPORTED_H
#define FORMATS_GRID_IMPORTED_H

#include "formats/grid/grid_reader.h"

/* Recognises a file by its first bytes or by its suffix. Hands on the hints' field, component and
 * step. ST_UNSUPPORTED where the importer is missing, or the file is packed or a pipe. */
extern const grid_reader imported_reader;

/* imported_folder() - open a folder of slices. The first file whose format is recognised decides
 * the format; ST_UNSUPPORTED when none is. */
CHECKED status imported_folder(mem *m, const char *path, const volume_hints *hints,
                               slice_source *out);

#endif
