#include "prep/import/exodus/exodus_numbers.h"

#include <math.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/netcdf/netcdf_classic.h"

enum { TEXT_MAX = 1024, SLOTS = 521 };

status exodus_numbers_failed(const exodus_numbers *n, const char *what, int error) {
    return status_describe(error == NC_ENOMEM ? ST_NOMEM : ST_CORRUPT, "%s: %s: libnetcdf: %s",
                           n->path, what, nc_strerror(error));
}

uint64_t exodus_numbers_dim(const exodus_numbers *n, const char *name) {
    int dim;
    size_t length = 0;
    return nc_inq_dimid(n->id, name, &dim) == NC_NOERR &&
                   nc_inq_dimlen(n->id, dim, &length) == NC_NOERR
               ? length
               : 0;
}

int exodus_numbers_find(const exodus_numbers *n, const char *name) {
    int variable;
    return nc_inq_varid(n->id, name, &variable) == NC_NOERR ? variable : -1;
}

/* ---- numbers ---- */

/* Returns the bytes of a variable's chunks; 0: it has none, as in all classic files. */
static size_t chunk_bytes(const netcdf_variable *v) {
    size_t chunk[NETCDF_RANK], bytes = 0;
    int storage = NC_CONTIGUOUS;
    nc_type type = NC_NAT;
    if (nc_inq_var_chunking(v->group, v->id, &storage, chunk) != NC_NOERR ||
        storage != NC_CHUNKED || nc_inq_vartype(v->group, v->id, &type) != NC_NOERR ||
        nc_inq_type(v->group, type, NULL, &bytes) != NC_NOERR)
        return 0;
    for (int i = 0; i < v->rank; i++)
        bytes *= chunk[i];
    return bytes;
}

/* Let the library keep one chunk of a variable, or none. Without room for it, it would unpack the
 * chunk for each part that is read. */
static void keep_chunk(const netcdf_variable *v, bool keep) {
    const size_t bytes = chunk_bytes(v);
    if (bytes > 0)
        (void)nc_set_var_chunk_cache(v->group, v->id, keep ? bytes : 0, SLOTS, 1);
}

/* Refuse a variable that was never written: not whole, or nothing of it. Numbers that are not there
 * are the fill value. */
static status check_written(const exodus_numbers *n, const netcdf_variable *v, bool whole) {
    const absent_parts absent = netcdf_storage_absent(n->storage, v->path);
    const bool enough = absent.count == 0 || (!whole && absent.count < absent.of);
    return enough || n->allow_missing
               ? ST_OK
               : status_describe(ST_CORRUPT,
                                 "%s: %llu of %llu parts of variable %s were never written "
                                 "(--allow-missing takes it all the same)",
                                 n->path, (unsigned long long)absent.count,
                                 (unsigned long long)absent.of, v->path);
}

/* Turn to a variable that was not read lately: check that it has these dimensions, and all its
 * bytes. */
static status turn_to(exodus_numbers *n, int variable, int rank, const size_t start[], bool whole,
                      exodus_use *use) {
    if (use->any)
        keep_chunk(&use->v, false);
    use->any = false;
    netcdf_variable_find(n->id, variable, "", &use->v);
    if (use->v.rank != rank)
        return status_describe(ST_CORRUPT, "%s: variable %s has %d dimensions, expected %d",
                               n->path, use->v.path, use->v.rank, rank);
    status st = netcdf_classic_check(n->f, &use->v, start);
    if (st == ST_OK)
        st = check_written(n, &use->v, whole);
    if (st != ST_OK)
        return st;
    keep_chunk(&use->v, true);
    use->any = true;
    return ST_OK;
}

static status find_use(exodus_numbers *n, int variable, int rank, const size_t start[], bool whole,
                       exodus_use **out) {
    for (int i = 0; i < EXODUS_USES; i++)
        if (n->uses[i].any && n->uses[i].v.id == variable) {
            *out = &n->uses[i];
            return ST_OK;
        }
    *out = &n->uses[n->oldest];
    n->oldest = (n->oldest + 1) % EXODUS_USES;
    return turn_to(n, variable, rank, start, whole, *out);
}

static status check(exodus_numbers *n, int variable, int rank, const size_t start[],
                    const size_t count[], bool whole) {
    exodus_use *use;
    status st = find_use(n, variable, rank, start, whole, &use);
    for (int i = 0; i < rank && st == ST_OK; i++)
        if (start[i] > use->v.count[i] || count[i] > use->v.count[i] - start[i])
            st = status_describe(ST_CORRUPT, "%s: variable %s has %zu numbers, expected %zu",
                                 n->path, use->v.path, use->v.count[i], start[i] + count[i]);
    return st;
}

static status told(const exodus_numbers *n, int variable, int error) {
    char name[NC_MAX_NAME + 1] = "";
    if (error == NC_NOERR)
        return ST_OK;
    nc_inq_varname(n->id, variable, name);
    return exodus_numbers_failed(n, name, error);
}

status exodus_numbers_read(exodus_numbers *n, int variable, int rank, const size_t start[],
                           const size_t count[], double *to) {
    size_t all = 1;
    status st = check(n, variable, rank, start, count, false);
    if (st == ST_OK)
        st = told(n, variable, nc_get_vara_double(n->id, variable, start, count, to));
    for (int i = 0; i < rank; i++)
        all *= count[i];
    for (size_t i = 0; i < all && st == ST_OK; i++)
        if (to[i] == NC_FILL_DOUBLE || to[i] == (double)NC_FILL_FLOAT)
            to[i] = (double)NAN;
    return st;
}

status exodus_numbers_cells(exodus_numbers *n, int variable, const size_t start[2],
                            const size_t count[2], int64_t *to) {
    const status st = check(n, variable, 2, start, count, true);
    long long *numbers = (long long *)to;
    return st == ST_OK
               ? told(n, variable, nc_get_vara_longlong(n->id, variable, start, count, numbers))
               : st;
}

/* ---- names ---- */

status exodus_numbers_name(const exodus_numbers *n, int variable, size_t i, char *to, size_t room) {
    char text[TEXT_MAX];
    netcdf_variable v;
    netcdf_variable_find(n->id, variable, "", &v);
    if (v.rank != 2 || i >= v.count[0])
        return status_describe(ST_CORRUPT, "%s: variable %s has no name %zu", n->path, v.path, i);
    const size_t start[2] = {i, 0};
    const size_t count[2] = {1, v.count[1] < TEXT_MAX ? v.count[1] : TEXT_MAX - 1};
    status st = netcdf_classic_check(n->f, &v, start);
    if (st == ST_OK)
        st = told(n, variable, nc_get_vara_text(n->id, variable, start, count, text));
    if (st != ST_OK)
        return st;
    text[count[1]] = 0;
    for (size_t end = strlen(text); end > 0 && text[end - 1] == ' '; end--)
        text[end - 1] = 0;
    text_name(to, room, text);
    return ST_OK;
}
