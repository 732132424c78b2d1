/* view_stride.h - which step a page shows next, by those that it has shown.
 *
 * Steps that play go on as they went. A change unlike the one before, and not to a neighbour, is a
 * jump: behind it steps go on as they did before it, or by one if none has played yet. The last
 * step and the first are neighbours.
 */
#ifndef RENDER_VIEW_VIEW_STRIDE_H
#define RENDER_VIEW_VIEW_STRIDE_H

#include <stdbool.h>
#include <stdint.h>

/* Zero: nothing was shown. */
typedef struct view_stride {
    bool shown;
    uint32_t step;    /* shown last, */
    int64_t went, by; /* from so many steps before; how it goes on; 0: not known */
} view_stride;

/* view_stride_next() - note that `step` of `steps`, below them, is shown. Returns the step that is
 * expected behind it; `step` itself before it has ever changed. */
uint32_t view_stride_next(view_stride *s, uint32_t step, uint32_t steps);

#endif
