/* convert_grids.h - grids as inputs of convert: a row of convert_main.c. */
#ifndef PREP_GRID_CONVERT_GRIDS_H
#define PREP_GRID_CONVERT_GRIDS_H

#include "prep/convert_kind.h"

extern const convert_kind convert_grids;

#endif
