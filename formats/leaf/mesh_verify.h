/* mesh_verify.h - whether the payloads of a mesh's treelet are what FORMAT.md says they must be: a
 * row of leaf_verify.h. */
#ifndef FORMATS_LEAF_MESH_VERIFY_H
#define FORMATS_LEAF_MESH_VERIFY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_verifier mesh_verifier;

#endif
