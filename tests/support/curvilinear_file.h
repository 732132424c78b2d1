/* curvilinear_file.h - treelet files of curvilinear grids, in memory. */
#ifndef TESTS_SUPPORT_CURVILINEAR_FILE_H
#define TESTS_SUPPORT_CURVILINEAR_FILE_H

#include "formats/leaf/curvilinear_geometry.h"
#include "tests/support/leaf_image.h"

typedef struct curvilinear_zone {
    uint32_t nodes[3];
    const float (*p)[3]; /* i fastest */
    const float *values;
    const uint8_t *blank; /* per node, 0: blanked; NULL: none is */
} curvilinear_zone;

/* curvilinear_file() - a sound treelet file of the row of `kind`; free() its bytes. */
leaf_image curvilinear_file(uint32_t kind, const curvilinear_zone zones[], uint32_t count);

#endif
