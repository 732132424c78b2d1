/* curvilinear_cell.h - what a histogram (formats/leaf/histogram.h) measures at a cell of a
 * curvilinear grid. Pure. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_CELL_H
#define FORMATS_CURVILINEAR_CURVILINEAR_CELL_H

#include "formats/leaf/histogram.h"

/* curvilinear_cell_none() - a node where no cell begins. Its value may be NaN or inf. */
histogram_cell curvilinear_cell_none(float value);

/* curvilinear_cell_measure() - the cell of eight corners, bit 0 of their index along i, bit 1 along
 * j, bit 2 along k. Its value is that of corner 0, its slope that at the middle, its volume the
 * Jacobian there. */
histogram_cell curvilinear_cell_measure(const float *const corners[8], const float values[8]);

#endif
