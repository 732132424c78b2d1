/* export_grid.h - how the verb export writes grids: a row of export_main.c. */
#ifndef PREP_EXPORT_EXPORT_GRID_H
#define PREP_EXPORT_EXPORT_GRID_H

#include "prep/export/export_kind.h"

extern const export_kind export_grid, export_heights;

#endif
