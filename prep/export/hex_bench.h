/* hex_bench.h - one thread's treelet of hexahedra (formats/leaf/hex_treelet.h): read, checked.
 */
#ifndef PREP_EXPORT_HEX_BENCH_H
#define PREP_EXPORT_HEX_BENCH_H

#include "formats/leaf/hex_treelet.h"
#include "prep/export/cell_choice.h"

typedef struct hex_bench {
    const cell_choice *choice;
    mem *m;
    leaf_unpacker *unpacker;
    char *payloads;
    hex_treelet tr;
    const float **value; /* [count][nodes] */
} hex_bench;

/* hex_bench_bytes() - bytes that one bench takes. */
uint64_t hex_bench_bytes(const cell_choice *c);

/* hex_bench_create() - choice must outlive b. Release b in any case. */
CHECKED status hex_bench_create(mem *m, const cell_choice *c, hex_bench *b);
void hex_bench_release(hex_bench *b);

/* hex_bench_load() - read treelet t. */
CHECKED status hex_bench_load(hex_bench *b, uint32_t t);

/* hex_bench_keep() - of the nodes' values keep those of nodes `kept` (ascending; `count`), one
 * after the other. The treelet is not to be looked at any more. */
void hex_bench_keep(hex_bench *b, const uint32_t *kept, uint32_t count);

/* hex_bench_at() - where a node is. hex_bench_cell() - places of the nodes at a cell's corners.
 * hex_bench_sense() - 1: a cell's map is right-handed, -1: left-handed; a folded one as in its
 * middle. p: its places. */
void hex_bench_at(const hex_bench *b, uint32_t node, float at[3]);
void hex_bench_cell(const hex_bench *b, const uint32_t corner[HEX_CORNERS],
                    double p[HEX_CORNERS][3]);
int hex_bench_sense(const hex_bench *b, uint32_t cell, const double p[HEX_CORNERS][3]);

/* hex_bench_map() - where a cell's parameters lead: the point, and its derivatives by each. */
void hex_bench_map(const double p[HEX_CORNERS][3], const double u[3], double at[3],
                   double along[3][3]);

#endif
