/* bench_media.h - the suite "media": time against error of media, certified and by the ways that
 * exist to be compared with. */
#ifndef RENDER_BENCH_BENCH_MEDIA_H
#define RENDER_BENCH_BENCH_MEDIA_H

#include "render/bench/bench_suite.h"

/* A row for each volume, transfer function and way: its time, and how far its picture is from the
 * reference, which is certified to 1e-6 and says itself by how much it may be off ("ref bound"):
 *
 *   worst, 99 %, rms   over all pixels and channels
 *   > 1/510 %          of the pixels, those with a channel that is further off than half a step of
 *                      8 bits
 *   speed-up           over the most accurate row that is certified (M08 table 4.9)
 *   steps/this, ...    of certified rows: how many times as long steps take to come as near (by
 *                      their worst error), between the two steps that are there; at least what the
 *                      coarsest take where they come nearer
 *
 * One thread, medians of CPU time, all in turn. */
CHECKED status bench_media(bench_job *job);

/* bench_media_transfer() - a transfer function by name, into an empty list: opaque or thin (--tf
 * auto, ten times or a tenth of its extinction), positive (some extinction at every value), or as
 * --tf has it. ST_USAGE. */
CHECKED status bench_media_transfer(const char *name, const leafcast *volume, transfer_list *out);

/* How far a picture of so many numbers is off. bench_media_judge() sorts offs[], room for them. */
typedef struct bench_media_error {
    double worst, p99, rms, share; /* share: of the pixels (4 numbers each), beyond 1/510 */
} bench_media_error;
bench_media_error bench_media_judge(const double *rgba, const double *truth, size_t pixels,
                                    double *offs);

#endif
