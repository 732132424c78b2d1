/* mesh_sort.h - sorts tets by their place along the Morton curve, in memory, with many threads.
 *
 * It is stable: records of the same key keep their order. So the result does not depend on the
 * threads.
 */
#ifndef PREP_MESH_MESH_SORT_H
#define PREP_MESH_MESH_SORT_H

#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/pool.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"

/* A tet before it is in a treelet. */
typedef struct mesh_record {
    uint64_t key;
    uint32_t id[4]; /* its vertices, numbered as in the input */
} mesh_record;

/* A triangle has its last vertex twice. Of cells of all shapes, a record has the number in the
 * input instead. */
static inline void mesh_record_number(mesh_record *r, uint64_t number) {
    r->id[0] = (uint32_t)number;
    r->id[1] = (uint32_t)(number >> 32);
    r->id[2] = r->id[3] = 0;
}
static inline uint64_t mesh_record_cell(const mesh_record *r) {
    return r->id[0] | (uint64_t)r->id[1] << 32;
}

typedef struct mesh_sort mesh_sort;

/* mesh_sort_memory() - bytes of a sort besides the records. mesh_sort_create() - p must outlive it.
 */
uint64_t mesh_sort_memory(int threads);
CHECKED status mesh_sort_create(mem *m, pool *p, mesh_sort **out);
void mesh_sort_destroy(mesh_sort *s); /* NULL is fine */

/* mesh_sort_stop_by() - ask p now and then whether to go on; kept by reference. */
void mesh_sort_stop_by(mesh_sort *s, const progress *p);

/* mesh_sort_records() - sort `records` by key. spare: room for as many. */
CHECKED status mesh_sort_records(mesh_sort *s, mesh_record *records, mesh_record *spare,
                                 size_t count);

#endif
