#include "prep/import/netcdf/netcdf_slices.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/text.h"
#include "prep/import/netcdf/netcdf_classic.h"
#include "prep/import/netcdf/netcdf_variable.h"
#include "prep/import/packed_slices.h"

typedef struct netcdf_slices {
    mem *m;
    file *guard; /* the same file: it counts as an input, and is known to be one */
    int id;      /* -1: not open */
    netcdf_variable v;
    size_t start[NETCDF_RANK]; /* of the step */
    packed_slices slices;
} netcdf_slices;

static status failed(const char *path, const char *what, int error) {
    return status_describe(error == NC_ENOMEM ? ST_NOMEM : ST_CORRUPT, "%s: %s: libnetcdf: %s",
                           path, what, nc_strerror(error));
}

static void close_slices(void *ctx) {
    netcdf_slices *s = ctx;
    packed_slices_end(&s->slices);
    if (s->id >= 0)
        nc_close(s->id);
    file_close(s->guard);
    mem_free(s->m, s);
}

static status create(mem *m, const import_request *q, netcdf_slices **out) {
    netcdf_slices *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->id = -1;
    status st = file_open(m, q->paths[0], &s->guard);
    if (st == ST_OK) {
        const int error = nc_open(q->paths[0], NC_NOWRITE, &s->id);
        if (error != NC_NOERR) {
            s->id = -1;
            st = failed(q->paths[0], "opening", error);
        }
    }
    if (st != ST_OK) {
        close_slices(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

/* ---- walking through groups ---- */

typedef struct walk {
    const import_request *q;
    const import_list *to; /* NULL: search */
    int best;              /* how well the best one so far suits; 0: none does */
    netcdf_variable found;
    status st;
} walk;

enum { DEPTH_MAX = 32, GROUPS_MAX = 1024 };

static void take_listed(walk *w, const netcdf_variable *v) {
    import_item item = {.name = v->path, .type = v->type};
    for (int i = 0; i < 3 && i < v->rank; i++)
        item.shape[i] = v->count[v->rank - 1 - i];
    item.shape[3] = v->rank > 3 ? v->steps : 0;
    item.refuse = v->refuse[0] ? v->refuse : NULL;
    item.taken = w->best > 0 && v->group == w->found.group && v->id == w->found.id;
    w->st = w->to->take(w->to->ctx, &item);
}

/* 0: not at all. One that grows in its third dimension is likelier of pictures over time. */
static int suits(const netcdf_variable *v, const import_request *q) {
    if (v->refuse[0])
        return 0;
    for (int i = v->rank - 3; i < v->rank; i++)
        if (v->count[i] < 2)
            return 0;
    return 1 + 2 * ((v->steps > 1) == (q->step > 0)) + 4 * !(v->grows && v->rank == 3);
}

static void take(walk *w, const netcdf_variable *v) {
    const int score = w->q->field ? strcmp(w->q->field, v->path) == 0 : suits(v, w->q);
    if (w->to)
        take_listed(w, v);
    else if (score > w->best) {
        w->best = score;
        w->found = *v;
    }
}

static void walk_group(walk *w, int group, const char *prefix, int depth) {
    int variables = 0, groups = 0, ids[GROUPS_MAX];
    nc_inq_nvars(group, &variables);
    for (int i = 0; i < variables && w->st == ST_OK; i++) {
        netcdf_variable v;
        netcdf_variable_find(group, i, prefix, &v);
        take(w, &v);
    }
    if (depth == DEPTH_MAX || nc_inq_grps(group, &groups, NULL) != NC_NOERR ||
        groups > GROUPS_MAX || nc_inq_grps(group, NULL, ids) != NC_NOERR)
        return;
    for (int i = 0; i < groups && w->st == ST_OK; i++) {
        char name[NC_MAX_NAME + 1], path[NETCDF_PATH - NC_MAX_NAME];
        if (nc_inq_grpname(ids[i], name) == NC_NOERR &&
            snprintf(path, sizeof path, "%s%s/", prefix, name) < (int)sizeof path)
            walk_group(w, ids[i], path, depth + 1);
    }
}

status netcdf_slices_list(mem *m, const import_request *q, const import_list *to) {
    netcdf_slices *s = NULL;
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    walk w = {.q = q};
    walk_group(&w, s->id, "", 0);
    w.to = to;
    walk_group(&w, s->id, "", 0);
    close_slices(s);
    return w.st;
}

/* ---- choosing ---- */

static status choose(netcdf_slices *s, const import_request *q) {
    walk w = {.q = q};
    walk_group(&w, s->id, "", 0);
    s->v = w.found;
    if (w.best == 0 && q->field)
        return status_describe(ST_USAGE, "%s: no variable \"%s\"; --list tells what there is",
                               q->paths[0], q->field);
    if (w.best == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: no variable of numbers along x, y and z; --list tells what "
                               "there is",
                               q->paths[0]);
    if (s->v.refuse[0])
        return status_describe(ST_UNSUPPORTED, "%s: variable %s cannot be read: %s", q->paths[0],
                               s->v.path, s->v.refuse);
    return ST_OK;
}

/* The steps of several dimensions are counted through, the last one fastest. */
static status choose_step(netcdf_slices *s, const import_request *q) {
    const netcdf_variable *v = &s->v;
    uint64_t step = q->step;
    if (step >= v->steps)
        return status_describe(ST_USAGE, "%s: %s: --step %u: it has %llu, counted from 0",
                               q->paths[0], v->path, q->step, (unsigned long long)v->steps);
    for (int i = v->rank - 4; i >= 0; i--) {
        s->start[i] = step % v->count[i];
        step /= v->count[i];
    }
    return ST_OK;
}

/* ---- reading ---- */

static status load_slab(void *ctx, uint32_t first, uint32_t count, void *stored) {
    netcdf_slices *s = ctx;
    const netcdf_variable *v = &s->v;
    size_t start[NETCDF_RANK], size[NETCDF_RANK];
    for (int i = 0; i < v->rank; i++) {
        start[i] = s->start[i];
        size[i] = i < v->rank - 3 ? 1 : v->count[i];
    }
    start[v->rank - 3] = first;
    size[v->rank - 3] = count;
    const int error = nc_get_vara(v->group, v->id, start, size, stored);
    if (error == NC_NOERR)
        return ST_OK;
    char what[NETCDF_PATH + 64];
    snprintf(what, sizeof what, "%s, slices %u to %u (counted from 0)", v->path, first,
             first + count - 1);
    return failed(file_path(s->guard), what, error);
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    netcdf_slices *s = ctx;
    return packed_slices_read(&s->slices, first, count, slices);
}

static status begin_slices(netcdf_slices *s, const grid *g) {
    const netcdf_variable *v = &s->v;
    s->slices = (packed_slices){.m = s->m,
                                .file = file_path(s->guard),
                                .field = v->path,
                                .packed = v->packed,
                                .chunk_depth = v->chunk[v->rank - 3],
                                .chunk_bytes = v->chunk_bytes,
                                .load = load_slab,
                                .ctx = s};
    memcpy(s->slices.dims, g->dims, sizeof g->dims);
    /* Slabs are read by whole chunks: none has to be kept. Without success they are. */
    if (v->chunk_bytes)
        nc_set_var_chunk_cache(v->group, v->id, 0, 1, 0);
    return packed_slices_begin(&s->slices);
}

/* ---- opening ---- */

static status make_grid(netcdf_slices *s, bool indices, grid *g) {
    const netcdf_variable *v = &s->v;
    uint32_t dims[3];
    for (int a = 0; a < 3; a++) {
        const size_t n = v->count[v->rank - 1 - a];
        dims[a] = n < UINT32_MAX ? (uint32_t)n : UINT32_MAX;
    }
    grid_init(g, dims, packed_type(&v->packed));
    char name[NETCDF_PATH + 80];
    snprintf(name, sizeof name, v->units[0] ? "%s [%s]" : "%s", v->path, v->units);
    text_name(g->name, sizeof g->name, name);
    status st = grid_check(g, file_path(s->guard));
    return st == ST_OK ? netcdf_variable_place(s->m, file_path(s->guard), v, indices, g) : st;
}

status netcdf_slices_open(mem *m, const import_request *q, bool indices, slice_source *out) {
    netcdf_slices *s = NULL;
    grid g = {0};
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = choose(s, q);
    if (st == ST_OK)
        st = choose_step(s, q);
    if (st == ST_OK)
        st = netcdf_classic_check(s->guard, &s->v, s->start);
    if (st == ST_OK)
        st = make_grid(s, indices, &g);
    if (st == ST_OK)
        st = begin_slices(s, &g);
    if (st != ST_OK) {
        grid_release(&g, m);
        close_slices(s);
        return st;
    }
    *out = (slice_source){.format = "netCDF",
                          .name = file_path(s->guard),
                          .m = m,
                          .g = g,
                          .read = read_slices,
                          .close = close_slices,
                          .ctx = s};
    return ST_OK;
}
