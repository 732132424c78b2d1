#include "render/view/view_stride.h"

/* The shorter way in the circle of all steps. */
static int64_t way(uint32_t from, uint32_t to, uint32_t steps) {
    const int64_t straight = (int64_t)to - from;
    return 2 * straight > steps              ? straight - steps
           : 2 * straight <= -(int64_t)steps ? straight + steps
                                             : straight;
}

uint32_t view_stride_next(view_stride *s, uint32_t step, uint32_t steps) {
    if (s->shown && step != s->step) {
        const int64_t went = way(s->step, step, steps);
        const bool plays = went == s->went || went == 1 || went == -1;
        s->by = plays ? went : s->by ? s->by : 1;
        s->went = went;
    }
    s->shown = true;
    s->step = step;
    return (uint32_t)((step + s->by + steps) % steps);
}
