/* lab_leaf.h - meshes of tet_meshes.h as treelet files in the scratch folder. Trouble fails the
 * running test. */
#ifndef TESTS_SUPPORT_LAB_LEAF_H
#define TESTS_SUPPORT_LAB_LEAF_H

#include "tests/support/tet_meshes.h"

/* lab_leaf_make() - with treelets of up to so many tets, and gradients at the vertices if asked
 * for; the file's path. There is one at a time. */
const char *lab_leaf_make(const lab_mesh *lab, uint32_t treelet_tets, bool gradients);

/* lab_leaf_field() - the same of a field of prep/generate/field.h on dims^3 nodes of a generated
 * mesh, in treelets of the usual size. */
const char *lab_leaf_field(const char *name, uint32_t dims);

#endif
