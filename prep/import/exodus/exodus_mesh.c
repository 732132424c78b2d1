#include "prep/import/exodus/exodus_mesh.h"

#include <netcdf.h>
#include <stdio.h>
#include <string.h>

#include "prep/import/exodus/exodus_averages.h"
#include "prep/import/exodus/exodus_blocks.h"
#include "prep/import/hdf5/hdf5_storage.h"
#include "prep/import/import_fields.h"
#include "prep/import/netcdf/netcdf_storage.h"

enum { READ_NUMBERS = 2048, AXES = 3 };

/* The variables of the nodes and of the elements. */
static const struct {
    const char *names, *count; /* in the file */
    const char *of;
} owners[IMPORT_OWNERS] = {
    {"name_nod_var", "num_nod_var", "of the nodes"},
    {"name_elem_var", "num_elem_var", "of the elements"},
};

typedef struct exodus {
    mem *m;
    netcdf_storage storage;
    file *guard; /* the same file, opened so that the guard knows it as an input */
    exodus_numbers n;
    exodus_blocks blocks;
    uint64_t nodes;
    import_fields fields;
    exodus_averages averages;
} exodus;

/* ---- opening ---- */

static void close_exodus(void *ctx) {
    exodus *x = ctx;
    exodus_averages_release(&x->averages);
    exodus_blocks_release(&x->blocks);
    import_fields_release(&x->fields);
    if (x->n.id >= 0)
        nc_close(x->n.id);
    file_close(x->guard);
    netcdf_storage_release(&x->storage);
    mem_free(x->m, x);
}

static status open_library(exodus *x, const import_request *q) {
    const char *path = q->paths[0];
    status st = file_open(x->m, path, &x->guard);
    if (st == ST_OK)
        st = netcdf_storage_look(x->m, path, &q->trust, &x->storage);
    if (st != ST_OK)
        return st;
    const int error = nc_open(path, NC_NOWRITE, &x->n.id);
    x->n.path = path;
    x->n.f = x->guard;
    x->n.storage = &x->storage;
    x->n.allow_missing = q->trust.allow_missing;
    if (error == NC_NOERR)
        return ST_OK;
    x->n.id = -1;
    st = hdf5_storage_denied();
    return st == ST_OK ? exodus_numbers_failed(&x->n, "opening", error) : st;
}

/* Read the names of the variables. One without a name is called by its number. */
static status read_names(exodus *x, import_owner owner) {
    const int variable = exodus_numbers_find(&x->n, owners[owner].names);
    const uint64_t count = variable < 0 ? 0 : exodus_numbers_dim(&x->n, owners[owner].count);
    status st = ST_OK;
    x->fields.of[owner] = owners[owner].of;
    for (uint64_t i = 0; i < count && st == ST_OK; i++) {
        char name[MESH_NAME_MAX + 1];
        st = exodus_numbers_name(&x->n, variable, (size_t)i, name, sizeof name);
        if (st == ST_OK && !*name)
            snprintf(name, sizeof name, "variable %llu", (unsigned long long)i + 1);
        if (st == ST_OK)
            st = import_fields_add(&x->fields, owner, name);
    }
    return st;
}

static status read_times(exodus *x) {
    const int variable = exodus_numbers_find(&x->n, "time_whole");
    const size_t start = 0, count = (size_t)x->fields.steps, none = 0;
    double unused;
    if (variable < 0 || count == 0)
        return ST_OK;
    /* Are they there at all? */
    status st = exodus_numbers_read(&x->n, variable, 1, &start, &none, &unused);
    if (st != ST_OK)
        return st;
    double *times = x->fields.times = mem_array(x->m, count, sizeof *times);
    return times ? exodus_numbers_read(&x->n, variable, 1, &start, &count, times) : ST_NOMEM;
}

static status read_sizes(exodus *x) {
    const uint64_t axes = exodus_numbers_dim(&x->n, "num_dim");
    x->nodes = exodus_numbers_dim(&x->n, "num_nodes");
    x->fields.steps = exodus_numbers_dim(&x->n, "time_step");
    if (axes == 0 || exodus_numbers_dim(&x->n, "num_el_blk") == 0)
        return status_describe(
            ST_UNSUPPORTED, "%s: expected an Exodus file, with num_dim and num_el_blk", x->n.path);
    if (axes != AXES)
        return status_describe(ST_UNSUPPORTED, "%s: a mesh of %llu dimensions, expected 3",
                               x->n.path, (unsigned long long)axes);
    if (x->nodes > MESH_POINTS_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: %llu nodes, at most %llu are read", x->n.path,
                               (unsigned long long)x->nodes, (unsigned long long)MESH_POINTS_MAX);
    status st = read_names(x, IMPORT_POINTS);
    if (st == ST_OK)
        st = read_names(x, IMPORT_CELLS);
    return st == ST_OK ? read_times(x) : st;
}

static status open_exodus(mem *m, const import_request *q, exodus **out) {
    exodus *x = mem_zalloc(m, sizeof *x);
    if (!x)
        return ST_NOMEM;
    x->m = x->blocks.m = m;
    x->fields = (import_fields){.m = m, .path = q->paths[0]};
    x->n.id = -1;
    status st = open_library(x, q);
    if (st == ST_OK)
        st = read_sizes(x);
    if (st != ST_OK) {
        close_exodus(x);
        return st;
    }
    *out = x;
    return ST_OK;
}

/* ---- reading ---- */

/* Where numbers along the nodes are: a variable, behind up to two indices. */
typedef struct row {
    int variable, rank;
    size_t start[AXES];
} row;

static status find_row(const exodus *x, const char *name, row *r) {
    r->variable = exodus_numbers_find(&x->n, name);
    return r->variable >= 0
               ? ST_OK
               : status_describe(ST_CORRUPT, "%s: there is no variable %s", x->n.path, name);
}

/* Read numbers along the nodes as floats, `apart` floats apart. */
static status read_row(exodus *x, row *r, uint64_t first, size_t count, float *to, size_t apart) {
    double numbers[READ_NUMBERS];
    size_t size[AXES] = {1, 1, 1};
    status st = ST_OK;
    for (size_t i = 0, some; i < count && st == ST_OK; i += some) {
        some = count - i < READ_NUMBERS ? count - i : READ_NUMBERS;
        r->start[r->rank - 1] = (size_t)first + i;
        size[r->rank - 1] = some;
        st = exodus_numbers_read(&x->n, r->variable, r->rank, r->start, size, numbers);
        for (size_t k = 0; k < some && st == ST_OK; k++)
            to[(i + k) * apart] = (float)numbers[k];
    }
    return st;
}

static status give_points(void *ctx, uint64_t first, size_t count, float (*xyz)[3]) {
    exodus *x = ctx;
    static const char *const names[AXES] = {"coordx", "coordy", "coordz"};
    const bool together = exodus_numbers_find(&x->n, "coord") >= 0;
    status st = ST_OK;
    for (size_t a = 0; a < AXES && st == ST_OK; a++) {
        row r = {.rank = together ? 2 : 1, .start = {together ? a : 0}};
        st = find_row(x, together ? "coord" : names[a], &r);
        if (st == ST_OK)
            st = read_row(x, &r, first, count, &xyz[0][a], 3);
    }
    return st;
}

static status give_values(void *ctx, uint32_t field, uint64_t first, size_t count, float *to) {
    exodus *x = ctx;
    const uint32_t variable = x->fields.taken[field], step = x->fields.step;
    if (x->fields.owner == IMPORT_CELLS)
        return exodus_averages_read(&x->averages, variable, first, count, to);
    char name[64];
    snprintf(name, sizeof name, "vals_nod_var%u", variable + 1);
    row r = {.rank = 2, .start = {step}};
    if (exodus_numbers_find(&x->n, "vals_nod_var") >= 0) { /* all of them in one */
        snprintf(name, sizeof name, "vals_nod_var");
        r = (row){.rank = 3, .start = {step, variable}};
    }
    status st = find_row(x, name, &r);
    return st == ST_OK ? read_row(x, &r, first, count, to, 1) : st;
}

static status give_cells(void *ctx, cell_shape shape, uint64_t first, size_t count, uint32_t *ids) {
    exodus *x = ctx;
    return exodus_blocks_cells(&x->blocks, &x->n, shape, first, count, ids);
}

static void read_title(const exodus *x, char to[MESH_NAME_MAX + 1]) {
    netcdf_text(x->n.id, NC_GLOBAL, "title", to, MESH_NAME_MAX + 1);
}

static void describe(const exodus *x, import_mesh *out) {
    mesh_stream_header *h = &out->header;
    read_title(x, h->name);
    h->points = x->nodes;
    h->tets = x->blocks.cells[CELL_TET];
    memcpy(h->cells, x->blocks.cells, sizeof h->cells);
    h->cells[CELL_TET] = 0; /* told apart */
    h->by_corners = x->blocks.higher;
    h->skipped = x->blocks.skipped;
    import_fields_describe(&x->fields, h);
}

status exodus_mesh_open(mem *m, const import_request *q, import_mesh *out) {
    exodus *x = NULL;
    status st = open_exodus(m, q, &x);
    if (st != ST_OK)
        return st;
    *out = (import_mesh){.ctx = x,
                         .points = give_points,
                         .values = give_values,
                         .cells = give_cells,
                         .close = close_exodus};
    st = import_fields_take(&x->fields, q);
    if (st == ST_OK)
        st = exodus_blocks_read(m, &x->n, q->by_corners, &x->blocks);
    x->averages = (exodus_averages){
        .m = m, .n = &x->n, .blocks = &x->blocks, .nodes = x->nodes, .step = x->fields.step};
    if (st == ST_OK)
        describe(x, out);
    return st;
}

status exodus_mesh_list(mem *m, const import_request *q, const import_list *to) {
    exodus *x = NULL;
    char title[MESH_NAME_MAX + 1];
    status st = open_exodus(m, q, &x);
    if (st != ST_OK)
        return st;
    read_title(x, title);
    st = import_fields_list(&x->fields, q, title, x->nodes, to);
    close_exodus(x);
    return st;
}
