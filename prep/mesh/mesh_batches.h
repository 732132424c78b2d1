/* mesh_batches.h - goes through the sorted tets, a batch of treelets after the other.
 *
 * The cuts between treelets depend on the tets alone. A pass begins with mesh_batches_rewind().
 */
#ifndef PREP_MESH_MESH_BATCHES_H
#define PREP_MESH_MESH_BATCHES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/state_io.h"
#include "prep/mesh/mesh_runs.h"

typedef struct mesh_batches {
    /* The current batch. Treelet i of it has the records [first[i], first[i + 1]);
     * first[0] is 0. */
    const mesh_record *records; /* valid until the next one */
    size_t *first;
    size_t count;
    uint32_t treelet; /* index of its first treelet */
    uint64_t tet;     /* number of its first tet */
    /* What it is made from: */
    mem *m;
    mesh_runs *runs;
    uint64_t tets;         /* all */
    uint32_t treelet_tets; /* at most so many per treelet */
    size_t most;           /* treelets per batch */
    uint64_t before;       /* key of the last tet */
    size_t used;           /* records of the window up to the batch's end */
    uint64_t vertices;     /* check each record, with ids below this; 0: do not */
    uint32_t corners;      /* the first so many of its ids are different then */
    uint64_t cells;        /* check each record, with numbers of cells below this; 0: do not */
} mesh_batches;

/* mesh_batches_init() - runs: all have been put, and it is at its first record; tets: the number of
 * its records. most: treelets per batch. */
CHECKED status mesh_batches_init(mesh_batches *b, mem *m, mesh_runs *runs, uint64_t tets,
                                 uint32_t treelet_tets, size_t most);
void mesh_batches_release(mesh_batches *b); /* a zeroed struct is fine */

/* mesh_batches_doubt() - the records are in a file that another run has left: from now on, check
 * that they are of tets, or triangles, with different vertices, in order. vertices: ids are below
 * this; corners: of each.
 * mesh_batches_fault() - ST_CORRUPT: they are not. */
void mesh_batches_doubt(mesh_batches *b, uint64_t vertices, uint32_t corners);
void mesh_batches_doubt_cells(mesh_batches *b, uint64_t cells);
status mesh_batches_fault(void);

/* mesh_batches_rewind() - begin a pass.
 * mesh_batches_more() - whether there is another batch. mesh_batches_next() - go on to it.
 * mesh_batches_end() - the number of treelets up to this batch's end. */
CHECKED status mesh_batches_rewind(mesh_batches *b);
bool mesh_batches_more(const mesh_batches *b);
CHECKED status mesh_batches_next(mesh_batches *b);
uint64_t mesh_batches_end(const mesh_batches *b);

/* mesh_batches_keep() - save the place behind the current batch, or load it. ST_CORRUPT: it is not
 * one in these tets. */
CHECKED status mesh_batches_keep(mesh_batches *b, state_io *io);

#endif
