#include "prep/grid/grid_series.h"

#include <string.h>

#include "prep/series_check.h"

status grid_series_open(mem *m, const grid_series *s, uint32_t set, volume **out) {
    volume_hints hints = s->hints;
    if (s->sets.names)
        hints.field = s->sets.names[set / s->sets.steps];
    return volume_open(m, s->paths[set % s->sets.steps], &hints, out);
}

/* ---- what can be one ---- */

static bool same_place(const grid *a, const grid *b) {
    if (memcmp(a->to_world, b->to_world, sizeof a->to_world) != 0 ||
        grid_is_rectilinear(a) != grid_is_rectilinear(b))
        return false;
    for (int i = 0; i < 3 && grid_is_rectilinear(a); i++)
        if (memcmp(a->axis[i], b->axis[i], a->dims[i] * sizeof *a->axis[i]) != 0)
            return false;
    return true;
}

/* name: of what g is. */
static status check_like(const grid *g, const grid *first, const char *name) {
    const sample_type type = sample_stored(g->type), wanted = sample_stored(first->type);
    if (memcmp(g->dims, first->dims, sizeof g->dims) != 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: has %u x %u x %u samples, expected %u x %u x %u as the first",
                               name, g->dims[0], g->dims[1], g->dims[2], first->dims[0],
                               first->dims[1], first->dims[2]);
    if (type != wanted)
        return status_describe(ST_UNSUPPORTED,
                               "%s: has samples of type %s, expected %s as the first", name,
                               sample_name(grid_source(g)), sample_name(grid_source(first)));
    if (!same_place(g, first))
        return status_describe(ST_UNSUPPORTED,
                               "%s: its samples lie elsewhere in the world than those of the first",
                               name);
    return ST_OK;
}

static status check_set(mem *m, const grid_series *s, uint32_t set, const grid *first) {
    volume *v = NULL;
    status st = grid_series_open(m, s, set, &v);
    if (st == ST_OK)
        st = check_like(volume_grid(v), first, s->paths[set % s->sets.steps]);
    volume_close(v);
    return st;
}

status grid_series_check(mem *m, const grid_series *s, const volume *first) {
    status st = series_check(s->paths, &s->sets);
    for (uint32_t set = 1; set < s->sets.fields * s->sets.steps && st == ST_OK; set++)
        st = check_set(m, s, set, volume_grid(first));
    return st;
}
