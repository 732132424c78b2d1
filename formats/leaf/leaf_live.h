/* leaf_live.h - a grid's treelet file that never was one: its samples are in memory, and change.
 *
 * It looks like a file that conversion made with `--levels 1`, whose samples lie outside, at two
 * steps: one for each buffer of live_samples.h. The directory of a step is made anew when its
 * buffer is finished, in memory alone. Of checksums it has stamps (live_samples_stamp()): where two
 * steps have the same, so are the samples; and leaf_file.versions says how often a step has been
 * made.
 *
 * One writer at a time, of a step that nobody reads.
 */
#ifndef FORMATS_LEAF_LEAF_LIVE_H
#define FORMATS_LEAF_LEAF_LIVE_H

#include "formats/grid/grid.h"
#include "formats/leaf/leaf_file.h"
#include "formats/leaf/live_samples.h"

/* leaf_live_open() - all samples are 0, at both steps, and times, too. g: of any of the first eight
 * sample types, checked (grid_check()); its axes are copied. isa, threads: that an update uses. */
CHECKED status leaf_live_open(mem *m, const grid *g, cpu_isa isa, int threads, leaf_file **out);

/* leaf_live_put() - live_samples_put() into the buffer of a step. leaf_live_finish() - finish it,
 * and make its directory. */
CHECKED status leaf_live_put(leaf_file *f, uint32_t step, const live_region *r);
CHECKED status leaf_live_finish(leaf_file *f, uint32_t step, double time);

#endif
