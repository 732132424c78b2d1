#include "formats/base/progress.h"

#include <stddef.h>

status progress_step(const progress *p, const char *stage, double fraction) {
    if (!p)
        return ST_OK;
    if (p->report)
        p->report(p->ctx, stage, fraction);
    if (p->stop && p->stop(p->ctx))
        return status_describe(ST_STOPPED, "stopped while %s", stage);
    return ST_OK;
}
