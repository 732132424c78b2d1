#include "prep/import/netcdf/netcdf_choice.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/import_hint.h"
#include "prep/import/netcdf/netcdf_roles.h"

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
    void (*judge)(const netcdf_variable *taken, netcdf_variable *v);
    merit best; /* of the best variable so far */
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

static status search(const netcdf_file *f, walk *w) {
    status st = walk_all(w, f->id, NULL);
    return st == ST_OK ? walk_all(w, f->id, choose_variable) : st;
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

status netcdf_choice_find(const netcdf_file *f, const import_request *q, const netcdf_wish *wish,
                          netcdf_variable *out) {
    netcdf_roles roles = {.m = f->m};
    walk w = {.q = q, .wish = wish, .roles = &roles};
    status st = search(f, &w);
    netcdf_roles_release(&roles);
    *out = w.found;
    if (st == ST_OK && !w.best.suits)
        st = nothing_found(&w);
    else if (st == ST_OK && out->refuse[0])
        st = status_describe(ST_UNSUPPORTED, "%s: variable %s cannot be read: %s", q->paths[0],
                             out->path, out->refuse);
    return st;
}

/* ---- listing ---- */

static void list_variable(walk *w, netcdf_variable *v) {
    const char *role = netcdf_roles_of(w->roles, v->group, v->id);
    if (w->judge && !v->refuse[0] && w->best.suits)
        w->judge(&w->found, v);
    const bool taken = w->best.suits && v->group == w->found.group && v->id == w->found.id;
    if (w->judge && role && !v->refuse[0] && !taken)
        snprintf(v->refuse, sizeof v->refuse, "it is no field, but tells of others: %s", role);
    import_item item = {.name = v->path, .type = v->type};
    for (int i = 0; i < 3 && i < v->rank; i++)
        item.shape[i] = v->count[v->rank - 1 - i];
    item.shape[3] = v->rank > 3 ? v->steps : 0;
    item.refuse = v->refuse[0] ? v->refuse : NULL;
    item.taken = taken;
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

status netcdf_choice_list(const netcdf_file *f, const import_request *q, const netcdf_wish *wish,
                          void (*judge)(const netcdf_variable *taken, netcdf_variable *v),
                          const import_list *to) {
    netcdf_roles roles = {.m = f->m};
    walk w = {.q = q, .wish = wish, .roles = &roles, .judge = judge, .to = to};
    status st = search(f, &w);
    if (st == ST_OK)
        st = walk_all(&w, f->id, list_variable);
    netcdf_roles_release(&roles);
    return st;
}

/* ---- steps ---- */

/* Count through the steps of several dimensions, the last one fastest. */
status netcdf_choice_start(const import_request *q, const netcdf_variable *v,
                           size_t start[NETCDF_RANK]) {
    uint64_t step = q->step;
    memset(start, 0, NETCDF_RANK * sizeof *start);
    if (step >= v->steps)
        return status_describe(ST_USAGE, "%s: %s: --step %u: it has %llu, counted from 0",
                               q->paths[0], v->path, q->step, (unsigned long long)v->steps);
    for (int i = v->rank - 4; i >= 0; i--) {
        start[i] = step % v->count[i];
        step /= v->count[i];
    }
    return ST_OK;
}
