#include "prep/grid/convert_grid_append.h"

#include <string.h>

#include "prep/convert_append.h"
#include "prep/further_step.h"

static status check_grid(const char *input, const leaf_file *f, const grid *g) {
    const leaf_header *h = &f->header;
    if (h->kind != (g->heights ? LEAF_KIND_HEIGHTS : LEAF_KIND_GRID))
        return further_step_refuse(f, input, "it is a %s, and the file is of none",
                                   g->heights ? "height field" : "grid");
    if (memcmp(h->dims, g->dims, sizeof h->dims) != 0)
        return further_step_refuse(f, input, "it has %u x %u x %u samples, expected %u x %u x %u",
                                   g->dims[0], g->dims[1], g->dims[2], h->dims[0], h->dims[1],
                                   h->dims[2]);
    if (h->source_type != (uint32_t)grid_source(g) ||
        h->sample_type != (uint32_t)sample_stored(g->type))
        return further_step_refuse(
            f, input, "its samples are %s, kept as %s, expected %s, kept as %s",
            sample_name(grid_source(g)), sample_name(sample_stored(g->type)),
            sample_name((sample_type)h->source_type), sample_name((sample_type)h->sample_type));
    bool same = h->rectilinear == grid_is_rectilinear(g) &&
                memcmp(h->to_world, g->to_world, sizeof h->to_world) == 0;
    for (int k = 0; k < 3 && same && h->rectilinear; k++)
        same = memcmp(f->axis[k], g->axis[k], h->dims[k] * sizeof *f->axis[k]) == 0;
    return same ? ST_OK
                : further_step_refuse(f, input,
                                      "it lies elsewhere in the world, or has other spacings");
}

/* What the input says of axes and units must be what the file says; it may say nothing. */
static status check_frame(const char *input, const leaf_file *f, const grid *g,
                          const leaf_sets *sets) {
    const world_frame *own = &g->frame, *its = &f->frame;
    const char *time_unit = sets->time_unit ? sets->time_unit : own->time_unit;
    bool same = !own->axes || own->axes == its->axes;
    for (int k = 0; k < 3; k++)
        same = same && (!*own->unit[k] || strcmp(own->unit[k], its->unit[k]) == 0);
    if (!same)
        return further_step_refuse(f, input, "its axes or units are not the file's");
    if (f->has_times && *time_unit && strcmp(time_unit, its->time_unit) != 0)
        return further_step_refuse(f, input, "its times are in %s, expected %s", time_unit,
                                   *its->time_unit ? its->time_unit : "no unit");
    return ST_OK;
}

status convert_grid_append_check(const convert_request *a, const grid *g, leaf_sets *sets) {
    if (!a->grow)
        return ST_OK;
    const leaf_file *f = leaf_grow_before(a->grow);
    status st = check_grid(a->common.input, f, g);
    if (st == ST_OK)
        st = check_frame(a->common.input, f, g, sets);
    return st == ST_OK ? convert_append_check(a, sets) : st;
}
