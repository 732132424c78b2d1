/* bench_hex_errors.h - how far hits of the experiments' march (hex_march.h) are from the exact
 * ones: distances in mean edges of the cell, angles between normals in degrees. */
#ifndef RENDER_BENCH_BENCH_HEX_ERRORS_H
#define RENDER_BENCH_BENCH_HEX_ERRORS_H

#include "render/bench/bench_table.h"
#include "render/experiments/hex_march.h"
#include "render/leafcast.h"

enum { BENCH_HEX_DISTANCE, BENCH_HEX_COLUMNS, BENCH_HEX_INVERSE, BENCH_HEX_LISTS };

typedef struct bench_hex_list {
    double *error;
    size_t count, room;
} bench_hex_list;

typedef struct bench_hex_errors {
    mem *m;
    uint64_t hits, missed, made_up;       /* rays; with a hit here, there alone, here alone */
    bench_hex_list list[BENCH_HEX_LISTS]; /* where both hit; normals by each hex_normals */
} bench_hex_errors;

void bench_hex_errors_init(bench_hex_errors *e, mem *m);
void bench_hex_errors_free(bench_hex_errors *e);

/* bench_hex_errors_add() - a ray's. To be called for all rays with HEX_NORMALS_COLUMNS, then for
 * all with HEX_NORMALS_INVERSE, which adds the normals' errors alone. */
CHECKED status bench_hex_errors_add(bench_hex_errors *e, const hex_lattice *l, hex_normals how,
                                    const leafcast_ray_hit *exact, const hex_surface *found);

/* bench_hex_errors_row() - a row's end, "-" if there are none. Sorts the lists. */
#define BENCH_HEX_ERROR_HEADINGS                                                         \
    "missed|false|t mean|t 99 %|t worst|angle mean|angle 99 %|angle worst|inverse mean|" \
    "inverse 99 %"
void bench_hex_errors_row(bench_hex_errors *e, bool any, bench_table *table);

#endif
