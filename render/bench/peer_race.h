/* peer_race.h - the same volume, camera, isovalue, picture and threads: leafcast and its peers, in
 * turn, run after run. */
#ifndef RENDER_BENCH_PEER_RACE_H
#define RENDER_BENCH_PEER_RACE_H

#include "formats/base/cpu.h"
#include "formats/base/progress.h"
#include "render/app/view_options.h"
#include "render/bench/bench_table.h"
#include "render/bench/peer_picture.h"

typedef struct peer_race_options {
    const char *path;
    const view_options *view; /* checked by peer_race_check() */
    double step;              /* between the isovalues of successive frames */
    int threads, runs;
    cpu_isa isa;         /* of ours, and of Embree; CPU_SCALAR: the best of each */
    size_t memory;       /* of ours, as leafcast_options */
    const char *picture; /* NULL: none */
    bool force;
    const progress *progress;
} peer_race_options;

/* What was left out, and why; empty where nothing was. */
typedef struct peer_race_missing {
    char embree[256], vtk[256];
} peer_race_missing;

extern const char peer_race_headings[];

/* peer_race_check() - ST_USAGE for what a mesh ray tracer would not be asked: several surfaces,
 * shadows of transparent ones, highlights, clipping, levels of detail. */
CHECKED status peer_race_check(view_options *view);

/* peer_race_run() - adds a row a contestant. A peer that is not there is left out, and *missing
 * says so. */
CHECKED status peer_race_run(mem *m, const peer_race_options *o, bench_table *t,
                             peer_race_missing *missing);

#endif
