/* curvilinear_file.h - treelet files of curvilinear grids, in memory. */
#ifndef TESTS_SUPPORT_CURVILINEAR_FILE_H
#define TESTS_SUPPORT_CURVILINEAR_FILE_H

#include "formats/leaf/curvilinear_geometry.h"
#include "tests/support/leaf_image.h"

typedef struct curvilinear_zone {
    uint32_t nodes[3];
    const float (*p)[3]; /* i fastest */
    const float *values;
    const uint8_t *blank; /* per node, 0: blanked; 3: the cell there is hidden; NULL: neither is */
} curvilinear_zone;

/* curvilinear_file() - a sound treelet file; free() its bytes. A blanked node has the place and the
 * value that CURVILINEAR.md gives it. */
leaf_image curvilinear_file(const curvilinear_zone zones[], uint32_t count);

/* curvilinear_file_stands() - the node of a zone whose place node n has: the last one up to it that
 * is not blanked; else the first; 0 if all are. */
size_t curvilinear_file_stands(const curvilinear_zone *zone, size_t n);

#endif
