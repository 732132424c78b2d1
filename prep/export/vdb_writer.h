/* vdb_writer.h - writes samples of a treelet file as an OpenVDB file (version 224), front to back.
 *
 * Each set is a grid: Tree_float_5_4_3 for f32, Tree_int32_5_4_3 for integers. Their own type is in
 * the metadata as "leafcast_type", which import-vdb reads. Index coordinates are those of the
 * level, for a box, too; the map is affine. The background is the value of most treelets of one
 * value. Voxels with it are inactive and cost nothing. No library is needed, and no more memory
 * than a node of 128^3 voxels per thread. Treelets are read twice: for the tree, then for its
 * values.
 */
#ifndef PREP_EXPORT_VDB_WRITER_H
#define PREP_EXPORT_VDB_WRITER_H

#include "prep/export/sample_format.h"

/* vdb_writer_check() - ST_UNSUPPORTED for a rectilinear grid, or a map that OpenVDB would call
 * singular. g: the part, as made by grid_part_describe(). */
CHECKED status vdb_writer_check(const grid *g);

/* vdb_writer_run() - write the whole file; see out_stream.h. On standard output the file has no
 * offsets of its grids. The bytes depend on neither threads nor budget. ST_NOMEM names the smallest
 * budget that would do. */
CHECKED status vdb_writer_run(mem *m, const sample_export *e);

#endif
