#include "formats/base/step_list.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

/* ---- text ---- */

static status refuse(const char *text, const char *option) {
    return status_describe(ST_USAGE,
                           "%s: \"%s\" is neither all nor a list of steps: N, A:B or A:B:S, from 0 "
                           "on, divided by commas",
                           option, text);
}

/* Parse the number at *at, and move *at behind it. */
static bool take_number(const char **at, uint32_t *out) {
    char digits[16];
    const size_t n = strspn(*at, "0123456789");
    int64_t value = 0;
    if (n == 0 || n >= sizeof digits)
        return false;
    snprintf(digits, sizeof digits, "%.*s", (int)n, *at);
    *at += n;
    if (num_int(digits, "step", 0, INT32_MAX, &value) != ST_OK)
        return false;
    *out = (uint32_t)value;
    return true;
}

static bool take_range(const char **at, step_range *r) {
    if (!take_number(at, &r->first))
        return false;
    r->last = r->first;
    r->stride = 1;
    if (**at != ':')
        return true;
    ++*at;
    if (!take_number(at, &r->last))
        return false;
    if (**at != ':')
        return true;
    ++*at;
    return take_number(at, &r->stride) && r->stride > 0;
}

status step_list_parse(const char *text, const char *option, step_list *out) {
    const char *at = text;
    *out = (step_list){.all = strcmp(text, "all") == 0};
    while (!out->all) {
        step_range *r = &out->of[out->count];
        if (out->count == STEP_RANGES_MAX)
            return status_describe(ST_USAGE, "%s: more than %d entries", option, STEP_RANGES_MAX);
        if (!take_range(&at, r) || (*at && *at != ','))
            return refuse(text, option);
        if (r->last < r->first)
            return status_describe(ST_USAGE, "%s: \"%s\": %u:%u ends before it begins", option,
                                   text, r->first, r->last);
        out->count++;
        if (*at++ == 0)
            break;
    }
    return ST_OK;
}

bool step_list_given(const step_list *l) {
    return l->all || l->count > 0;
}

/* ---- steps ---- */

static uint64_t count_of(const step_range *r) {
    return ((uint64_t)r->last - r->first) / r->stride + 1;
}

static uint32_t last_of(const step_range *r) {
    return r->first + (uint32_t)((count_of(r) - 1) * r->stride);
}

status step_list_settle(step_list *l, const char *option, const char *name, uint32_t steps) {
    if (l->all)
        *l = (step_list){.count = 1, .of = {{0, steps - 1, 1}}};
    for (int i = 0; i < l->count; i++)
        if (last_of(&l->of[i]) >= steps)
            return status_describe(ST_USAGE, "%s: there is no step %u: %s has %u", option,
                                   last_of(&l->of[i]), name, steps);
    return ST_OK;
}

bool step_list_ascends(const step_list *l) {
    bool ascends = true;
    for (int i = 1; i < l->count; i++)
        ascends &= l->of[i].first > last_of(&l->of[i - 1]);
    return ascends;
}

uint64_t step_list_count(const step_list *l) {
    uint64_t count = 0;
    for (int i = 0; i < l->count; i++)
        count += count_of(&l->of[i]);
    return count;
}

uint32_t step_list_at(const step_list *l, uint64_t i) {
    int k = 0;
    for (; k + 1 < l->count && i >= count_of(&l->of[k]); k++)
        i -= count_of(&l->of[k]);
    return l->of[k].first + (uint32_t)(i * l->of[k].stride);
}
