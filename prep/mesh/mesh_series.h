/* mesh_series.h - several meshes as the steps of one, and several of their arrays as its fields.
 *
 * The tets of every step must equal those of the first, one by one. Points may move. A file is read
 * once, with all its fields.
 */
#ifndef PREP_MESH_MESH_SERIES_H
#define PREP_MESH_MESH_SERIES_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "formats/mesh/mesh_input.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/step_series.h"

typedef struct mesh_series {
    step_series of;
    mesh_hints hints; /* `field` is unused if there are names, `step` if the steps are in a file */
    const struct mesh_readers *readers; /* of later steps' files (mesh_reader.h); NULL: of meshes */
} mesh_series;

/* mesh_series_begin() - call it before the steps are read into g. first: the first step's mesh,
 * just opened, with any of the fields. mesh_series_read() - read the next step, g->done, into sink,
 * a sink of g. report: set by the first reading, and needed by the others. ST_CORRUPT names the
 * file that differs from the first, and its first tet that does. */
void mesh_series_begin(const mesh_series *s, mesh_input *first, mesh_gather *g);
CHECKED status mesh_series_read(mem *m, const mesh_series *s, mesh_input *first, mesh_gather *g,
                                const mesh_sink *sink, mesh_report *report);

#endif
