/* mesh_sort.h - sort tets by their place along the Morton curve, in memory, with many threads.
 *
 * Stable: those of the same key stay in the order they came in. So the result is one, whatever the
 * threads.
 */
#ifndef PREP_MESH_MESH_SORT_H
#define PREP_MESH_MESH_SORT_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/status.h"

/* A tet on its way into a treelet. */
typedef struct mesh_record {
    uint64_t key;
    uint32_t id[4]; /* its vertices, as the input has them */
} mesh_record;

typedef struct mesh_sort mesh_sort;

/* mesh_sort_memory(), mesh_sort_create() - what a sort needs beside the records. p must outlive it.
 */
uint64_t mesh_sort_memory(int threads);
CHECKED status mesh_sort_create(mem *m, pool *p, mesh_sort **out);
void mesh_sort_destroy(mesh_sort *s); /* NULL is fine */

/* mesh_sort_records() - sorts `records` by key; spare: room for as many. */
CHECKED status mesh_sort_records(mesh_sort *s, mesh_record *records, mesh_record *spare,
                                 size_t count);

#endif
