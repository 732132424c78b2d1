/* tet_bench.h - one thread's treelet of a mesh: read, checked, its parts at hand.
 */
#ifndef PREP_EXPORT_TET_BENCH_H
#define PREP_EXPORT_TET_BENCH_H

#include <stdbool.h>

#include "formats/leaf/leaf_file.h"
#include "formats/mesh/mesh_leaf.h"

/* What of a mesh: `count` sets of values, all of one step. */
typedef struct tet_choice {
    leaf_file *f;
    const uint32_t *fields;
    uint32_t count;
    uint32_t step;
    bool gradients; /* of the first field, where the file has them */
} tet_choice;

typedef struct tet_bench {
    const tet_choice *choice;
    mem *m;
    char *stored, *topology, *moved, *gradients, *values; /* values: one after the other */
    mesh_shape shape;
    const uint16_t (*tets)[4];
    const float (*at)[3];       /* of vertices, at the step */
    const float **value;        /* [count][vertices] */
    const float (*gradient)[3]; /* NULL: the file has none, or they were not asked for */
} tet_bench;

/* tet_bench_bytes() - what one takes. */
uint64_t tet_bench_bytes(const tet_choice *c);

/* tet_bench_create() - choice must outlive it; release it in any case. */
CHECKED status tet_bench_create(mem *m, const tet_choice *c, tet_bench *b);
void tet_bench_release(tet_bench *b);

/* tet_bench_load() - treelet t. */
CHECKED status tet_bench_load(tet_bench *b, uint32_t t);

/* tet_bench_sign() - how a tet is turned: 1, -1, or 0 where it is flat. */
int tet_bench_sign(const tet_bench *b, uint32_t tet);

#endif
