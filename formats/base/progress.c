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

static void report_part(void *ctx, const char *stage, double fraction) {
    const progress_part *part = ctx;
    if (part->of && part->of->report)
        part->of->report(part->of->ctx, stage, part->from + (part->to - part->from) * fraction);
}

static bool stop_part(void *ctx) {
    const progress_part *part = ctx;
    return part->of && part->of->stop && part->of->stop(part->of->ctx);
}

progress progress_of_part(progress_part *part) {
    return (progress){report_part, stop_part, part};
}
