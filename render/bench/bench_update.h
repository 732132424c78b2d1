/* bench_update.h - the suite "update": what a new time step of a grid costs beside rays, where M08
 * makes its trees anew (M08 tables 5.1, 5.2).
 */
#ifndef RENDER_BENCH_BENCH_UPDATE_H
#define RENDER_BENCH_BENCH_UPDATE_H

#include "render/bench/bench_suite.h"

/* One row for each interest (the isosurface; all values, as of a medium) and number of threads, to
 * job->threads: treelets that hold it, those that are not the same as in the step before, and what
 * loading these and making their masks takes. Masks are held against those of the step alone. */
CHECKED status bench_update(bench_job *job);

extern const char bench_update_headings[];

#endif
