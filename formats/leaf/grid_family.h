/* grid_family.h - what the treelets of a family share, and what each has alone (FORMAT.md 10).
 *
 * A family is the children of one treelet. Siblings overlap by 1 + 2 halo samples on each axis. A
 * compressed file stores the overlaps once, as the family's shell. A treelet's payload is only its
 * own samples: those that no sibling has. They form a box. Samples of a family are counted on each
 * axis from the first one of its first treelet, halo included.
 */
#ifndef FORMATS_LEAF_GRID_FAMILY_H
#define FORMATS_LEAF_GRID_FAMILY_H

#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/box_coder.h"
#include "formats/leaf/leaf_layout.h"

/* A box of a family's samples. */
typedef struct family_part {
    uint32_t at[3], size[3];
} family_part;

/* A shell is up to so many boxes. */
enum { FAMILY_PARTS_MAX = 7 };

/* grid_family_parts() - the boxes of the shell below a treelet of level 1 or above: where the
 * family has two treelets along z, the samples that both have; then, for the samples before those
 * and for those behind, the same along y; and then along x. Returns how many there are; 0: the
 * family is one treelet. */
uint32_t grid_family_parts(const leaf_layout *l, uint32_t parent,
                           family_part parts[FAMILY_PARTS_MAX]);

/* grid_family_shell_boxes() - a shell's boxes for the coder. samples: its boxes one behind the
 * other, each x fastest. Returns how many there are. */
uint32_t grid_family_shell_boxes(const leaf_layout *l, uint32_t parent, void *samples,
                                 coded_box boxes[FAMILY_PARTS_MAX]);

/* grid_family_own() - the box of a treelet's payload that no sibling has, for the coder. The root
 * has all of its samples alone. */
coded_box grid_family_own(const leaf_layout *l, uint32_t treelet, void *payload);

/* grid_family_take() - copy into a treelet's payload the samples of its family's shell that lie in
 * it. */
void grid_family_take(const leaf_layout *l, uint32_t parent, uint32_t treelet, const void *shell,
                      void *payload);

#endif
