/* mixed_resident.h - the row of resident.h for mixed meshes: a treelet's cells, nodes and values,
 * checked, in blocks.
 */
#ifndef STREAM_MIXED_RESIDENT_H
#define STREAM_MIXED_RESIDENT_H

#include "stream/mixed_blocks.h"
#include "stream/resident.h"

typedef struct resident_mixed {
    treelet head;      /* its payload: the topology */
    const void *moved; /* places of a later step; NULL: those of the topology are its */
    const void *values;
    mixed_blocks blocks;
} resident_mixed;

static inline const resident_mixed *resident_mixed_of(const treelet *tr) {
    return (const resident_mixed *)tr;
}

extern const resident_kind mixed_resident;

#endif
