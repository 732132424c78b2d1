/* leaf_verify.h - whether every byte of a treelet file is what FORMAT.md says it must be.
 *
 * leaf_file_open() has checked header, directory and that ranges contain their children's. This
 * reads the payloads too, all of them: checksums, padding, samples within the own range, every code
 * recomputed from its samples, inner nodes from their children, halos that repeat the neighbour's
 * samples or the volume's border, the number of non-finite samples. Only what the levels' samples
 * should be is the writer's affair. Histograms are counted again, with the
 * edges of bins as they are.
 *
 * Of a mesh: checksums, padding, trees (mesh_leaf_check.h), bounds and ranges exactly those of the
 * vertices, every code recomputed, each vertex some tet's, as many non-finite values as can be.
 * What the file cannot tell: which vertices treelets share, and so the header's count of them.
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
