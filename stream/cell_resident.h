/* cell_resident.h - the row of resident.h for kinds whose cells are records (leaf_cells.h): a
 * treelet's records, checked, and a tree over their boxes.
 */
#ifndef STREAM_CELL_RESIDENT_H
#define STREAM_CELL_RESIDENT_H

#include "stream/resident.h"

typedef struct resident_cells {
    treelet head; /* its payload: the records */
    uint32_t count, record_bytes;
    uint64_t first;    /* number of its first cell in the whole file */
    treelet_tree tree; /* over the cells' boxes; active: those that the interest meets */
    float (*ranges)[2];
} resident_cells;

static inline const resident_cells *resident_cells_of(const treelet *tr) {
    return (const resident_cells *)tr;
}

extern const resident_kind cell_resident;

#endif
