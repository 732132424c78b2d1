/* grid_resident.h - a grid's treelet in memory: its samples, and the masks of its active cells. */
#ifndef STREAM_GRID_RESIDENT_H
#define STREAM_GRID_RESIDENT_H

#include "stream/resident.h"

extern const resident_kind grid_resident;

#endif
