/* view_state.h - read a page's state as flags of render.
 *
 * A state is not trusted until it is checked: it may name no file, neither to read nor to write.
 */
#ifndef RENDER_VIEW_VIEW_STATE_H
#define RENDER_VIEW_VIEW_STATE_H

#include <jansson.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/view_options.h"

/* view_state_parse() - parse JSON from a page: an object without duplicate keys. *object is the
 * caller's to json_decref(). ST_USAGE. */
CHECKED status view_state_parse(const char *text, size_t size, json_t **object);

/* view_state_apply() - set *v from a state, with render's defaults for the rest. Flags are not
 * checked against each other yet, see view_options_check(). ST_USAGE: unknown keys, wrong values,
 * names of files. */
CHECKED status view_state_apply(mem *m, json_t *state, view_options *v);

/* view_state_check_names() - returns ST_USAGE if a page's colours or transfer function name a
 * file. */
CHECKED status view_state_check_names(const medium_options *medium);

/* view_state_first() - returns a state to begin with: the suggested isovalue of the first field,
 * and the camera that fits it. NULL: no memory. */
json_t *view_state_first(const leafcast *volume);

/* view_state_fits() - returns how far that state's eye is away in pictures of other proportions: an
 * array of [width / height, distance], ascending. */
json_t *view_state_fits(const leafcast *volume);

#endif
