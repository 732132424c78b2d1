/* vdb_writer.h - samples of a treelet file as an OpenVDB file (version 224), written front to back.
 *
 * A grid a set: Tree_float_5_4_3 of f32, Tree_int32_5_4_3 of integers, whose own type stands in the
 * metadata as "leafcast_type", which import-vdb reads. Index coordinates are those of the level, a
 * box's, too; the map is affine. The background is the value that most treelets have alone; what
 * has it is not active, and costs nothing. No library is needed, and no more memory than a node of
 * 128^3 voxels a thread: treelets are read twice, for the tree and then for its values.
 */
#ifndef PREP_EXPORT_VDB_WRITER_H
#define PREP_EXPORT_VDB_WRITER_H

#include "prep/export/sample_format.h"

/* vdb_writer_check() - ST_UNSUPPORTED for a rectilinear grid, or one whose map OpenVDB would take
 * for singular; g: the part, as grid_part_describe() has it. */
CHECKED status vdb_writer_check(const grid *g);

/* vdb_writer_run() - all of it; see out_stream.h. On standard output the file has no offsets of its
 * grids. The bytes depend on neither threads nor budget.
 * ST_NOMEM names the smallest budget that would do. */
CHECKED status vdb_writer_run(mem *m, const sample_export *e);

#endif
