/* live_steps.h - which of its file's two steps a live volume (leaf_live.h), or a surface that moves
 * (stream/moving_surface.h), shows, and until when.
 *
 * Whatever looks at a volume holds the current step while it does. A writer makes the other step;
 * before, it waits until nobody holds that. The loader reads for holders alone: who lets a step go
 * has ended its reads.
 */
#ifndef RENDER_DOOR_LIVE_STEPS_H
#define RENDER_DOOR_LIVE_STEPS_H

#include <pthread.h>

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/live_samples.h"
#include "formats/public_status.h"

typedef struct live_hold {
    struct live_hold *next;
    struct live_steps *of; /* NULL: nothing is held */
    uint32_t step;
    pthread_t by;
} live_hold;

typedef struct live_steps live_steps;

CHECKED status live_steps_create(mem *m, leaf_file *f, live_steps **out);
void live_steps_destroy(live_steps *s); /* NULL is fine; nobody holds a step */

/* live_steps_hold() - hold the current step: h->step. live_steps_let_go() - of a hold that is all
 * zero, too. Any thread. s NULL: nothing changes. */
void live_steps_hold(live_steps *s, live_hold *h);
void live_steps_let_go(live_hold *h);

/* live_steps_begin() - wait until nobody holds the step that is not shown: *step, for the caller to
 * write. ST_USAGE: this thread holds it. live_steps_end() - the caller has written it; show: from
 * now on it is shown. Any thread; another one that begins waits. */
CHECKED status live_steps_begin(live_steps *s, uint32_t *step);
void live_steps_end(live_steps *s, uint32_t step, bool show);

/* live_steps_put() - leaf_live_put() into the step that is not shown. live_steps_commit() - finish
 * it, and show it from now on. Any thread. ST_USAGE: this thread holds it. */
CHECKED status live_steps_put(live_steps *s, const live_region *r);
CHECKED status live_steps_commit(live_steps *s, double time);

#endif
