#include "prep/mesh/mesh_series.h"

#include "prep/series_check.h"

status mesh_series_check(const mesh_series *s) {
    return series_check(s->paths, false, &(leaf_sets){s->fields, s->steps, s->names, s->times});
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
