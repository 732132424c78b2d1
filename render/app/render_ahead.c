#include "render/app/render_ahead.h"

static bool is_between(const view_options *v) {
    return v->time.between != 0.0;
}

bool render_ahead_note(render_ahead *a, const view_options *next) {
    bool *told = &a->told[is_between(next)];
    uint32_t now_field, field;
    if (*told || view_options_field(a->now, a->volume, &now_field) != ST_OK ||
        view_options_field(next, a->volume, &field) != ST_OK)
        return true;
    const bool same = is_between(a->now) == is_between(next) && a->now->step == next->step;
    if (!same || field != now_field)
        *told = leafcast_expect_between(a->volume, field, next->step, next->time.between) ==
                LEAFCAST_OK;
    return !a->told[0] || !a->told[1];
}
