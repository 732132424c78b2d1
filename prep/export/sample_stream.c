#include "prep/export/sample_stream.h"

#include "prep/export/grid_slices.h"

/* Receiver of the samples. */
typedef struct sample_sink {
    out_stream *out;
    sample_type type;
} sample_sink;

static status append(void *ctx, const void *samples, size_t count) {
    const sample_sink *sink = ctx;
    return out_stream_samples(sink->out, sink->type, samples, count);
}

/* Progress of one of several equal jobs. */
typedef struct one_of {
    const progress *p;
    uint32_t index, count;
} one_of;

static void report_one(void *ctx, const char *stage, double fraction) {
    const one_of *o = ctx;
    o->p->report(o->p->ctx, stage, (o->index + fraction) / o->count);
}

static bool stop_one(void *ctx) {
    const one_of *o = ctx;
    return o->p->stop(o->p->ctx);
}

/* Write the sets one after the other. */
static status write_sets(mem *m, const sample_export *e, sample_sink *sink) {
    status st = ST_OK;
    for (uint32_t i = 0; i < e->count && st == ST_OK; i++) {
        one_of one = {e->p, i, e->count};
        const progress p = {.report = e->p && e->p->report ? report_one : NULL,
                            .stop = e->p && e->p->stop ? stop_one : NULL,
                            .ctx = &one};
        grid_part part = *e->part;
        part.set = e->sets[i];
        st = grid_slices_run(m, e->f, &part, e->threads, &p, append, sink);
    }
    return st;
}

status sample_stream_write(mem *m, const sample_format *format, const sample_export *e,
                           const grid *g, bool gzip) {
    sample_sink sink = {.type = g->type};
    status st = out_stream_create(m, e->path, e->force, gzip, &sink.out);
    if (st != ST_OK)
        return st;
    if (e->times->steps > 1)
        st = format->head_steps(m, sink.out, g, e->times);
    else if (format->head)
        st = format->head(m, sink.out, g);
    if (st == ST_OK)
        st = write_sets(m, e, &sink);
    if (st == ST_OK && format->tail)
        st = format->tail(sink.out);
    if (st == ST_OK)
        return out_stream_commit(sink.out);
    out_stream_discard(sink.out);
    return st;
}
