/* bench_hexes.h - M08's ways from cell to cell through curvilinear grids, beside the exact cells,
 * in speed and in error. */
#ifndef RENDER_BENCH_BENCH_HEXES_H
#define RENDER_BENCH_BENCH_HEXES_H

#include "render/bench/bench_suite.h"

/* bench_hexes() - M08 6.4 and 6.5, tables 6.5 to 6.7 and 6.10: by Pluecker tests, and by these and
 * bilinear patches: what is passed a second, what is drawn of it, and how far isosurfaces are from
 * the exact ones. Four views: along the axes, and the one of the flags. */
CHECKED status bench_hexes(bench_job *job);

#endif
