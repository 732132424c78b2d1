/* bench_dynamic.h - the suite "dynamic": triangles that move, by a tree of boxes, which is what
 * leafcast_update_vertices() refits, and by M08's bounded kd-tree (M08 5.3, tables 5.8, 5.9). */
#ifndef RENDER_BENCH_BENCH_DYNAMIC_H
#define RENDER_BENCH_BENCH_DYNAMIC_H

#include "render/bench/bench_suite.h"

/* Of each scene three states: as built, moved away from that without building anew, and built anew
 * in that place; a row for each tree. All rays are held against those of the boxes built anew. */
CHECKED status bench_dynamic(bench_job *job);

extern const char bench_dynamic_headings[];

#endif
