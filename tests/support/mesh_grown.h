/* mesh_grown.h - a small file of a mesh that has grown. */
#ifndef TESTS_SUPPORT_MESH_GROWN_H
#define TESTS_SUPPORT_MESH_GROWN_H

#include <stdint.h>

#include "formats/leaf/leaf.h"

/* mesh_grown_make() - a file of so many segments with a step each, with gradients, in the scratch
 * folder; of 3 or more, the second and the third have the same values. Aborts on an error. Returns
 * its path. */
const char *mesh_grown_make(uint32_t n, uint32_t segments, leaf_codec codec, const char *name);

#endif
