/* triangle_resident.h - the row of resident.h for surfaces: a treelet's triangles, vertices and
 * values in blocks.
 */
#ifndef STREAM_TRIANGLE_RESIDENT_H
#define STREAM_TRIANGLE_RESIDENT_H

#include "stream/hex_resident.h"
#include "stream/triangle_blocks.h"

typedef struct resident_triangles {
    resident_hexes hexes;
    triangle_blocks blocks;
} resident_triangles;

static inline const resident_triangles *resident_triangles_of(const treelet *tr) {
    return (const resident_triangles *)tr;
}

extern const resident_kind triangle_resident;

#endif
