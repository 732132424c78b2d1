/* leaf_verify.h - whether every byte of a treelet file is what FORMAT.md says it must be.
 *
 * leaf_file_open() has checked the header, the directory and that ranges contain their children's.
 * This reads all payloads, too. It checks checksums, padding, samples against the own range, every
 * code against its samples, and inner nodes against their children. It also checks halos against
 * the neighbour's samples or the volume's border, and the number of non-finite samples. It does not
 * check how the writer made the coarse levels' samples. Histograms are counted again, with the
 * file's edges of bins.
 *
 * Meshes: checksums, padding, trees (mesh_leaf_check.h); bounds and ranges are exactly those of the
 * vertices; every code is recomputed; each vertex belongs to some tet; the number of non-finite
 * values is possible. The file cannot tell which vertices treelets share. So the header's count of
 * vertices is not checked exactly.
 *
 * Curvilinear grids: checksums, padding, boxes, ranges, and what kind of cell each is
 * (curvilinear_verify.h).
 */
#ifndef FORMATS_LEAF_LEAF_VERIFY_H
#define FORMATS_LEAF_LEAF_VERIFY_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf_file.h"

/* leaf_verify() - ST_OK, or ST_CORRUPT naming file, byte (of the file, or within a compressed
 * treelet's payload) and what was expected. Memory: two payloads a thread (of a mesh four,
 * and up to 640 KiB), 56 bytes a treelet, and up to 2 MiB for histograms. p may be NULL. */
CHECKED status leaf_verify(mem *m, leaf_file *f, int threads, const progress *p);

#endif
