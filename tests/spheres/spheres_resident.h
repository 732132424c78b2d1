/* spheres_resident.h - the row of spheres in memory: a treelet's balls, and which of them have a
 * surface.
 */
#ifndef TESTS_SPHERES_SPHERES_RESIDENT_H
#define TESTS_SPHERES_SPHERES_RESIDENT_H

#include "stream/resident.h"
#include "tests/spheres/spheres.h"

typedef struct spheres_treelet {
    treelet head;
    uint32_t count;
    uint64_t first;        /* number of its first ball in the whole file */
    const sphere *spheres; /* the payload */
    uint8_t active[];      /* a ball: 1: it may hold what is asked for */
} spheres_treelet;

static inline const spheres_treelet *spheres_treelet_of(const treelet *tr) {
    return (const spheres_treelet *)tr;
}

extern const resident_kind spheres_resident;

#endif
