/* mesh_resident.h - a mesh's treelet in memory: its topology, and on it the values and positions of
 * one set.
 *
 * Two ways to another time step, which give the same bits (W07 6):
 *
 *   trees   each step's codes and boxes are read with its vertices; what was read stays, beside
 *           that of other steps
 *   refit   vertices alone are read, over those of the step before; codes and boxes are made anew
 *           (mesh_refit.h), and the payload that comes out must have the checksum that the file has
 *           for it. Of a compressed payload all is read, which is little.
 */
#ifndef STREAM_MESH_RESIDENT_H
#define STREAM_MESH_RESIDENT_H

#include "stream/resident.h"

extern const resident_kind mesh_resident;

#endif
