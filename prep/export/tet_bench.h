/* tet_bench.h - one thread's treelet of a mesh: read, checked, with pointers to its parts.
 */
#ifndef PREP_EXPORT_TET_BENCH_H
#define PREP_EXPORT_TET_BENCH_H

#include <stdbool.h>

#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf.h"

/* What to read of a mesh: `count` sets of values, all of one step. */
typedef struct tet_choice {
    leaf_file *f;
    const uint32_t *fields;
    uint32_t count;
    uint32_t step;
    bool gradients; /* of the first field, if the file has them */
} tet_choice;

typedef struct tet_bench {
    const tet_choice *choice;
    mem *m;
    leaf_unpacker *unpacker;
    char *topology, *moved, *gradients, *values; /* values: of one field after the other */
    mesh_shape shape;
    const uint16_t (*tets)[4];
    const float (*at)[3];       /* vertices at the step */
    const float **value;        /* [count][vertices] */
    const float (*gradient)[3]; /* NULL: not in the file, or not asked for */
} tet_bench;

/* tet_bench_bytes() - bytes that one bench takes. */
uint64_t tet_bench_bytes(const tet_choice *c);

/* tet_bench_create() - choice must outlive b. Release b in any case. */
CHECKED status tet_bench_create(mem *m, const tet_choice *c, tet_bench *b);
void tet_bench_release(tet_bench *b);

/* tet_bench_load() - read treelet t. */
CHECKED status tet_bench_load(tet_bench *b, uint32_t t);

/* tet_bench_sign() - orientation of a tet: 1, -1, or 0 if it is flat. */
int tet_bench_sign(const tet_bench *b, uint32_t tet);

#endif
