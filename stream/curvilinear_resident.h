/* curvilinear_resident.h - the row of resident.h for curvilinear grids: a treelet's nodes and
 * values as a lattice.
 */
#ifndef STREAM_CURVILINEAR_RESIDENT_H
#define STREAM_CURVILINEAR_RESIDENT_H

#include "stream/curvilinear_lattice.h"
#include "stream/hex_resident.h"

typedef struct resident_curvilinear {
    resident_hexes hexes;
    curvilinear_lattice lattice;
} resident_curvilinear;

static inline const resident_curvilinear *resident_curvilinear_of(const treelet *tr) {
    return (const resident_curvilinear *)tr;
}

extern const resident_kind curvilinear_resident;

#endif
