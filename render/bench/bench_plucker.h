/* bench_plucker.h - from tet to tet by Pluecker tests, beside going down the tree to each. */
#ifndef RENDER_BENCH_BENCH_PLUCKER_H
#define RENDER_BENCH_BENCH_PLUCKER_H

#include "render/bench/bench_suite.h"

/* bench_plucker() - M08 6.3.2, tables 6.1, 6.2 and 6.4: tests a tet, tets and rays a second, of
 * means (all tets on the way) and of a thin and an opaque medium. */
CHECKED status bench_plucker(bench_job *job);

#endif
