#include "prep/grid/convert_grid_append.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/num.h"

__attribute__((format(printf, 2, 3))) static status differs(const convert_request *a,
                                                            const char *fmt, ...) {
    char text[STATUS_TEXT_MAX / 2];
    va_list args;
    va_start(args, fmt);
    vsnprintf(text, sizeof text, fmt, args);
    va_end(args);
    return status_describe(ST_USAGE, "%s: no further step of %s: %s", a->common.input,
                           a->common.output, text);
}

static status check_grid(const convert_request *a, const leaf_file *f, const grid *g) {
    const leaf_header *h = &f->header;
    if (memcmp(h->dims, g->dims, sizeof h->dims) != 0)
        return differs(a, "it has %u x %u x %u samples, expected %u x %u x %u", g->dims[0],
                       g->dims[1], g->dims[2], h->dims[0], h->dims[1], h->dims[2]);
    if (h->source_type != (uint32_t)grid_source(g) ||
        h->sample_type != (uint32_t)sample_stored(g->type))
        return differs(a, "its samples are %s, kept as %s, expected %s, kept as %s",
                       sample_name(grid_source(g)), sample_name(sample_stored(g->type)),
                       sample_name((sample_type)h->source_type),
                       sample_name((sample_type)h->sample_type));
    bool same = h->rectilinear == grid_is_rectilinear(g) &&
                memcmp(h->to_world, g->to_world, sizeof h->to_world) == 0;
    for (int k = 0; k < 3 && same && h->rectilinear; k++)
        same = memcmp(f->axis[k], g->axis[k], h->dims[k] * sizeof *f->axis[k]) == 0;
    return same ? ST_OK : differs(a, "it lies elsewhere in the world, or has other spacings");
}

/* What the input says of axes and units must be what the file says; it may say nothing. */
static status check_frame(const convert_request *a, const leaf_file *f, const grid *g,
                          const leaf_sets *sets) {
    const world_frame *own = &g->frame, *its = &f->frame;
    const char *time_unit = sets->time_unit ? sets->time_unit : own->time_unit;
    bool same = !own->axes || own->axes == its->axes;
    for (int k = 0; k < 3; k++)
        same = same && (!*own->unit[k] || strcmp(own->unit[k], its->unit[k]) == 0);
    if (!same)
        return differs(a, "its axes or units are not the file's");
    if (f->has_times && *time_unit && strcmp(time_unit, its->time_unit) != 0)
        return differs(a, "its times are in %s, expected %s", time_unit,
                       *its->time_unit ? its->time_unit : "no unit");
    return ST_OK;
}

static status check_fields(const convert_request *a, const leaf_file *f, const leaf_sets *sets) {
    if (sets->fields != f->header.fields)
        return differs(a, "%u fields are taken, expected %u", sets->fields, f->header.fields);
    for (uint32_t i = 0; i < sets->fields; i++) {
        const char *own = sets->names ? sets->names[i] : "", *name = leaf_file_field_name(f, i);
        if (*own && *name && strcmp(own, name) != 0)
            return differs(a, "field %u is %s, expected %s", i, own, name);
    }
    return ST_OK;
}

static status check_times(const convert_request *a, const leaf_file *f, leaf_sets *sets) {
    char first[NUM_TEXT_MAX], last[NUM_TEXT_MAX];
    const double end = leaf_file_step_time(f, f->header.steps - 1);
    if (!f->has_times) {
        if (sets->times)
            cli_note(&a->common, 1, "%s: its steps are numbered: times are left out",
                     a->common.output);
        sets->times = NULL;
        return ST_OK;
    }
    if (!sets->times)
        return differs(a, "it has no time: --times gives it");
    return sets->times[0] > end ? ST_OK
                                : differs(a, "its time %s is not behind the last one, %s",
                                          num_print(sets->times[0], first), num_print(end, last));
}

status convert_grid_append_check(const convert_request *a, const grid *g, leaf_sets *sets) {
    if (!a->grow)
        return ST_OK;
    const leaf_file *f = leaf_grow_before(a->grow);
    status st = check_grid(a, f, g);
    if (st == ST_OK)
        st = check_frame(a, f, g, sets);
    if (st == ST_OK)
        st = check_fields(a, f, sets);
    if (st == ST_OK && sets->steps > LEAF_SETS_MAX / sets->fields - f->header.steps)
        st = differs(a, "it would have more than %d sets", LEAF_SETS_MAX);
    return st == ST_OK ? check_times(a, f, sets) : st;
}
