#include "formats/base/progress.h"

#include <stddef.h>

status progress_step(const progress *p, const char *stage, double fraction) {
    if (!p)
        return ST_OK;
    if (p->report)
        p->report(p->ctx, stage, fraction);
    return progress_ask(p, stage);
}

status progress_ask(const progress *p, const char *stage) {
    return p && p->stop && p->stop(p->ctx) ? status_describe(ST_STOPPED, "stopped while %s", stage)
                                           : ST_OK;
}
