#include "formats/leaf/leaf_live.h"

#include <math.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/leaf/leaf_geometry.h"

enum { HALO = 1 };

/* ---- Making ---- */

static void fill_header(leaf_file *f, const grid *g) {
    leaf_header *h = &f->header;
    const uint64_t bytes = grid_samples(g) * sample_size(f->layout.type);
    *h = (leaf_header){.version = LEAF_VERSION,
                       .kind = LEAF_KIND_GRID,
                       .sample_type = f->layout.type,
                       .source_type = g->type,
                       .levels = f->layout.levels,
                       .cells_log2 = f->layout.cells_log2,
                       .halo = f->layout.halo,
                       .block_log2 = LEAF_BLOCK_LOG2,
                       .codec = LEAF_CODEC_ZSTD, /* as if packed: nothing is used where it lies */
                       .rectilinear = grid_is_rectilinear(g),
                       .fields = 1,
                       .steps = LIVE_BUFFERS,
                       .outside = 1,
                       .treelets = f->layout.treelets,
                       .payload_bytes = bytes,
                       .file_bytes = bytes,
                       .bare = f->layout.levels > 1};
    memcpy(h->dims, g->dims, sizeof h->dims);
    memcpy(h->to_world, g->to_world, sizeof h->to_world);
}

static status lay_out(leaf_file *f, const grid *g) {
    leaf_layout *l = &f->layout;
    const status st =
        leaf_layout_init(l, f->m, g->dims, LIVE_BLOCK_LOG2, HALO, sample_stored(g->type));
    if (st != ST_OK)
        return st;
    if (!leaf_layout_repeat(l, 1, LIVE_BUFFERS, false))
        return status_describe(ST_UNSUPPORTED, "%u treelets are too many for two steps",
                               l->treelets);
    l->coded = l->outside = true;
    leaf_layout_bare(l);
    return ST_OK;
}

/* Copy the coordinates of all axes into one block, which axis[0] owns. */
static status take_axes(leaf_file *f, const grid *g) {
    const size_t count = (size_t)g->dims[0] + g->dims[1] + g->dims[2];
    double *at = f->axis[0] = mem_array(f->m, count, sizeof *at);
    if (!at)
        return ST_NOMEM;
    for (int a = 0; a < 3; at += g->dims[a++]) {
        f->axis[a] = at;
        for (uint32_t i = 0; i < g->dims[a]; i++)
            at[i] = grid_is_rectilinear(g) ? g->axis[a][i] : i;
    }
    return ST_OK;
}

static status make(leaf_file *f, const grid *g, cpu_isa isa, int threads) {
    status st = file_open_memory(f->m, "the live volume", "", 0, &f->source);
    if (st == ST_OK)
        st = lay_out(f, g);
    if (st != ST_OK)
        return st;
    f->geometry = leaf_geometry_of(LEAF_KIND_GRID);
    fill_header(f, g);
    snprintf(f->name, sizeof f->name, "%s", *g->name ? g->name : "live");
    f->frame = g->frame;
    st = take_axes(f, g);
    if (st == ST_OK)
        st = leaf_file_allocate_changing(f);
    if (st == ST_OK)
        st = live_samples_create(f->m, g->dims, f->layout.type, isa, threads, &f->live);
    for (uint32_t step = 0; step < LIVE_BUFFERS && st == ST_OK; step++)
        st = leaf_live_finish(f, step, 0.0);
    return st;
}

status leaf_live_open(mem *m, const grid *g, cpu_isa isa, int threads, leaf_file **out) {
    leaf_file *f = mem_zalloc(m, sizeof *f);
    if (!f)
        return ST_NOMEM;
    f->m = m;
    const status st = make(f, g, isa, threads);
    if (st != ST_OK) {
        leaf_file_close(f);
        return st;
    }
    *out = f;
    return ST_OK;
}

/* ---- Writing ---- */

status leaf_live_put(leaf_file *f, uint32_t step, const live_region *r) {
    return live_samples_put(f->live, (int)step, r);
}

/* What the directory says of a treelet of level 0. */
static void describe(leaf_file *f, uint32_t step, uint32_t t) {
    const uint32_t p = leaf_layout_samples(&f->layout, step, t), *place = f->layout.place[t];
    const live_range r = live_samples_range(f->live, place);
    f->own[p][0] = r.lo + 0.0f; /* no -0 */
    f->own[p][1] = r.hi + 0.0f;
    f->flags[p] = r.bad ? LEAF_FLAG_NON_FINITE : 0;
    f->checksums[p] = live_samples_stamp(f->live, place);
}

/* Children come behind their parents: from the last treelet to the root. */
static void merge(leaf_file *f, uint32_t step, uint32_t t) {
    const leaf_layout *l = &f->layout;
    const uint32_t p = leaf_layout_samples(l, step, t);
    if (l->level_of[t] == 0) {
        describe(f, step, t);
    } else {
        f->own[p][0] = INFINITY;
        f->own[p][1] = -INFINITY;
    }
    float lo = f->own[p][0], hi = f->own[p][1];
    const uint32_t first = leaf_layout_samples(l, step, l->first_child[t]);
    const int children = __builtin_popcount(leaf_layout_children(l, t));
    for (int i = 0; i < children; i++) {
        lo = fminf(lo, f->ranges[first + (uint32_t)i][0]);
        hi = fmaxf(hi, f->ranges[first + (uint32_t)i][1]);
    }
    f->ranges[p][0] = lo;
    f->ranges[p][1] = hi;
}

status leaf_live_finish(leaf_file *f, uint32_t step, double time) {
    const status st = live_samples_finish(f->live, (int)step);
    if (st != ST_OK)
        return st;
    for (uint32_t t = f->layout.treelets; t-- > 0;)
        merge(f, step, t);
    f->times[step] = time;
    f->versions[step]++;
    return ST_OK;
}
