/* moving_resident.h - the row of resident.h for a moving surface: nothing is read, and another step
 * has other pointers. */
#ifndef STREAM_MOVING_RESIDENT_H
#define STREAM_MOVING_RESIDENT_H

#include "stream/resident.h"

extern const resident_kind moving_resident;

#endif
