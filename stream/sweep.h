/* sweep.h - one pass over the directory's ranges: which of them meet an interest. */
#ifndef STREAM_SWEEP_H
#define STREAM_SWEEP_H

#include "formats/leaf/leaf_file.h"
#include "stream/interest.h"

/* sweep_ranges() - set held[i] to whether range i meets the interest, 0 or 1. */
void sweep_ranges(const float (*ranges)[2], uint32_t count, const interest *in, uint8_t *held);

/* sweep_is_whole() - whether range i of the directory, of a grid's treelet, is taken whole.
 * sweep_whole() - move treelets of a grid's set that are taken whole from own[] to whole[]. */
bool sweep_is_whole(const leaf_file *f, size_t i, const homogeneous *in);
void sweep_whole(const leaf_file *f, uint32_t set, const homogeneous *in, uint8_t *own,
                 uint8_t *whole);

#endif
