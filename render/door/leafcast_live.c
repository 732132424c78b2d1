/* leafcast_live.c - volumes whose samples a running program gives. */
#include <float.h>
#include <string.h>

#include "formats/leaf/leaf_live.h"
#include "formats/public_grid.h"
#include "render/door/arguments.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"

/* ---- Opening ---- */

static status open_grid(leafcast *v, const void *from) {
    grid g;
    status st = public_grid_make(v->m, from, &g);
    if (st == ST_OK)
        st = leaf_live_open(v->m, &g, v->device->isa, v->threads, &v->file);
    grid_release(&g, v->m);
    if (st == ST_OK)
        st = live_steps_create(v->m, v->file, &v->live);
    return st;
}

leafcast_status leafcast_open_live(const leafcast_grid *from, const leafcast_options *options,
                                   leafcast **volume) {
    status st = public_needs(__func__, "grid volume", (const void *[]){from, volume});
    if (st == ST_OK)
        st = public_grid_check(from);
    return st == ST_OK ? volume_open_by(open_grid, from, options, volume) : public_status(st);
}

/* ---- Writing ---- */

static status check_live(const char *call, const leafcast *v) {
    const status st = arguments_check_volume(call, v);
    if (st != ST_OK || v->file->live)
        return st;
    return status_describe(ST_USAGE, "%s(): the volume is not of leafcast_open_live()", call);
}

static status take_region(const leafcast *v, const uint32_t *first, const uint32_t *size,
                          live_region *r) {
    const uint32_t *dims = v->file->header.dims;
    if (!first != !size)
        return status_describe(ST_USAGE, "leafcast_update(): %s is NULL, and %s is not",
                               first ? "size" : "first", first ? "first" : "size");
    for (int a = 0; a < 3; a++) {
        r->first[a] = first ? first[a] : 0;
        r->size[a] = size ? size[a] : dims[a];
        if (r->first[a] > dims[a] || r->size[a] > dims[a] - r->first[a])
            return status_describe(ST_USAGE,
                                   "leafcast_update(): %u nodes from number %u on along %c: there "
                                   "are %u",
                                   r->size[a], r->first[a], "xyz"[a], dims[a]);
    }
    return ST_OK;
}

static void take_strides(const ptrdiff_t *strides, live_region *r) {
    ptrdiff_t dense = (ptrdiff_t)sample_size(r->type);
    for (int a = 0; a < 3; a++) {
        r->strides[a] = strides ? strides[a] : dense;
        dense *= (ptrdiff_t)r->size[a];
    }
}

leafcast_status leafcast_update(leafcast *v, const uint32_t first[3], const uint32_t size[3],
                                const void *samples, const ptrdiff_t strides[3]) {
    live_region r = {.samples = samples};
    status st = check_live(__func__, v);
    if (st == ST_OK)
        st = take_region(v, first, size, &r);
    if (st != ST_OK || !r.size[0] || !r.size[1] || !r.size[2])
        return public_status(st);
    r.type = (sample_type)v->file->header.source_type;
    take_strides(strides, &r);
    st = public_needs(__func__, "samples", (const void *[]){samples});
    if (st == ST_OK)
        st = public_grid_check_strides(r.size, r.strides);
    return public_status(st == ST_OK ? live_steps_put(v->live, &r) : st);
}

leafcast_status leafcast_commit(leafcast *v, double time) {
    status st = check_live(__func__, v);
    if (st == ST_OK)
        st = public_in_range(__func__, "time", time, -DBL_MAX, DBL_MAX);
    return public_status(st == ST_OK ? live_steps_commit(v->live, time) : st);
}
