/* id_map.h - maps numbers that a file chooses freely (of nodes, of elements) to indices 0, 1, 2, ..
 *
 * They are kept as runs of consecutive numbers. The usual file needs a few runs; one in random
 * order needs 24 bytes a number.
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
    id_run *runs; /* ascending by id once sealed */
    size_t count, room;
    uint64_t ids;
    size_t last; /* the run that was found last */
} id_map;

/* id_map_add() - give a number the next index. */
CHECKED status id_map_add(id_map *map, uint64_t id);

/* id_map_seal() - call it after the last id_map_add(). Returns whether no number occurs twice; if
 * one does, *twice is such a number. */
bool id_map_seal(id_map *map, uint64_t *twice);

/* id_map_find() - the index of a number in a sealed map; UINT64_MAX when it is not there. */
uint64_t id_map_find(id_map *map, uint64_t id);

void id_map_release(id_map *map);

#endif
