/* mesh_keys.h - turns tets of the input into records with keys, by many threads, keeping their
 * order.
 *
 * Tets with an id that is no point, and tets with a vertex twice, are left out and counted.
 */
#ifndef PREP_MESH_MESH_KEYS_H
#define PREP_MESH_MESH_KEYS_H

#include <stdint.h>

#include "formats/base/pool.h"
#include "formats/base/state_io.h"
#include "prep/mesh/mesh_gather.h"
#include "prep/mesh/mesh_runs.h"

typedef struct mesh_keys_report {
    uint64_t tets;          /* tets kept */
    uint64_t vertices;      /* vertices of the kept tets, each counted once */
    uint64_t repeated, bad; /* tets left out: with a vertex twice; with an invalid id */
    uint64_t non_finite;    /* values of these vertices that are NaN or inf, over all sets */
} mesh_keys_report;

typedef struct mesh_keys mesh_keys;

/* mesh_keys_memory() - bytes it takes besides the windows on the points. */
uint64_t mesh_keys_memory(uint64_t points, uint32_t corners, int threads);

/* mesh_keys_create() - for the tets of g, which must be complete. window: bytes of each thread's
 * window on the points. */
CHECKED status mesh_keys_create(mem *m, pool *workers, mesh_gather *g, uint64_t window,
                                mesh_keys **out);
void mesh_keys_destroy(mesh_keys *k); /* NULL is fine */

/* mesh_keys_done() - the share of the tets that are done; 1: all are.
 * mesh_keys_next() - put records of some more tets into r, at most one run of it. Frees these tets.
 * mesh_keys_put() - the records that were put.
 * mesh_keys_end() - call it when all are done. */
double mesh_keys_done(const mesh_keys *k);
CHECKED status mesh_keys_next(mesh_keys *k, mesh_runs *r);
uint64_t mesh_keys_put(const mesh_keys *k);
CHECKED status mesh_keys_end(mesh_keys *k, mesh_keys_report *report);

/* mesh_keys_keep() - save or load what is done. ST_CORRUPT: what loads makes no sense. */
CHECKED status mesh_keys_keep(mesh_keys *k, state_io *io);

#endif
