/* triangle_verify.h - checks every byte of the treelets of a surface of triangles (leaf_verify.h).
 */
#ifndef FORMATS_LEAF_TRIANGLE_VERIFY_H
#define FORMATS_LEAF_TRIANGLE_VERIFY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_verifier triangle_verifier;

#endif
