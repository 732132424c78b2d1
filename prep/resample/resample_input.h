/* resample_input.h - whatever holds a mesh, as an open treelet file of it. */
#ifndef PREP_RESAMPLE_RESAMPLE_INPUT_H
#define PREP_RESAMPLE_RESAMPLE_INPUT_H

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"
#include "formats/mesh/mesh_input.h"

typedef struct resample_source {
    const char *path;   /* a treelet file, or what mesh_input_open() takes; "-": standard input */
    mesh_hints hints;   /* of a mesh */
    const char *beside; /* the path beside which a mesh becomes a treelet file; NULL: in $TMPDIR,
                           or /tmp */
    int threads;
} resample_source;

/* resample_input_is_leaf() - whether the file begins as a treelet file does. */
bool resample_input_is_leaf(const char *path);

/* resample_input_open() - a treelet file as it is; a mesh is converted to one, within m's limit,
 * that has no name any more when this returns and vanishes on leaf_file_close(). ST_UNSUPPORTED for
 * a grid. p may be NULL. */
CHECKED status resample_input_open(mem *m, const resample_source *s, const progress *p,
                                   leaf_file **out);

#endif
