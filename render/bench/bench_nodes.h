/* bench_nodes.h - what a node of the min/max tree costs, and what looser ranges cost: M08 tables
 * 4.2, 4.3 and 4.4. */
#ifndef RENDER_BENCH_BENCH_NODES_H
#define RENDER_BENCH_BENCH_NODES_H

#include "render/bench/bench_suite.h"

/* bench_nodes() - one tree over a volume's full resolution, its ranges kept in several ways
 * (bench_tree.h), and the standard view drawn through each by single rays: bytes, steps, time.
 * Deviations from M08: three splits make one step, as in walk.h, so that a tree has one node where
 * a binary one has seven; trees end at blocks of 2^3 cells (as M08's without leaves) or of 4^3 (as
 * treelet files); below, cells are found by their corners. ST_FAILED when two of them draw another
 * picture. */
CHECKED status bench_nodes(bench_job *job);

#endif
