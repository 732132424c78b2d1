/* mesh_keys.h - turns tets of the input into records with keys, by many threads, keeping their
 * order.
 *
 * Tets with an id that is no point, and tets with a vertex twice, are left out and counted.
 */
#ifndef PREP_MESH_MESH_KEYS_H
#define PREP_MESH_MESH_KEYS_H

#include <stdint.h>

#include "formats/base/pool.h"
#include "formats/base/progress.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_runs.h"

typedef struct mesh_keys_report {
    uint64_t tets;          /* tets kept */
    uint64_t vertices;      /* vertices of the kept tets, each counted once */
    uint64_t repeated, bad; /* tets left out: with a vertex twice; with an invalid id */
    uint64_t non_finite;    /* values of these vertices that are NaN or inf, over all sets */
} mesh_keys_report;

/* mesh_keys_memory() - bytes it takes besides the windows on the points. */
uint64_t mesh_keys_memory(uint64_t points, int threads);

/* mesh_keys_make() - fill r with the tets of g, which must be complete; g's tets are freed on the
 * way. window: bytes of each thread's window on the points. Reports progress from `from` to
 * `to`. */
CHECKED status mesh_keys_make(mem *m, pool *workers, mesh_gather *g, uint64_t window, mesh_runs *r,
                              double from, double to, mesh_keys_report *report);

#endif
