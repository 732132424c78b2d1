/* spheres_file.h - treelet files of spheres, in memory. */
#ifndef TESTS_SPHERES_SPHERES_FILE_H
#define TESTS_SPHERES_SPHERES_FILE_H

#include "tests/spheres/spheres.h"
#include "tests/support/leaf_image.h"

/* spheres_file() - balls, counts[t] in treelet t, as a sound treelet file; free() its bytes. */
leaf_image spheres_file(const sphere spheres[], const uint32_t counts[], uint32_t treelets);

#endif
