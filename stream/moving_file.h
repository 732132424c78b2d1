/* moving_file.h - the file that a moving surface looks like; for moving_surface.c. */
#ifndef STREAM_MOVING_FILE_H
#define STREAM_MOVING_FILE_H

#include "stream/moving_surface.h"

/* moving_file_make() - make s->file, whose treelets, with their values, are there. On failure it is
 * there in part, or not. */
CHECKED status moving_file_make(moving_surface *s, const moving_source *src);

/* moving_file_set_bounds() - the box of a treelet at a step. moving_file_merge_bounds() - make the
 * one of all, when a step has all of them: it has changed then. Returns that. */
void moving_file_set_bounds(const leaf_file *f, uint32_t step, uint32_t t, const float box[6]);
const float *moving_file_merge_bounds(const leaf_file *f, uint32_t step);

#endif
