#include "prep/convert_sets.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"
#include "formats/base/text.h"

void convert_sets_release(convert_sets *s) {
    for (int i = 0; i < CONVERT_FIELDS_MAX; i++)
        if (s->copied[i])
            mem_free(s->m, s->copied[i]);
    if (s->parsed)
        mem_free(s->m, s->parsed);
    s->parsed = NULL;
    s->count = 0;
}

/* ---- fields ---- */

status convert_sets_add(convert_sets *s, const char *name) {
    const int i = s->count;
    if (i == CONVERT_FIELDS_MAX)
        return status_describe(ST_USAGE, "more than %d fields", CONVERT_FIELDS_MAX);
    text_name(s->kept[i], sizeof s->kept[i], name);
    s->names[i] = s->kept[i];
    s->asked[i] = name;
    s->count++;
    return ST_OK;
}

status convert_sets_check(const convert_sets *s, int inputs, bool step) {
    if (s->all_fields && s->count)
        return status_describe(ST_USAGE, "--fields all and --field exclude each other");
    if (step_list_given(&s->taken) && step)
        return status_describe(ST_USAGE, "--steps and --step exclude each other");
    if (step_list_given(&s->taken) && inputs > 1)
        return status_describe(ST_USAGE, "--steps takes those of one file: several inputs are the "
                                         "steps themselves");
    if (!step_list_ascends(&s->taken))
        return status_describe(ST_USAGE, "--steps: the steps of a series ascend, each comes once");
    return ST_OK;
}

void convert_sets_take_all(convert_sets *s) {
    s->taken.all = s->taken.all || !step_list_given(&s->taken);
}

void convert_sets_first_step(const convert_sets *s, uint32_t *step) {
    if (s->taken.count > 0)
        *step = step_list_at(&s->taken, 0);
}

/* Add a field of the input, once per name. */
static status take_copy(convert_sets *s, const char *name) {
    char clean[sizeof s->kept[0]];
    text_name(clean, sizeof clean, name);
    for (int i = 0; i < s->count; i++)
        if (strcmp(s->kept[i], clean) == 0)
            return ST_OK;
    char *copy = mem_copy_text(s->m, name);
    if (!copy)
        return ST_NOMEM;
    const status st = convert_sets_add(s, copy);
    if (st == ST_OK)
        s->copied[s->count - 1] = copy;
    else
        mem_free(s->m, copy);
    return st;
}

/* ---- grids and meshes ---- */

/* Copy the file's times for the chosen steps. If they do not ascend, keep none. */
static status take_times(convert_sets *s, const double *all) {
    s->parsed = mem_array(s->m, s->steps, sizeof *s->parsed);
    if (!s->parsed)
        return ST_NOMEM;
    for (uint32_t i = 0; i < s->steps; i++) {
        s->parsed[i] = all[step_list_at(&s->taken, i)];
        s->times_fall = s->times_fall || !isfinite(s->parsed[i]) ||
                        (i > 0 && !(s->parsed[i] > s->parsed[i - 1]));
    }
    if (!s->times_fall)
        return ST_OK;
    mem_free(s->m, s->parsed);
    s->parsed = NULL;
    s->time_unit[0] = 0;
    return ST_OK;
}

/* ---- meshes ---- */

typedef struct taking {
    convert_sets *s;
    status st;
} taking;

static void take_array(void *ctx, const char *name, int components) {
    (void)components;
    taking *t = ctx;
    if (t->st == ST_OK)
        t->st = take_copy(t->s, name);
}

static status take_mesh_steps(convert_sets *s, const mesh_input *x, const char *name) {
    const double *times = mesh_input_times(x);
    status st = step_list_settle(&s->taken, "--steps", name, mesh_input_steps(x));
    if (st != ST_OK)
        return st;
    s->steps = (uint32_t)step_list_count(&s->taken);
    return times && !s->times ? take_times(s, times) : ST_OK;
}

status convert_sets_of_mesh(convert_sets *s, const mesh_input *x, const char *name) {
    taking t = {s, ST_OK};
    if (s->all_fields)
        mesh_input_fields(x, take_array, &t);
    return t.st == ST_OK && step_list_given(&s->taken) ? take_mesh_steps(s, x, name) : t.st;
}

/* ---- grids ---- */

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
    return c->s->all_fields && *f->name ? take_copy(c->s, f->name) : ST_OK;
}

static status take_others(void *ctx, const slice_field *f) {
    const choice *c = ctx;
    const bool fits = !step_list_given(&c->s->taken) || f->steps == c->steps;
    return !f->taken && fits ? take_copy(c->s, f->name) : ST_OK;
}

status convert_sets_of_grid(convert_sets *s, const volume *v, const char *name) {
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
        st = take_times(s, c.times);
    if (c.times)
        mem_free(s->m, c.times);
    return st;
}

static void drop(convert_sets *s, int i) {
    mem_free(s->m, s->copied[i]);
    s->count--;
    for (; i < s->count; i++) {
        memcpy(s->kept[i], s->kept[i + 1], sizeof s->kept[i]);
        s->asked[i] = s->asked[i + 1];
        s->copied[i] = s->copied[i + 1];
    }
    s->copied[s->count] = NULL;
}

status convert_sets_keep_alike(convert_sets *s, grid_series *series, const volume *v,
                               void (*left_out)(void *ctx, const char *name, const char *why),
                               void *ctx) {
    for (int i = 1; s->all_fields && i < s->count;) {
        const uint32_t set = (uint32_t)i * series->sets.steps;
        status st = grid_series_alike(s->m, series, set, v);
        if (st == ST_UNSUPPORTED) {
            left_out(ctx, s->kept[i], status_text());
            drop(s, i);
            continue;
        }
        if (st != ST_OK)
            return st;
        i++;
    }
    series->sets.fields = s->count ? (uint32_t)s->count : 1;
    return ST_OK;
}

/* ---- times ---- */

status convert_sets_times(convert_sets *s, uint32_t steps) {
    const char *at = s->times;
    if (!at)
        return ST_OK;
    s->parsed = mem_array(s->m, steps, sizeof *s->parsed);
    if (!s->parsed)
        return ST_NOMEM;
    for (uint32_t i = 0; i < steps; i++) {
        char text[64];
        const size_t length = strcspn(at, ",");
        if (at[length] != (i + 1 == steps ? '\0' : ','))
            return status_describe(
                ST_USAGE, "--times: \"%s\": expected %u times, one for each step", s->times, steps);
        snprintf(text, sizeof text, "%.*s", (int)(length < 63 ? length : 63), at);
        status st = num_double(text, "--times", &s->parsed[i]);
        if (st != ST_OK)
            return st;
        at += length + 1;
    }
    return ST_OK;
}
