/* bench_compression.h - the suite "compression": how small files are, and what that costs. */
#ifndef RENDER_BENCH_BENCH_COMPRESSION_H
#define RENDER_BENCH_BENCH_COMPRESSION_H

#include "render/bench/bench_suite.h"

/* Sizes beside zstd -3 of the samples and the entropy of what is stored; payloads loaded by one
 * thread; first pictures of the raw and of the compressed file, warm and cold. One row a volume. */
CHECKED status bench_compression(bench_job *job);

extern const char bench_compression_headings[];

#endif
