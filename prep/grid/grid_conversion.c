#include "prep/grid/grid_conversion.h"

double grid_conversion_share(const grid_conversion *c) {
    return (c->set + (double)c->slices_done / c->layout->level[0].dims[2]) / c->layout->sets;
}

status grid_conversion_keep_head(void *ctx, state_io *io) {
    grid_conversion *c = ctx;
    if (c->input)
        c->past = read_ahead_seen(c->input);
    status st = convert_job_keep(c->o->job, io);
    if (st == ST_OK)
        st = STATE_IO(io, c->set);
    if (st == ST_OK)
        st = STATE_IO(io, c->slices_done);
    if (st == ST_OK)
        st = STATE_IO(io, c->seen);
    if (st == ST_OK)
        st = STATE_IO(io, c->past);
    if (st == ST_OK)
        st = STATE_IO(io, c->absent);
    return st == ST_OK ? STATE_IO(io, c->marker) : st;
}

static status keep_stage(grid_stage *s, state_io *io) {
    status st = slab_keep(s->slab, io);
    if (st == ST_OK && s->up)
        st = pyramid_keep(s->up, io);
    return st == ST_OK && s->deviation ? deviation_build_keep(s->deviation, io) : st;
}

status grid_conversion_keep(void *ctx, state_io *io) {
    grid_conversion *c = ctx;
    status st = grid_conversion_keep_head(c, io);
    if (st == ST_OK)
        st = leaf_writer_keep(c->writer, io);
    if (st == ST_OK && c->cells)
        st = state_io_bytes(io, c->cells, c->draw.count * sizeof *c->cells);
    for (uint32_t level = 0; level < c->layout->sampled && st == ST_OK; level++)
        st = keep_stage(&c->stages[level], io);
    return st == ST_OK ? state_io_end(io) : st;
}

status grid_conversion_save(grid_conversion *c) {
    out_file *files[WORK_FILES] = {0};
    leaf_writer_files(c->writer, files);
    return work_folder_save(c->o->work, files, grid_conversion_share(c), grid_conversion_keep, c);
}
