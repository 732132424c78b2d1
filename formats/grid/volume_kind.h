/* volume_kind.h - grids as inputs: the row of input_open.c for all that volume.h reads. */
#ifndef FORMATS_GRID_VOLUME_KIND_H
#define FORMATS_GRID_VOLUME_KIND_H

#include "formats/input_kind.h"

extern const input_kind volume_kind; /* its own: a volume */

#endif
