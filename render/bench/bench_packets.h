/* bench_packets.h - what larger packets save in a mesh: W07 table 4. */
#ifndef RENDER_BENCH_BENCH_PACKETS_H
#define RENDER_BENCH_BENCH_PACKETS_H

#include "render/bench/bench_suite.h"

/* bench_packets() - the standard view by tiles and by packets of 2, 4, 8 and 16 rays on a side
 * (mesh_packet.h): the counts of W07's table in millions, and how many times as many those of 2 x 2
 * are; time. ST_UNSUPPORTED where a CPU has no vectors, ST_USAGE for a grid. */
CHECKED status bench_packets(bench_job *job);

/* bench_isopolygons() - the same picture with isopolygons made on the fly, precomputed, cached (W07
 * 4.4), by tiles and by packets of 16 x 16: time, also with another isovalue every frame, bytes. */
CHECKED status bench_isopolygons(bench_job *job);

#endif
