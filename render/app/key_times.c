#include "render/app/key_times.h"

static const char TIME[] = "time", STEP[] = "step";

bool key_times_any(const json_t *path) {
    bool any = false;
    for (size_t i = 0; i < json_array_size(path); i++)
        any |= json_object_get(json_array_get(path, i), TIME) != NULL;
    return any;
}

status key_times_none(const json_t *path, const char *file, const char *why) {
    for (size_t i = 0; i < json_array_size(path); i++)
        for (int k = 0; k < 2; k++) {
            const char *key = k ? TIME : STEP;
            if (json_object_get(json_array_get(path, i), key))
                return status_describe(ST_USAGE, "%s: entry %zu: \"%s\": %s", file, i + 1, key,
                                       why);
        }
    return ST_OK;
}

/* An entry of a path, and where it is. */
typedef struct entry {
    json_t *object;
    const char *file;
    size_t number; /* from 1 on */
} entry;

static status refuse(const entry *e, const char *why) {
    return status_describe(ST_USAGE, "%s: entry %zu: %s", e->file, e->number, why);
}

static status set(json_t *object, const char *key, json_t *value, const char *instead) {
    if (json_object_set_new(object, key, value) != 0)
        return status_describe(ST_NOMEM, "no memory for the views of a movie");
    (void)json_object_del(object, instead);
    return ST_OK;
}

/* Check an entry's time; give one that has a step its time, and one that has neither `before`,
 * which then becomes the entry's. */
static status unify(const entry *e, const leafcast *volume, double *before) {
    const uint32_t steps = leafcast_describe(volume).steps;
    const json_t *time = json_object_get(e->object, TIME), *step = json_object_get(e->object, STEP);
    const double first = leafcast_step_time(volume, 0),
                 last = leafcast_step_time(volume, steps - 1);
    if (!json_is_object(e->object))
        return refuse(e, "not a JSON object");
    if (time && step)
        return refuse(e, "either \"time\" or \"step\"");
    if (time && !json_is_number(time))
        return refuse(e, "\"time\" is no number");
    if (time && !(json_number_value(time) >= first && json_number_value(time) <= last))
        return status_describe(ST_USAGE, "%s: entry %zu: time %g: the steps go from %g to %g",
                               e->file, e->number, json_number_value(time), first, last);
    if (!step && !time)
        return set(e->object, TIME, json_real(*before), STEP);
    if (time) {
        *before = json_number_value(time);
        return ST_OK;
    }
    const json_int_t k = json_integer_value(step);
    if (!json_is_integer(step) || k < 0 || k >= steps)
        return refuse(e, "no such \"step\"");
    *before = leafcast_step_time(volume, (uint32_t)k);
    return set(e->object, TIME, json_real(*before), STEP);
}

status key_times_unify(json_t *path, const char *file, const leafcast *volume, double first) {
    status st = ST_OK;
    double before = first;
    if (!key_times_any(path))
        return ST_OK;
    for (size_t i = 0; i < json_array_size(path) && st == ST_OK; i++)
        st = unify(&(entry){json_array_get(path, i), file, i + 1}, volume, &before);
    return st;
}

/* Returns the last step whose time has come. Rounding of what is between two keys makes none late:
 * a time counts as come when this much of the way to it is left. */
static uint32_t step_at(const leafcast *volume, double time) {
    const double rounding = 1e-9;
    uint32_t lo = 0, hi = leafcast_describe(volume).steps;
    while (hi - lo > 1) { /* the time of lo has come, that of hi has not */
        const uint32_t mid = lo + (hi - lo) / 2;
        const double here = leafcast_step_time(volume, mid),
                     before = leafcast_step_time(volume, mid - 1);
        if (time >= here - rounding * (here - before))
            lo = mid;
        else
            hi = mid;
    }
    return lo;
}

status key_times_settle(json_t *path, const leafcast *volume) {
    status st = ST_OK;
    for (size_t i = 0; i < json_array_size(path) && st == ST_OK; i++) {
        json_t *object = json_array_get(path, i);
        const json_t *time = json_object_get(object, TIME);
        if (time)
            st = set(object, STEP, json_integer(step_at(volume, json_number_value(time))), TIME);
    }
    return st;
}
