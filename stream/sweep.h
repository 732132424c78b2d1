/* sweep.h - the directory's ranges beside an interest: one pass over them. */
#ifndef STREAM_SWEEP_H
#define STREAM_SWEEP_H

#include "formats/leaf/leaf_file.h"
#include "stream/interest.h"

/* sweep_ranges() - of each range whether it meets the interest: held[] is 0 or 1. */
void sweep_ranges(const float (*ranges)[2], uint32_t count, const interest *in, uint8_t *held);

/* sweep_whole() - which treelets of a set of a grid, of those in own[], are taken whole: they go
 * from there to whole[]. */
void sweep_whole(const leaf_file *f, uint32_t set, const homogeneous *in, uint8_t *own,
                 uint8_t *whole);

#endif
