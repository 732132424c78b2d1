#include "prep/grid/grid_series.h"

#include <string.h>

static uint32_t step_of(const grid_series *s, uint32_t set) {
    return set % s->of.sets.steps;
}

status grid_series_open(mem *m, const grid_series *s, uint32_t set, volume **out) {
    volume_hints hints = s->hints;
    const char *field = step_series_field(&s->of, set / s->of.sets.steps);
    if (field)
        hints.field = field;
    step_series_seek(&s->of, step_of(s, set), &hints.step);
    hints.all_steps |= s->of.in_file != NULL;
    return volume_open(m, step_series_path(&s->of, step_of(s, set)), &hints, out);
}

/* ---- checks ---- */

static bool same_place(const grid *a, const grid *b) {
    if (memcmp(a->to_world, b->to_world, sizeof a->to_world) != 0 ||
        grid_is_rectilinear(a) != grid_is_rectilinear(b))
        return false;
    for (int i = 0; i < 3 && grid_is_rectilinear(a); i++)
        if (memcmp(a->axis[i], b->axis[i], a->dims[i] * sizeof *a->axis[i]) != 0)
            return false;
    return true;
}

static const char *axes_text(const grid *g) {
    return g->frame.axes ? world_axes_name(g->frame.axes) : "untold";
}

/* name: for errors about g. */
static status check_like(const grid *g, const grid *first, const char *name) {
    const sample_type type = sample_stored(g->type), wanted = sample_stored(first->type);
    if (memcmp(g->dims, first->dims, sizeof g->dims) != 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: has %u x %u x %u samples, expected %u x %u x %u as the first",
                               name, g->dims[0], g->dims[1], g->dims[2], first->dims[0],
                               first->dims[1], first->dims[2]);
    if (type != wanted)
        return status_describe(ST_UNSUPPORTED,
                               "%s: has samples of type %s, expected %s as the first", name,
                               sample_name(grid_source(g)), sample_name(grid_source(first)));
    if (g->frame.axes != first->frame.axes)
        return status_describe(ST_UNSUPPORTED, "%s: its axes are %s, expected %s as the first's",
                               name, axes_text(g), axes_text(first));
    if (!same_place(g, first))
        return status_describe(ST_UNSUPPORTED,
                               "%s: its samples lie elsewhere in the world than those of the first",
                               name);
    return ST_OK;
}

status grid_series_alike(mem *m, const grid_series *s, uint32_t set, const volume *first) {
    volume *v = NULL;
    status st = grid_series_open(m, s, set, &v);
    if (st == ST_OK)
        st = check_like(volume_grid(v), volume_grid(first),
                        step_series_path(&s->of, step_of(s, set)));
    volume_close(v);
    return st;
}

static bool is_known(const grid_series *s, uint32_t set) {
    return set == 0 || (step_of(s, set) == 0 ? s->fields_alike : s->of.in_file != NULL);
}

status grid_series_check(mem *m, const grid_series *s, const volume *first) {
    status st = step_series_check(&s->of);
    for (uint32_t set = 1; set < s->of.sets.fields * s->of.sets.steps && st == ST_OK; set++)
        if (!is_known(s, set))
            st = grid_series_alike(m, s, set, first);
    return st;
}
