#include "prep/grid/grid_levels.h"

#include "prep/grid/grid_families.h"

/* So many bytes of slices at once, as nothing can be stopped meanwhile. */
enum { PUSH_BYTES = 64 << 20 };

static status store_slices(grid_conversion *c, uint32_t level, read_slices in) {
    slab *s = c->stages[level].slab;
    const uint32_t *dims = c->layout->level[level].dims;
    const size_t slice_bytes = (size_t)dims[0] * dims[1] * sample_size(c->layout->type);
    while (in.count > 0) {
        uint32_t room = slab_room(s), some = in.count < room ? in.count : room;
        status st = slab_store(s, c->workers, in.samples, in.busy, some);
        while (st == ST_OK && slab_complete(s))
            st = grid_families_take(c, level);
        if (st != ST_OK)
            return st;
        in.samples += some * slice_bytes;
        in.busy += some * slice_tiles_count(dims);
        in.count -= some;
    }
    return ST_OK;
}

bool grid_levels_pass(grid_conversion *c) {
    bool any = false;
    while (c->slices_done >= c->slabs.at.slices) {
        any = true;
        if (!leaf_slabs_next(&c->slabs, c->layout))
            break;
    }
    return any;
}

/* Take slices that complete no slab, but by the last of them: then slabs are complete in the order
 * of the file. */
static status push(grid_conversion *c, read_slices in) {
    for (uint32_t level = 0; in.count > 0; level++) {
        status st = store_slices(c, level, in);
        const grid_stage *s = &c->stages[level];
        if (st != ST_OK || !s->up)
            return st;
        uint32_t coarse = pyramid_ready(s->up, in.count);
        st = pyramid_feed(s->up, c->workers, in.samples, in.busy, in.count, s->coarse, s->busy);
        if (st == ST_OK && s->deviation)
            st = deviation_build_feed(s->deviation, c->workers,
                                      &(deviation_slices){in.samples, in.busy, in.count},
                                      &(deviation_slices){s->coarse, s->busy, coarse});
        if (st != ST_OK)
            return st;
        in = (read_slices){s->coarse, s->busy, coarse};
    }
    return ST_OK;
}

/* *complete: set when a slab is. */
static status push_batch(grid_conversion *c, read_slices in, bool *complete) {
    const uint32_t *dims = c->layout->level[0].dims;
    const size_t slice_bytes = (size_t)dims[0] * dims[1] * sample_size(c->layout->type);
    while (in.count > 0) {
        const uint32_t until = c->slabs.at.slices - c->slices_done;
        uint32_t some = in.count < until ? in.count : until;
        if (some * slice_bytes > PUSH_BYTES)
            some = slice_bytes < PUSH_BYTES ? (uint32_t)(PUSH_BYTES / slice_bytes) : 1;
        status st = push(c, (read_slices){in.samples, in.busy, some});
        if (st == ST_OK)
            st = progress_ask(c->p, "convert");
        if (st != ST_OK)
            return st;
        c->slices_done += some;
        *complete |= grid_levels_pass(c);
        in.samples += some * slice_bytes;
        in.busy += some * slice_tiles_count(dims);
        in.count -= some;
    }
    return ST_OK;
}

status grid_levels_run(grid_conversion *c) {
    status st = progress_step(c->p, "convert", grid_conversion_share(c));
    if (st != ST_OK)
        return st;
    for (bool complete = false;;) {
        read_slices in;
        const uint32_t needed = slab_needed(c->stages[0].slab);
        st = read_ahead_next(c->input, needed, c->plan->batch, &in);
        if (st != ST_OK || in.count == 0)
            return st;
        st = push_batch(c, in, &complete);
        if (st == ST_OK)
            st = progress_step(c->p, "convert", grid_conversion_share(c));
        if (st == ST_OK && complete && c->o->work && work_folder_due(c->o->work)) {
            st = grid_conversion_save(c);
            complete = false;
        }
        if (st != ST_OK)
            return st;
    }
}
