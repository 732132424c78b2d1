/* bench_streaming.h - the suite "streaming": what a picture reads, and how long it takes while it
 * does. */
#ifndef RENDER_BENCH_BENCH_STREAMING_H
#define RENDER_BENCH_BENCH_STREAMING_H

#include "render/bench/bench_suite.h"

/* Each view of a volume, of its raw and of its compressed file, by the mapping and by the arena, in
 * turn. One row for each. */
CHECKED status bench_streaming(bench_job *job);

extern const char bench_streaming_headings[];

#endif
