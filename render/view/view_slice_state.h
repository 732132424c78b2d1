/* view_slice_state.h - read a page's description of a slice as flags of `leafcast slice`. */
#ifndef RENDER_VIEW_VIEW_SLICE_STATE_H
#define RENDER_VIEW_VIEW_SLICE_STATE_H

#include <jansson.h>

#include "render/app/slice_request.h"

/* view_slice_state_apply() - set *r, which need not be initialised, from an object whose keys are
 * flags of `leafcast slice` without their dashes. *r owns no memory yet. ST_USAGE: unknown keys,
 * wrong values, names of files, curved slices, and --size, which follows from the pane. */
CHECKED status view_slice_state_apply(mem *m, const json_t *object, slice_request *r);

/* view_slice_state_fit() - set the pixels of a placed slice so that it fits into a box of so many
 * pixels, in its own proportions. */
void view_slice_state_fit(leafcast_slice_pixels *s, const uint32_t box[2]);

#endif
