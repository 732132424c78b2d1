/* curvilinear_draw.h - which cells of a treelet of a curvilinear grid a histogram draws
 * (histogram_draw.h).
 */
#ifndef FORMATS_LEAF_CURVILINEAR_DRAW_H
#define FORMATS_LEAF_CURVILINEAR_DRAW_H

#include "formats/leaf/histogram_draw.h"

typedef struct curvilinear_draw {
    const histogram_run *runs;
    uint64_t first, end; /* numbers of the treelet's cells */
    const uint32_t *cells;
    uint64_t next; /* run */
    /* The cell that is drawn: */
    uint32_t run;      /* from this one */
    uint32_t place[3]; /* in the treelet */
    uint32_t node;     /* its first corner there */
} curvilinear_draw;

/* curvilinear_draw_begin() - before the first one. first: number of the treelet's first cell.
 * cells: along i, j, k. Both and runs are kept by reference. curvilinear_draw_next() - go on to the
 * next; false: there is none. */
void curvilinear_draw_begin(curvilinear_draw *d, const histogram_run *runs, uint64_t first,
                            const uint32_t cells[3]);
bool curvilinear_draw_next(curvilinear_draw *d);

#endif
