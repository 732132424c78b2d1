#include "prep/curvilinear/curvilinear_coarse.h"

#include "formats/base/file.h"
#include "prep/curvilinear/curvilinear_thinned.h"
#include "prep/resample/coarse_grids.h"

enum { THINNED_CELLS = 1 << 18 }; /* at most: they are soon read (stream/README.md) */

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

static status make_thinned(const void *ctx, mem *m, leaf_file *f, uint32_t set, const char *path,
                           const progress *p, bool *made) {
    const curvilinear_options *of = ctx;
    const curvilinear_options o = {.file = of->file,
                                   .memory = of->memory,
                                   .threads = of->threads,
                                   .force = true,
                                   .coarse = true,
                                   .coarse_regular = true};
    curvilinear_thinned t;
    const curvilinear_series series = {
        &t, open_thinned, path_of_thinned, {.fields = 1, .steps = 1}, true};
    curvilinear_result unused;
    *made = true;
    status st = curvilinear_thinned_init(&t, m, f, set, curvilinear_thinned_log2(f, THINNED_CELLS));
    if (st == ST_OK)
        st = curvilinear_convert(m, &series, f->header.name, path, &o, p, &unused);
    curvilinear_thinned_release(&t);
    return st;
}

static bool is_regular(const curvilinear_options *o) {
    return o->coarse_regular || o->coarse_dims;
}

double curvilinear_coarse_share(const curvilinear_options *o) {
    return !o->coarse ? 0.0 : is_regular(o) ? 0.5 : 0.1;
}

status curvilinear_coarse_embed(mem *m, leaf_writer *w, const char *output,
                                const curvilinear_options *o, const progress *p) {
    const coarse_grids regular = {.dims = o->coarse_dims,
                                  .file = o->file,
                                  .memory = o->memory,
                                  .threads = o->threads,
                                  .output = output,
                                  .inside = o->coarse_regular};
    const coarse_maker maker =
        is_regular(o) ? coarse_grids_maker(&regular) : (coarse_maker){o, make_thinned};
    return coarse_parts_embed(m, w, output, &maker, p);
}
