#include "prep/import/netcdf/netcdf_slices.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/text.h"
#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/import_hint.h"
#include "prep/import/netcdf/netcdf_classic.h"
#include "prep/import/netcdf/netcdf_hdf5.h"
#include "prep/import/netcdf/netcdf_minc.h"
#include "prep/import/netcdf/netcdf_roles.h"
#include "prep/import/netcdf/netcdf_stay.h"
#include "prep/import/netcdf/netcdf_storage.h"
#include "prep/import/netcdf/netcdf_variable.h"
#include "prep/import/packed_slices.h"

typedef struct netcdf_slices {
    mem *m;
    file *guard; /* the same file, opened so that the guard knows it as an input */
    int id;      /* -1: not open */
    netcdf_storage storage;
    netcdf_variable v;
    size_t start[NETCDF_RANK]; /* of the step */
    packed_slices slices;
    netcdf_hdf5 place;
} netcdf_slices;

static status failed(const char *path, const char *what, int error) {
    return status_describe(error == NC_ENOMEM ? ST_NOMEM : ST_CORRUPT, "%s: %s: libnetcdf: %s",
                           path, what, nc_strerror(error));
}

static void close_slices(void *ctx) {
    netcdf_slices *s = ctx;
    packed_slices_end(&s->slices);
    netcdf_hdf5_release(&s->place);
    if (s->id >= 0)
        nc_close(s->id);
    file_close(s->guard);
    netcdf_storage_release(&s->storage);
    mem_free(s->m, s);
}

static status create(mem *m, const import_request *q, netcdf_slices **out) {
    netcdf_slices *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->id = -1;
    s->place = (netcdf_hdf5){.m = m, .tell_chunks = q->chunks};
    status st = file_open(m, q->paths[0], &s->guard);
    if (st == ST_OK)
        st = netcdf_storage_look(m, q->paths[0], &q->trust, &s->storage);
    if (st == ST_OK) {
        const int error = nc_open(q->paths[0], NC_NOWRITE, &s->id);
        if (error != NC_NOERR) {
            s->id = -1;
            st = hdf5_storage_denied();
            st = st == ST_OK ? failed(q->paths[0], "opening", error) : st;
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

/* How well a variable suits; the most important field first. */
typedef struct merit {
    bool suits, has_step, fixed;
    uint64_t samples, with_steps;
} merit;

typedef struct walk {
    const import_request *q;
    const netcdf_wish *wish;
    netcdf_roles *roles;
    void (*visit)(struct walk *w, netcdf_variable *v);
    const import_list *to; /* receiver of list_variable() */
    merit best;            /* of the best variable so far */
    netcdf_variable found;
    char map[NETCDF_PATH]; /* the first map that changes in time; "": there is none */
    status st;
} walk;

enum { DEPTH_MAX = 32, GROUPS_MAX = 1024 };

static void refuse_stack(walk *w, netcdf_variable *v) {
    char name[NC_MAX_NAME + 1] = "";
    if (w->wish->stack_time || v->refuse[0] || !netcdf_variable_stacked(v))
        return;
    nc_inq_dimname(v->group, v->dim[v->time], name);
    if (v->rank == 3 && !w->map[0])
        snprintf(w->map, sizeof w->map, "%s", v->path);
    if (v->rank == 3)
        snprintf(v->refuse, sizeof v->refuse,
                 "its dimension %.60s is time: a map that changes is no volume; import-netcdf "
                 "--stack-time makes its times slices along z",
                 name);
    else
        snprintf(v->refuse, sizeof v->refuse,
                 "its dimension %.60s is time, and must be in front of the others (ncpdq turns "
                 "dimensions)",
                 name);
}

static void walk_group(walk *w, int group, const char *prefix, int depth) {
    int variables = 0, groups = 0, ids[GROUPS_MAX];
    nc_inq_nvars(group, &variables);
    if (!w->visit)
        w->st = netcdf_roles_add(w->roles, group);
    for (int i = 0; i < variables && w->visit && w->st == ST_OK; i++) {
        netcdf_variable v;
        netcdf_variable_find(group, i, prefix, &v);
        refuse_stack(w, &v);
        w->visit(w, &v);
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

/* Visit the variables of all groups. visit NULL: gather their roles. */
static status walk_all(walk *w, int root, void (*visit)(walk *w, netcdf_variable *v)) {
    w->visit = visit;
    if (w->st == ST_OK)
        walk_group(w, root, "", 0);
    return w->st;
}

/* ---- choosing ---- */

static merit merit_of(const walk *w, const netcdf_variable *v) {
    merit x = {.samples = 1};
    if (v->refuse[0] || netcdf_roles_of(w->roles, v->group, v->id))
        return x;
    for (int i = v->rank - 3; i < v->rank; i++) {
        if (v->count[i] < 2)
            return x;
        x.samples *= v->count[i];
    }
    x.suits = true;
    x.has_step = v->steps > w->q->step;
    /* A variable that grows in its third dimension probably holds pictures over time. */
    x.fixed = !(v->grows && v->rank == 3);
    x.with_steps = x.samples * v->steps;
    return x;
}

static bool is_better(const merit *a, const merit *b) {
    if (a->suits != b->suits)
        return a->suits;
    if (a->has_step != b->has_step)
        return a->has_step;
    if (a->fixed != b->fixed)
        return a->fixed;
    return a->samples != b->samples ? a->samples > b->samples : a->with_steps > b->with_steps;
}

static void choose_variable(walk *w, netcdf_variable *v) {
    const char *field = w->q->field;
    merit x = {.suits = field && strcmp(field, v->path) == 0};
    if (!field)
        x = merit_of(w, v);
    if (!is_better(&x, &w->best))
        return;
    w->best = x;
    w->found = *v;
}

static status search(const netcdf_slices *s, walk *w) {
    status st = walk_all(w, s->id, NULL);
    return st == ST_OK ? walk_all(w, s->id, choose_variable) : st;
}

static status nothing_found(const walk *w) {
    const import_request *q = w->q;
    char hint[IMPORT_HINT_MAX];
    if (q->field)
        return status_describe(ST_USAGE, "%s: no variable \"%s\"; `%s' tells what there is",
                               q->paths[0], q->field, import_hint_list(q, hint));
    if (w->map[0])
        return status_describe(ST_UNSUPPORTED,
                               "%s: no variable of numbers along x, y and z: %s is a map that "
                               "changes in time; import-netcdf --stack-time makes its times "
                               "slices along z",
                               q->paths[0], w->map);
    return status_describe(ST_UNSUPPORTED,
                           "%s: no field of numbers along x, y and z; `%s' tells what there is",
                           q->paths[0], import_hint_list(q, hint));
}

static status choose(netcdf_slices *s, const import_request *q, const netcdf_wish *wish) {
    netcdf_roles roles = {.m = s->m};
    walk w = {.q = q, .wish = wish, .roles = &roles};
    status st = search(s, &w);
    netcdf_roles_release(&roles);
    s->v = w.found;
    if (st == ST_OK && !w.best.suits)
        st = nothing_found(&w);
    else if (st == ST_OK && s->v.refuse[0])
        st = status_describe(ST_UNSUPPORTED, "%s: variable %s cannot be read: %s", q->paths[0],
                             s->v.path, s->v.refuse);
    return st;
}

/* ---- listing ---- */

static void list_variable(walk *w, netcdf_variable *v) {
    const char *role = netcdf_roles_of(w->roles, v->group, v->id);
    import_item item = {.name = v->path, .type = v->type};
    for (int i = 0; i < 3 && i < v->rank; i++)
        item.shape[i] = v->count[v->rank - 1 - i];
    item.shape[3] = v->rank > 3 ? v->steps : 0;
    item.refuse = v->refuse[0] ? v->refuse : NULL;
    item.taken = w->best.suits && v->group == w->found.group && v->id == w->found.id;
    if (role)
        text_add(v->type, sizeof v->type, ", %s", role);
    double *times = NULL;
    char unit[WORLD_TIME_UNIT] = "";
    if (item.taken)
        w->st = netcdf_variable_times(w->roles->m, w->q->paths[0], v, &times, unit);
    item.times = times;
    item.time_unit = unit[0] ? unit : NULL;
    if (w->st == ST_OK)
        w->st = w->to->take(w->to->ctx, &item);
    if (times)
        mem_free(w->roles->m, times);
}

status netcdf_slices_list(mem *m, const import_request *q, const netcdf_wish *wish,
                          const import_list *to) {
    netcdf_slices *s = NULL;
    netcdf_roles roles = {.m = m};
    walk w = {.q = q, .wish = wish, .roles = &roles, .to = to};
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = search(s, &w);
    if (st == ST_OK)
        st = walk_all(&w, s->id, list_variable);
    netcdf_roles_release(&roles);
    close_slices(s);
    return st;
}

/* ---- steps ---- */

/* Count through the steps of several dimensions, the last one fastest. */
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
    /* Slabs are read in whole chunks, so none needs a cache. If this fails, chunks are cached. */
    if (v->chunk_bytes)
        nc_set_var_chunk_cache(v->group, v->id, 0, 1, 0);
    status st = v->minc && v->packed.has_range
                    ? netcdf_minc_scales(s->m, file_path(s->guard), v, s->start, &s->slices.scales)
                    : ST_OK;
    return st == ST_OK ? packed_slices_begin(&s->slices) : st;
}

static bool find_place(void *ctx, sample_place *out) {
    netcdf_slices *s = ctx;
    return netcdf_stay_find(s->guard, &s->v, s->start, out) ||
           netcdf_hdf5_find(file_path(s->guard), &s->v, s->start, &s->place, out);
}

/* ---- opening ---- */

static status check_absent(const netcdf_slices *s, const import_request *q) {
    const absent_parts absent = netcdf_storage_absent(&s->storage, s->v.path);
    return absent_check(&absent, q->paths[0], q->trust.allow_missing);
}

static status make_grid(netcdf_slices *s, bool indices, grid *g) {
    const netcdf_variable *v = &s->v;
    const absent_parts absent = netcdf_storage_absent(&s->storage, v->path);
    uint32_t dims[3];
    for (int a = 0; a < 3; a++) {
        const size_t n = v->count[v->rank - 1 - a];
        dims[a] = n < UINT32_MAX ? (uint32_t)n : UINT32_MAX;
    }
    grid_init(g, dims, packed_type(&v->packed));
    char name[NETCDF_PATH + 80];
    snprintf(name, sizeof name, v->units[0] ? "%s [%s]" : "%s", v->path, v->units);
    text_name(g->name, sizeof g->name, name);
    g->absent = absent;
    status st = grid_check(g, file_path(s->guard));
    return st == ST_OK ? netcdf_variable_place(s->m, file_path(s->guard), v, indices, g) : st;
}

status netcdf_slices_open(mem *m, const import_request *q, const netcdf_wish *wish,
                          slice_source *out) {
    netcdf_slices *s = NULL;
    grid g = {0};
    status st = create(m, q, &s);
    if (st != ST_OK)
        return st;
    st = choose(s, q, wish);
    if (st == ST_OK)
        st = choose_step(s, q);
    if (st == ST_OK)
        st = netcdf_classic_check(s->guard, &s->v, s->start);
    if (st == ST_OK)
        st = check_absent(s, q);
    if (st == ST_OK)
        st = make_grid(s, wish->indices, &g);
    if (st == ST_OK)
        st = begin_slices(s, &g);
    if (st != ST_OK) {
        grid_release(&g, m);
        close_slices(s);
        return st;
    }
    *out = (slice_source){.format = s->v.minc ? "MINC 1" : "netCDF",
                          .name = file_path(s->guard),
                          .m = m,
                          .g = g,
                          .read = read_slices,
                          .place = find_place,
                          .place_ctx = s,
                          .close = close_slices,
                          .ctx = s};
    return ST_OK;
}
