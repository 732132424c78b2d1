/* cells_file.h - treelet files of records (leaf_cells.h), in memory. */
#ifndef TESTS_SUPPORT_CELLS_FILE_H
#define TESTS_SUPPORT_CELLS_FILE_H

#include "formats/leaf/leaf_cells.h"
#include "tests/support/leaf_image.h"

typedef struct cells_input {
    uint32_t kind; /* the number of its row, which names the record */
    const char *name;
    const void *records;    /* of all treelets, one after another, step after step */
    const uint32_t *counts; /* per treelet */
    uint32_t treelets, steps;
} cells_input;

/* cells_file() - a sound treelet file; free() its bytes. */
leaf_image cells_file(const cells_input *in);

#endif
