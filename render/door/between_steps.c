#include "render/door/between_steps.h"

#include "formats/leaf/leaf_between.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"

/* ---- Which moment ---- */

status between_steps_check(const leafcast *v, uint32_t field, uint32_t step, double share) {
    const status st = volume_check_set(v, field, step);
    if (st != ST_OK || share == 0.0)
        return st;
    if (step + 1 == v->file->header.steps || v->live)
        return status_describe(ST_USAGE, "between step %u and the next: there is no next one",
                               step);
    return leaf_between_check(v->file);
}

/* The share of the way from one time to a later one, which may be further than doubles go. */
static double share_of(double time, double from, double to) {
    const double scale = isfinite(to - from) ? 1.0 : 0.5;
    return (scale * time - scale * from) / (scale * to - scale * from);
}

leafcast_status leafcast_find_time(const leafcast *v, double time, uint32_t *step,
                                   double *between) {
    const status st =
        public_needs(__func__, "volume step between", (const void *[]){v, step, between});
    if (st != ST_OK)
        return public_status(st);
    const uint32_t last = leafcast_describe(v).steps - 1;
    const double from = leafcast_step_time(v, 0), to = leafcast_step_time(v, last);
    if (!(time >= from && time <= to))
        return public_status(status_describe(ST_USAGE,
                                             "%s: time %g: the steps have times from %g to %g",
                                             file_path(v->file->source), time, from, to));
    uint32_t low = 0, high = last; /* times ascend: the step is in [low, high] */
    while (low < high) {
        const uint32_t middle = low + (high - low + 1) / 2;
        if (leafcast_step_time(v, middle) <= time)
            low = middle;
        else
            high = middle - 1;
    }
    const double before = leafcast_step_time(v, low);
    *between =
        low < last && time > before ? share_of(time, before, leafcast_step_time(v, low + 1)) : 0.0;
    /* The share of a time just before the next step may round to 1. */
    *step = low + (*between >= 1.0);
    *between = *between < 1.0 ? *between : 0.0;
    return LEAFCAST_OK;
}

leafcast_status leafcast_select_between(leafcast *v, uint32_t field, uint32_t step,
                                        double between) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_below(__func__, "between", between, 0.0, 1.0);
    if (st != ST_OK || between == 0.0)
        return st == ST_OK ? leafcast_select_set(v, field, step) : public_status(st);
    device_lock(v->device);
    st = between_steps_check(v, field, step, between);
    if (st == ST_OK) {
        v->field = field;
        v->step = step;
        v->share = between;
    }
    if (st == ST_OK && v->between)
        loader_reset_statistics(v->between->treelets);
    device_unlock(v->device);
    return public_status(st);
}

leafcast_status leafcast_expect_between(leafcast *v, uint32_t field, uint32_t step,
                                        double between) {
    status st = arguments_check_volume(__func__, v);
    if (st == ST_OK)
        st = public_below(__func__, "between", between, 0.0, 1.0);
    if (st != ST_OK || between == 0.0)
        return st == ST_OK ? leafcast_expect_set(v, field, step) : public_status(st);
    device_lock(v->device);
    st = between_steps_check(v, field, step, between);
    if (st == ST_OK && v->between)
        loader_expect(v->between->treelets, between_steps_set(v->between, field, step, between));
    device_unlock(v->device);
    return public_status(st);
}

/* ---- The volume ---- */

static status make(leafcast *v, const void *from) {
    const leafcast *of = from;
    return leaf_between_open(v->m, of->file, of->device->isa, &v->file);
}

status between_steps_open(leafcast **v, double share) {
    leafcast *of = *v;
    leafcast_options options = of->options;
    options.experiments = &of->experiments;
    of->is_between = false;
    if (share == 0.0)
        return ST_OK;
    if (!of->between) {
        const status st = volume_open_on(of->device, &options, make, of, &of->between);
        if (st != ST_OK)
            return st;
        of->between->opened_at = of->opened_at;
        of->between->open_s = of->open_s;
    }
    of->is_between = true;
    *v = of->between;
    return ST_OK;
}

uint32_t between_steps_set(leafcast *v, uint32_t field, uint32_t step, double share) {
    const leaf_moment at = {field, step, share};
    uint32_t set;
    if (!v->file->below)
        return leaf_layout_set(&v->file->layout, field, step);
    if (!leaf_between_find(v->file, &at, &set))
        loader_rest(v->treelets);
    return leaf_between_select(v->file, &at);
}
