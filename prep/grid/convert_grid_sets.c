#include "prep/grid/convert_grid_sets.h"

#include <string.h>

#include "formats/base/text.h"

typedef struct choice {
    convert_sets *s;
    double *times;  /* copy of the times of all its steps, or NULL */
    bool found;     /* the reader's default field was met */
    uint32_t steps; /* steps of that field */
} choice;

/* Note the reader's default field. A format without names has only one field. */
static status take_first(void *ctx, const slice_field *f) {
    choice *c = ctx;
    const bool first = f->taken && !c->found;
    if (first || c->steps == 0)
        c->steps = f->steps;
    if (!first)
        return ST_OK;
    c->found = true;
    if (f->times && !c->s->times && step_list_given(&c->s->taken)) {
        c->times = mem_array(c->s->m, f->steps, sizeof *c->times);
        if (!c->times)
            return ST_NOMEM;
        memcpy(c->times, f->times, f->steps * sizeof *c->times);
        text_name(c->s->time_unit, sizeof c->s->time_unit, f->time_unit ? f->time_unit : "");
    }
    return c->s->all_fields && *f->name ? convert_sets_take_copy(c->s, f->name) : ST_OK;
}

static status take_others(void *ctx, const slice_field *f) {
    const choice *c = ctx;
    const bool fits = !step_list_given(&c->s->taken) || f->steps == c->steps;
    return !f->taken && fits ? convert_sets_take_copy(c->s, f->name) : ST_OK;
}

status convert_grid_sets(convert_sets *s, const volume *v, const char *name) {
    choice c = {.s = s};
    const bool chosen = step_list_given(&s->taken);
    if (!s->all_fields && !chosen)
        return ST_OK;
    status st = volume_fields(v, &(slice_fields){take_first, &c});
    if (st == ST_OK && s->count > 0 && s->all_fields)
        st = volume_fields(v, &(slice_fields){take_others, &c});
    if (st == ST_OK && chosen)
        st = step_list_settle(&s->taken, "--steps", name, c.steps ? c.steps : 1);
    s->steps = chosen ? (uint32_t)step_list_count(&s->taken) : 0;
    if (st == ST_OK && c.times)
        st = convert_sets_take_times(s, c.times);
    if (c.times)
        mem_free(s->m, c.times);
    return st;
}

status convert_grid_sets_alike(convert_sets *s, grid_series *series, const volume *v,
                               void (*left_out)(void *ctx, const char *name, const char *why),
                               void *ctx) {
    for (int i = 1; s->all_fields && i < s->count;) {
        const uint32_t set = (uint32_t)i * series->of.sets.steps;
        status st = grid_series_alike(s->m, series, set, v);
        if (st == ST_UNSUPPORTED) {
            left_out(ctx, s->kept[i], status_text());
            convert_sets_drop(s, i);
            continue;
        }
        if (st != ST_OK)
            return st;
        i++;
    }
    series->of.sets.fields = s->count ? (uint32_t)s->count : 1;
    return ST_OK;
}
