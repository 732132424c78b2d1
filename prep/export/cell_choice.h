/* cell_choice.h - what to read of a file of meshes or of other cells in order to export it.
 */
#ifndef PREP_EXPORT_CELL_CHOICE_H
#define PREP_EXPORT_CELL_CHOICE_H

#include <stdbool.h>

#include "formats/leaf/leaf_file.h"

/* `count` sets of values, all of one step. */
typedef struct cell_choice {
    leaf_file *f;
    const uint32_t *fields;
    uint32_t count;
    uint32_t step;
    bool gradients; /* of the first field, if the file has them */
} cell_choice;

#endif
