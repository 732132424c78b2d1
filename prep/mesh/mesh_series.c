#include "prep/mesh/mesh_series.h"

#include <math.h>
#include <string.h>

#include "formats/leaf/leaf.h"

static status check_times(const mesh_series *s) {
    for (uint32_t i = 0; s->times && i < s->steps; i++)
        if (!isfinite(s->times[i]) || (i > 0 && s->times[i] <= s->times[i - 1]))
            return status_describe(ST_USAGE, "times of steps must ascend, but step %u is at %g", i,
                                   s->times[i]);
    return ST_OK;
}

static status check_names(const mesh_series *s) {
    for (uint32_t i = 0; s->names && i < s->fields; i++)
        for (uint32_t k = 0; k < i; k++)
            if (strcmp(s->names[i], s->names[k]) == 0)
                return status_describe(ST_USAGE, "the field \"%s\" is given twice", s->names[i]);
    return ST_OK;
}

status mesh_series_check(const mesh_series *s) {
    if ((uint64_t)s->fields * s->steps > LEAF_SETS_MAX)
        return status_describe(ST_UNSUPPORTED, "%u fields at %u steps: more than %d together",
                               s->fields, s->steps, LEAF_SETS_MAX);
    for (uint32_t i = 0; i < s->steps; i++)
        if (strcmp(s->paths[i], "-") == 0 && (uint64_t)s->fields * s->steps > 1)
            return status_describe(ST_USAGE, "standard input can be read only once, so it can be "
                                             "neither of several steps nor of several fields");
    status st = check_times(s);
    return st == ST_OK ? check_names(s) : st;
}

/* A field at a step, but for the very first. name: of the array, or NULL. */
static status read_again(mem *m, const mesh_series *s, mesh_gather *g, const char *name,
                         const mesh_sink *sink) {
    mesh_hints hints = s->hints;
    mesh_report report;
    mesh_input *x = NULL;
    hints.field = name;
    status st = mesh_input_open(m, s->paths[g->step], &hints, &x);
    if (st == ST_OK)
        st = mesh_gather_read(g, x, sink, &report);
    mesh_input_close(x);
    return st;
}

status mesh_series_read(mem *m, const mesh_series *s, mesh_input *first, mesh_gather *g,
                        const mesh_sink *sink, mesh_report *report) {
    g->fields = s->fields;
    g->steps = s->steps;
    for (uint32_t step = 0; step < s->steps; step++)
        for (uint32_t field = 0; field < s->fields; field++) {
            const bool begins = step == 0 && field == 0;
            const char *name = s->names ? s->names[field] : *report->field ? report->field : NULL;
            mesh_gather_next(g, step, field, s->paths[step]);
            status st =
                begins ? mesh_gather_read(g, first, sink, report) : read_again(m, s, g, name, sink);
            if (st == ST_OK)
                st = mesh_gather_done(g);
            if (st != ST_OK)
                return st;
        }
    return ST_OK;
}
