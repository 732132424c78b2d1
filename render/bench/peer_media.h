/* peer_media.h - the same volume, transfer function, camera, pixels and threads: leafcast's
 * certified media and VTK's fixed-point ray caster, in turn, run after run. */
#ifndef RENDER_BENCH_PEER_MEDIA_H
#define RENDER_BENCH_PEER_MEDIA_H

#include "render/bench/peer_race.h"

extern const char peer_media_headings[];

/* peer_media_run() - adds rows for a transfer function (bench_media_transfer()): ours for errors
 * from 1 on, VTK's for samples every cell, half and quarter of one, on the file's own type and on
 * floats. Errors are from a picture of ours that is certified to 1e-6. `x ours`, of VTK's rows: how
 * many times the least time in which one of ours is no further off, by the worst error, and by the
 * 99 % quantile: VTK leaves out a rim of the volume's outline, about a pixel wide. `opacity off`:
 * how far an opacity of a cell may be from ours, for VTK's are linear between points, of which it
 * is given thousands; ours are 1 - exp(-k) of a k that is. Without VTK its rows are left out, and
 * *missing says so: also for a grid that is no box of equal cells. */
CHECKED status peer_media_run(mem *m, const peer_race_options *o, const char *transfer,
                              bench_table *t, peer_race_missing *missing);

#endif
