/* id_map.h - numbers that a file chooses freely (of nodes, of elements) to indices 0, 1, 2, ..
 *
 * Kept as runs of consecutive numbers: the usual file needs a few, one in random order 24 bytes a
 * number.
 */
#ifndef FORMATS_BASE_ID_MAP_H
#define FORMATS_BASE_ID_MAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct id_run {
    uint64_t id, index, count;
} id_run;

/* Start with {.m = budget}. */
typedef struct id_map {
    mem *m;
    id_run *runs; /* sealed: ascending by id */
    size_t count, room;
    uint64_t ids;
    size_t last; /* the run that was found last */
} id_map;

/* id_map_add() - the next index is its. */
CHECKED status id_map_add(id_map *map, uint64_t id);

/* id_map_seal() - behind the last id_map_add(): whether every number is there once; *twice is one
 * that is not. */
bool id_map_seal(id_map *map, uint64_t *twice);

/* id_map_find() - the index of a number in a sealed map; UINT64_MAX when it is not there. */
uint64_t id_map_find(id_map *map, uint64_t id);

void id_map_release(id_map *map);

#endif
