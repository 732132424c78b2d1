/* hex_grown.h - small files of hexahedra, which have grown: a curvilinear grid's, and a mixed
 * mesh's.
 *
 * Each is of a shape of hex_lab.h, in the scratch folder, of so many segments with a step each; of
 * 3 or more, the second and the third have the same values. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_HEX_GROWN_H
#define TESTS_SUPPORT_HEX_GROWN_H

#include <stdint.h>

#include "formats/leaf/leaf.h"

/* hex_grown_grid(), hex_grown_mix() - returns the file's path. */
const char *hex_grown_grid(int lab, uint32_t segments, leaf_codec codec, const char *name);
const char *hex_grown_mix(int lab, uint32_t segments, leaf_codec codec, const char *name);

#endif
