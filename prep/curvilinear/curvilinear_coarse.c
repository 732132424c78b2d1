#include "prep/curvilinear/curvilinear_coarse.h"

#include "formats/base/file.h"
#include "prep/curvilinear/curvilinear_thinned.h"

enum {
    THINNED_CELLS = 1 << 18, /* at most: they are soon read (stream/README.md) */
    LOST_LOG2 = 3 /* of a regular grid's nodes' volumes, the share that may have no data */
};

/* ---- the same grid with fewer nodes ---- */

static status open_thinned(void *ctx, uint32_t step, const curvilinear_source **out) {
    const curvilinear_thinned *t = ctx;
    (void)step;
    *out = &t->source;
    return ST_OK;
}

static const char *path_of_thinned(void *ctx, uint32_t step) {
    const curvilinear_thinned *t = ctx;
    (void)step;
    return file_path(t->f->source);
}

static status make_thinned(const coarse_grids *of, mem *m, leaf_file *f, uint32_t set,
                           const char *path, const progress *p) {
    const curvilinear_options o = {
        .file = of->file, .memory = of->memory, .threads = of->threads, .force = true};
    curvilinear_thinned t;
    const curvilinear_series series = {
        &t, open_thinned, path_of_thinned, {.fields = 1, .steps = 1}, true};
    curvilinear_result unused;
    status st = curvilinear_thinned_init(&t, m, f, set, curvilinear_thinned_log2(f, THINNED_CELLS));
    if (st == ST_OK)
        st = curvilinear_convert(m, &series, f->header.name, path, &o, p, &unused);
    curvilinear_thinned_release(&t);
    return st;
}

/* ---- the choice ---- */

static bool loses_much(const coarse_grids_fill *fill) {
    return fill->cells < fill->nodes - (fill->nodes >> LOST_LOG2) || fill->cells == 0;
}

static status make(void *ctx, mem *m, leaf_file *f, uint32_t set, const char *path,
                   const progress *p) {
    curvilinear_coarse *c = ctx;
    if (!c->thinned) {
        coarse_grids_fill fill;
        const status st = coarse_grids_make(&c->regular, m, f, set, path, p, &fill);
        c->thinned = st == ST_OK && set == 0 && c->regular.dims == 0 && loses_much(&fill);
        if (!c->thinned)
            return st;
    }
    return make_thinned(&c->regular, m, f, set, path, p);
}

curvilinear_coarse curvilinear_coarse_of(const curvilinear_options *o) {
    return (curvilinear_coarse){
        .regular = {
            .dims = o->coarse_dims, .file = o->file, .memory = o->memory, .threads = o->threads}};
}

coarse_maker curvilinear_coarse_maker(curvilinear_coarse *c) {
    return (coarse_maker){c, make};
}
