/* mixed_resident.h - the row of resident.h for mixed meshes: a treelet's cells, nodes and values in
 * blocks.
 */
#ifndef STREAM_MIXED_RESIDENT_H
#define STREAM_MIXED_RESIDENT_H

#include "stream/hex_resident.h"
#include "stream/mixed_blocks.h"

typedef struct resident_mixed {
    resident_hexes hexes;
    mixed_blocks blocks;
} resident_mixed;

static inline const resident_mixed *resident_mixed_of(const treelet *tr) {
    return (const resident_mixed *)tr;
}

extern const resident_kind mixed_resident;

#endif
