/* render_ahead.h - before a picture is drawn: say what the pictures behind it show, so that the
 * volume reads it while this one is written (leafcast_expect_between()).
 *
 * A volume reads ahead one step and one time between steps: the first of either kind that is not of
 * this picture's own step.
 */
#ifndef RENDER_APP_RENDER_AHEAD_H
#define RENDER_APP_RENDER_AHEAD_H

#include <stdbool.h>

#include "render/app/view_options.h"

typedef struct render_ahead {
    leafcast *volume;
    const view_options *now; /* of the picture that is drawn; its time has been found */
    bool told[2];            /* a step; a time between steps */
} render_ahead;

/* render_ahead_note() - note the next one of the pictures that come, in their order: its field,
 * step and share of the way to the next step. One that the file does not have is passed over.
 * Returns whether further ones count. */
bool render_ahead_note(render_ahead *a, const view_options *next);

#endif
