/* bench_isovalue.h - the suite "isovalues": what a new isovalue costs. */
#ifndef RENDER_BENCH_BENCH_ISOVALUE_H
#define RENDER_BENCH_BENCH_ISOVALUE_H

#include "render/bench/bench_suite.h"

/* Masks of active cells, us a treelet; frames with an isovalue that stays against frames each with
 * an isovalue of its own, selecting included. One row an ISA. */
CHECKED status bench_isovalue(bench_job *job);

extern const char bench_isovalue_headings[];

#endif
