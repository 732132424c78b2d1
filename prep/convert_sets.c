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

status convert_sets_take_copy(convert_sets *s, const char *name) {
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

/* ---- what the input has ---- */

status convert_sets_take_times(convert_sets *s, const double *all) {
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

status convert_sets_take_steps(convert_sets *s, const char *name, uint32_t steps,
                               const double *times) {
    if (!step_list_given(&s->taken))
        return ST_OK;
    status st = step_list_settle(&s->taken, "--steps", name, steps);
    if (st != ST_OK)
        return st;
    s->steps = (uint32_t)step_list_count(&s->taken);
    return times && !s->times ? convert_sets_take_times(s, times) : ST_OK;
}

void convert_sets_drop(convert_sets *s, int i) {
    mem_free(s->m, s->copied[i]);
    s->count--;
    for (; i < s->count; i++) {
        memcpy(s->kept[i], s->kept[i + 1], sizeof s->kept[i]);
        s->asked[i] = s->asked[i + 1];
        s->copied[i] = s->copied[i + 1];
    }
    s->copied[s->count] = NULL;
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
