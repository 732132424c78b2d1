#include "prep/mesh/mesh_series.h"

/* Read all fields of a step. */
static status read_step(const mesh_series *s, mesh_gather *g, mesh_input *x, const mesh_sink *sink,
                        mesh_report *report) {
    status st = s->of.sets.names ? mesh_input_take(x, s->of.sets.names, s->of.sets.fields) : ST_OK;
    if (st == ST_OK)
        st = mesh_gather_read(g, x, sink, report);
    return st == ST_OK ? mesh_gather_done(g) : st;
}

static status open_step(mem *m, const mesh_series *s, uint32_t step, const mesh_hints *hints,
                        mesh_input **out) {
    byte_stream *stream;
    if (!s->readers)
        return mesh_input_open(m, step_series_path(&s->of, step), hints, out);
    const status st = byte_stream_open(m, step_series_path(&s->of, step), &stream);
    return st == ST_OK ? mesh_input_open_by(m, s->readers, stream, hints, out) : st;
}

/* field: of the first step, used if the series has no names; "": it has none. */
static status read_later_step(mem *m, const mesh_series *s, mesh_gather *g, uint32_t step,
                              const char *field, const mesh_sink *sink) {
    mesh_hints hints = s->hints;
    mesh_report report;
    mesh_input *x = NULL;
    hints.field = s->of.sets.names ? s->of.sets.names[0] : *field ? field : NULL;
    step_series_seek(&s->of, step, &hints.step);
    status st = open_step(m, s, step, &hints, &x);
    if (st == ST_OK) {
        mesh_gather_next(g, step, mesh_input_file(x));
        st = read_step(s, g, x, sink, &report);
    }
    mesh_input_close(x);
    return st;
}

void mesh_series_begin(const mesh_series *s, mesh_input *first, mesh_gather *g) {
    g->fields = s->of.sets.fields;
    g->steps = s->of.sets.steps;
    g->first_name = mesh_input_file(first);
}

status mesh_series_read(mem *m, const mesh_series *s, mesh_input *first, mesh_gather *g,
                        const mesh_sink *sink, mesh_report *report) {
    if (g->done > 0)
        return read_later_step(m, s, g, g->done, report->field, sink);
    mesh_gather_next(g, 0, mesh_input_file(first));
    return read_step(s, g, first, sink, report);
}
