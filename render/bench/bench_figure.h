/* bench_figure.h - M08's figure 4.9: two surfaces in one cell, as intersectors see them. */
#ifndef RENDER_BENCH_BENCH_FIGURE_H
#define RENDER_BENCH_BENCH_FIGURE_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct bench_figure {
    uint64_t rays;        /* that visit the cell */
    uint64_t left, right; /* surfaces seen by the approximate method, by the exact one */
} bench_figure;

/* bench_figure_draw() - one picture of 2 side x side pixels: on the left by Neubauer's repeated
 * interpolation, which leaves a hole where a ray comes out on the side it went in, on the right by
 * marmitt. */
CHECKED status bench_figure_draw(mem *m, const char *path, bool force, uint32_t side,
                                 bench_figure *result);

#endif
