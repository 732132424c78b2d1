#include "prep/resample/resample.h"

#include <math.h>
#include <string.h>

#include "formats/base/pool.h"
#include "formats/leaf/leaf_unpacker.h"
#include "prep/resample/resample_cells.h"

/* Treelets in memory per thread, and shares of rows per thread. */
enum { BATCH_PER_THREAD = 16, SHARES_PER_THREAD = 4 };
/* Bytes for bookkeeping that the plan does not count: heads of blocks, the pool. */
enum { SPARE_BYTES = 16 << 10 };

typedef struct job {
    leaf_file *f;
    const resample_cells *cells; /* how f's are read and drawn */
    const resample_options *o;
    const progress *p;
    resample_take take;
    void *ctx;
    mem *m;
    pool *workers;
    resample_block block;
    uint64_t rows_most; /* most rows of a slab */
    size_t room;        /* bytes for a treelet's payloads */
    /* The batch: treelets in ascending order. */
    size_t most, count;
    resample_treelet *treelets;
    char *rooms;
    leaf_unpacker **unpackers;
    /* Rows that the batch reaches, and the number of shares they are cut into. */
    uint64_t first_row, rows;
    size_t shares;
    resample_result *result;
} job;

/* ---- the grid ---- */

static double longest_of(const double extent[3]) {
    double longest = extent[0] > extent[1] ? extent[0] : extent[1];
    return longest > extent[2] ? longest : extent[2];
}

/* Divide the box into steps of about equal length, `steps` along the longest edge. Returns the
 * number of nodes. */
static double divide(const double extent[3], uint32_t steps, uint32_t dims[3]) {
    const double longest = longest_of(extent);
    double nodes = 1;
    for (int a = 0; a < 3; a++) {
        const double own = floor(steps * (extent[a] / longest) + 0.5);
        dims[a] = own < 1 ? 2 : (uint32_t)own + 1;
        nodes *= dims[a];
    }
    return nodes;
}

/* Choose as many nodes as allowed, up to rounding, with at least 2 per axis. */
static void divide_into(const double extent[3], uint64_t nodes, uint32_t dims[3]) {
    uint32_t few = 1, many = GRID_DIM_MAX;
    while (many - few > 1) {
        const uint32_t middle = few + (many - few) / 2;
        if (divide(extent, middle, dims) <= (double)nodes)
            few = middle;
        else
            many = middle;
    }
    (void)divide(extent, few, dims);
}

static status choose_dims(const resample_wish *w, const double extent[3], uint32_t dims[3]) {
    if (w->dims[0] > 0 && w->dims[1] > 0) {
        memcpy(dims, w->dims, sizeof w->dims);
        return ST_OK;
    }
    if (w->dims[0] > 0) {
        (void)divide(extent, w->dims[0] - 1, dims);
        return ST_OK;
    }
    if (!(w->spacing > 0)) {
        divide_into(extent, w->nodes, dims);
        return ST_OK;
    }
    for (int a = 0; a < 3; a++) {
        const double steps = floor(extent[a] / w->spacing);
        if (!(steps < GRID_DIM_MAX))
            return status_describe(ST_UNSUPPORTED,
                                   "a spacing of %g makes more than %d nodes along %c", w->spacing,
                                   GRID_DIM_MAX, "xyz"[a]);
        dims[a] = steps < 1 ? 2 : (uint32_t)steps + 1;
    }
    return ST_OK;
}

/* The largest spacing whose last node is not beyond hi. */
static double fit(const resample_grid *g, int a, double hi) {
    resample_grid fitting = *g;
    fitting.spacing[a] = (hi - g->origin[a]) / (g->dims[a] - 1);
    while (resample_grid_node(&fitting, a, g->dims[a] - 1) > hi)
        fitting.spacing[a] = nextafter(fitting.spacing[a], 0);
    return fitting.spacing[a];
}

status resample_grid_choose(const resample_wish *w, const float bounds[6], const char *name,
                            resample_grid *g, grid *out) {
    double extent[3], hi[3];
    for (int a = 0; a < 3; a++) {
        g->origin[a] = w->bounded ? w->box[a] : (double)bounds[a];
        hi[a] = w->bounded ? w->box[a + 3] : (double)bounds[a + 3];
        extent[a] = hi[a] - g->origin[a];
        if (!(extent[a] > 0 && extent[a] < (double)INFINITY))
            return status_describe(ST_UNSUPPORTED, "the box to resample has no extent along %c",
                                   "xyz"[a]);
    }
    status st = choose_dims(w, extent, g->dims);
    if (st != ST_OK)
        return st;
    for (int a = 0; a < 3; a++) {
        g->spacing[a] = w->spacing > 0 ? w->spacing : fit(g, a, hi[a]);
        if (!(g->spacing[a] >= 0x1p-46 * fmax(fabs(g->origin[a]), fabs(hi[a]))))
            return status_describe(
                ST_UNSUPPORTED,
                "nodes %g apart cannot be told apart so far from the origin along %c",
                g->spacing[a], "xyz"[a]);
    }
    grid_init(out, g->dims, SAMPLE_F32);
    for (int a = 0; a < 3; a++) {
        out->to_world[a][a] = g->spacing[a];
        out->to_world[a][3] = g->origin[a];
    }
    memcpy(out->name, name, strnlen(name, sizeof out->name - 1));
    return grid_check_volume(out, "the grid");
}

/* ---- memory ---- */

/* Choose the rows and treelets held at a time, within the budget. */
static status plan(job *j) {
    const resample_grid *g = j->block.grid;
    const uint64_t row = g->dims[0] * sizeof(float), all = (uint64_t)g->dims[1] * g->dims[2];
    const uint64_t threads = (uint64_t)j->o->threads;
    j->room = (size_t)j->cells->payloads(j->f, j->o->set) * resample_treelet_payload_bytes(j->f);
    const uint64_t each = j->room + sizeof *j->treelets;
    const uint64_t fixed = mem_used(j->m) + SPARE_BYTES + threads * leaf_unpacker_memory(j->f);
    const uint64_t least = fixed + each + row;
    if (least > j->o->memory)
        return status_describe(
            ST_NOMEM, "a memory budget of %llu KiB is too small: this mesh and grid need %llu KiB",
            (unsigned long long)(j->o->memory >> 10), (unsigned long long)((least >> 10) + 1));
    const uint64_t left = j->o->memory - fixed, fitting = left / 4 / each;
    j->most = threads * BATCH_PER_THREAD;
    if (j->most > fitting)
        j->most = fitting > 0 ? (size_t)fitting : 1;
    if (j->most > j->f->layout.treelets)
        j->most = j->f->layout.treelets;
    uint64_t rows = (left - j->most * each) / row;
    if (rows > g->dims[1])
        rows -= rows % g->dims[1];
    j->rows_most = rows < all ? rows : all;
    return ST_OK;
}

static status allocate(job *j) {
    status st = pool_create(j->m, j->o->threads, &j->workers);
    if (st == ST_OK)
        st = plan(j);
    if (st != ST_OK)
        return st;
    j->block.samples =
        mem_alloc(j->m, (size_t)(j->rows_most * j->block.grid->dims[0]) * sizeof(float));
    j->treelets = mem_array(j->m, j->most, sizeof *j->treelets);
    j->rooms = mem_alloc(j->m, j->most * j->room);
    if (!j->block.samples || !j->treelets || !j->rooms)
        return ST_NOMEM;
    return leaf_unpackers_create(j->m, j->f, j->o->threads, &j->unpackers);
}

static void release(job *j) {
    mem_free(j->m, j->block.samples);
    mem_free(j->m, j->treelets);
    mem_free(j->m, j->rooms);
    leaf_unpackers_destroy(j->m, j->unpackers, j->o->threads);
    pool_destroy(j->workers);
}

/* ---- a batch ---- */

static status load_one(void *ctx, size_t index, int worker) {
    const job *j = ctx;
    return j->cells->load(&j->treelets[index], j->unpackers[worker]);
}

/* Draw a share. Shares are cut so that each thread has its own rows. */
static status draw_share(void *ctx, size_t index, int worker) {
    const job *j = ctx;
    (void)worker;
    const uint64_t first = j->first_row + j->rows * index / j->shares,
                   end = j->first_row + j->rows * (index + 1) / j->shares;
    for (size_t i = 0; i < j->count && end > first; i++)
        j->cells->draw(&j->block, first, end - first, &j->treelets[i]);
    return ST_OK;
}

/* Find the block's rows that a treelet's box reaches. Returns false if there are none. */
static bool reach(const job *j, uint32_t t, uint64_t *first_row, uint64_t *end_row) {
    const resample_grid *g = j->block.grid;
    const leaf_layout *l = &j->f->layout;
    const float(*bounds)[6] = j->f->geometry->section(j->f, LEAF_SECTION_BOUNDS);
    const float *b = bounds[leaf_layout_bounds(l, leaf_layout_step(l, j->o->set), t)];
    uint32_t first[3], end[3];
    for (int a = 0; a < 3; a++) {
        resample_grid_nodes(g, a, (double)b[a], (double)b[a + 3], &first[a], &end[a]);
        if (first[a] == end[a])
            return false;
    }
    const uint64_t lowest = (uint64_t)first[2] * g->dims[1] + first[1],
                   highest = (end[2] - (uint64_t)1) * g->dims[1] + end[1];
    const uint64_t block_end = j->block.first_row + j->block.rows;
    *first_row = lowest > j->block.first_row ? lowest : j->block.first_row;
    *end_row = highest < block_end ? highest : block_end;
    return *first_row < *end_row;
}

static status draw_batch(job *j) {
    j->shares = j->o->threads > 1 ? (size_t)j->o->threads * SHARES_PER_THREAD : 1;
    status st = pool_run(j->workers, j->count, load_one, j);
    for (size_t i = 0; i < j->count; i++) {
        uint32_t parts[LEAF_PARTS_MAX];
        const int count = j->f->geometry->parts(&j->f->layout, j->o->set, j->treelets[i].id, parts);
        for (int k = 0; k < count; k++)
            j->result->bytes_read += j->f->sizes[parts[k]];
    }
    return st == ST_OK ? pool_run(j->workers, j->shares, draw_share, j) : st;
}

/* ---- slab by slab ---- */

static status draw_slab(job *j) {
    const uint32_t treelets = j->f->layout.treelets;
    const double slabs = (double)j->block.grid->dims[1] * j->block.grid->dims[2];
    uint64_t end_row = 0;
    j->count = 0;
    j->first_row = UINT64_MAX;
    for (uint32_t t = 0; t < treelets; t++) {
        uint64_t first, end;
        if (reach(j, t, &first, &end)) {
            j->treelets[j->count] =
                (resample_treelet){j->f, j->o->set, t, j->rooms + j->count * j->room};
            j->count++;
            j->first_row = first < j->first_row ? first : j->first_row;
            end_row = end > end_row ? end : end_row;
        }
        if (j->count == 0 || (j->count < j->most && t + 1 < treelets))
            continue;
        j->rows = end_row - j->first_row;
        const double part = (double)t / treelets * (double)j->block.rows;
        status st = draw_batch(j);
        if (st == ST_OK)
            st = progress_step(j->p, "resample", ((double)j->block.first_row + part) / slabs);
        if (st != ST_OK)
            return st;
        j->count = 0;
        j->first_row = UINT64_MAX;
        end_row = 0;
    }
    return ST_OK;
}

static status make_slabs(job *j) {
    const uint32_t *dims = j->block.grid->dims;
    const uint64_t all = (uint64_t)dims[1] * dims[2];
    for (uint64_t row = 0; row < all; row += j->block.rows) {
        /* Take whole planes, or rows of one plane. */
        const uint64_t left = j->rows_most < dims[1] ? dims[1] - row % dims[1] : all - row;
        j->block.first_row = row;
        j->block.rows = j->rows_most < left ? j->rows_most : left;
        resample_block_clear(&j->block);
        status st = draw_slab(j);
        if (st != ST_OK)
            return st;
        j->result->held += resample_block_finish(&j->block);
        j->result->slabs++;
        st = j->take(j->ctx, j->block.samples, (size_t)(j->block.rows * dims[0]));
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

status resample_run(mem *m, leaf_file *f, const resample_grid *g, const resample_options *o,
                    const progress *p, resample_take take, void *ctx, resample_result *result) {
    *result = (resample_result){.nodes = (uint64_t)g->dims[0] * g->dims[1] * g->dims[2]};
    job j = {.f = f,
             .cells = resample_cells_of(f),
             .o = o,
             .p = p,
             .take = take,
             .ctx = ctx,
             .m = m,
             .block = {.grid = g},
             .result = result};
    status st = allocate(&j);
    if (st == ST_OK)
        st = make_slabs(&j);
    release(&j);
    return st == ST_OK ? progress_step(p, "resample", 1) : st;
}
