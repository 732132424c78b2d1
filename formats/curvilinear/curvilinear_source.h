/* curvilinear_source.h - a curvilinear grid as readers hand it over: runs of planes of its zones.
 *
 * A zone is a block of nodes in rows: node (i, j, k) of nodes[0] x nodes[1] x nodes[2] is number
 * i + nodes[0] (j + nodes[1] k), and lies anywhere in space. Zones that touch have the same nodes
 * on their common faces, each its own copy.
 */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_SOURCE_H
#define FORMATS_CURVILINEAR_CURVILINEAR_SOURCE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

enum { CURVILINEAR_NODE = 1, CURVILINEAR_HIDDEN = 2 };

typedef struct curvilinear_source {
    void *own; /* the reader's */
    uint32_t zones;
    const uint32_t (*nodes)[3]; /* per zone: along i, j, k; 2 or more */
    bool blanked;               /* blanks() tells something; else it is not called */
    uint32_t fields;            /* that values() can tell: those that were asked for, in order */
    /* Read planes first to first + count - 1 along k of a zone. places(): x, y, z of each node,
     * finite. values(): of a field; NaN stands for those that are missing. blanks(): 0: the node is
     * no part of the grid, nor is any cell at it; CURVILINEAR_NODE; or CURVILINEAR_NODE |
     * CURVILINEAR_HIDDEN: it is, but the cell from it on to (i + 1, j + 1, k + 1) is not. Readers
     * may be quick only where each of the three goes through its planes and zones once, in rising
     * order. One thread at a time. */
    status (*places)(void *own, uint32_t zone, uint32_t first, uint32_t count, float (*p)[3]);
    status (*values)(void *own, uint32_t zone, uint32_t field, uint32_t first, uint32_t count,
                     float *values);
    status (*blanks)(void *own, uint32_t zone, uint32_t first, uint32_t count, uint8_t *is_node);
} curvilinear_source;

#endif
