/* mixed_verify.h - checks the treelets of a mixed mesh (leaf_verify.h). */
#ifndef FORMATS_LEAF_MIXED_VERIFY_H
#define FORMATS_LEAF_MIXED_VERIFY_H

#include "formats/leaf/leaf_geometry.h"

extern const leaf_verifier mixed_verifier;

#endif
