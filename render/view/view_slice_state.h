/* view_slice_state.h - what a page says of a slice, as flags of `leafcast slice`. */
#ifndef RENDER_VIEW_VIEW_SLICE_STATE_H
#define RENDER_VIEW_VIEW_SLICE_STATE_H

#include <jansson.h>

#include "render/app/slice_request.h"

/* view_slice_state_apply() - *r, which need not be initialised, becomes what an object says, whose
 * keys are flags of `leafcast slice` without their dashes. It owns no memory yet. ST_USAGE: unknown
 * keys, wrong values, names of files, curved slices, and --size, which is the pane's. */
CHECKED status view_slice_state_apply(mem *m, const json_t *object, slice_request *r);

/* view_slice_state_fit() - the pixels of a placed slice such that it fits into a box of so many, at
 * its own proportions. */
void view_slice_state_fit(leafcast_slice_pixels *s, const uint32_t box[2]);

#endif
