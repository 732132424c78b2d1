/* tet_bench.h - one thread's treelet of a mesh: read, checked, with pointers to its parts.
 */
#ifndef PREP_EXPORT_TET_BENCH_H
#define PREP_EXPORT_TET_BENCH_H

#include "formats/leaf/leaf_unpacker.h"
#include "formats/mesh/mesh_leaf.h"
#include "prep/export/cell_choice.h"

typedef struct tet_bench {
    const cell_choice *choice;
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
uint64_t tet_bench_bytes(const cell_choice *c);

/* tet_bench_create() - choice must outlive b. Release b in any case. */
CHECKED status tet_bench_create(mem *m, const cell_choice *c, tet_bench *b);
void tet_bench_release(tet_bench *b);

/* tet_bench_load() - read treelet t. */
CHECKED status tet_bench_load(tet_bench *b, uint32_t t);

/* tet_bench_sign() - orientation of a tet: 1, -1, or 0 if it is flat. */
int tet_bench_sign(const tet_bench *b, uint32_t tet);

#endif
