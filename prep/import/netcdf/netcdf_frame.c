#include "prep/import/netcdf/netcdf_frame.h"

#include <string.h>

#include "prep/import/netcdf/netcdf_roles.h"

/* ---- axes ---- */

/* The frame's dimension of axis a: 0 is x. */
static int dim_of(const netcdf_frame *fr, int a) {
    return fr->v.dim[fr->v.rank - 1 - a];
}

/* Which of the frame's dimensions in front of the last three this one is; -1: none. */
static int step_of(const netcdf_frame *fr, int dim) {
    for (int i = 0; i < fr->v.rank - 3; i++)
        if (fr->v.dim[i] == dim)
            return i;
    return -1;
}

static bool is_axis(const netcdf_frame *fr, int dim) {
    return dim == dim_of(fr, 0) || dim == dim_of(fr, 1) || dim == dim_of(fr, 2);
}

/* Pass over dimensions of steps, and those of one number. Returns how many. */
static int pass_steps(const netcdf_frame *fr, netcdf_term *t) {
    int i = 0;
    for (; i < t->v.rank; i++) {
        const int step = step_of(fr, t->v.dim[i]);
        if (step < 0 && (t->v.count[i] != 1 || is_axis(fr, t->v.dim[i])))
            break;
        t->start[i] = step < 0 ? 0 : fr->start[step];
        t->moves = t->moves || (step >= 0 && t->v.count[i] > 1);
    }
    return i;
}

static bool is_near(size_t a, size_t b) {
    return a == b || a + 1 == b || a == b + 1;
}

/* Whether a term of two or three dimensions has axis a of the frame where it stands. */
static bool find_axis(const netcdf_frame *fr, netcdf_term *t, int a) {
    const int dim = t->v.dim[t->v.rank - 1 - a];
    const size_t count = t->v.count[t->v.rank - 1 - a];
    if (dim == dim_of(fr, a))
        return true;
    t->exact = false;
    return count > 0 && is_near(count, fr->n[a]) && !is_axis(fr, dim) && step_of(fr, dim) < 0;
}

bool netcdf_frame_term(const netcdf_frame *fr, int group, int id, netcdf_term *t) {
    char prefix[NETCDF_PATH - NC_MAX_NAME - 2];
    memset(t, 0, sizeof *t);
    (void)netcdf_variable_prefix(group, prefix, sizeof prefix);
    netcdf_variable_find(group, id, prefix, &t->v);
    if (!t->v.packed.type || t->v.minc)
        return false;
    const int passed = pass_steps(fr, t), left = t->v.rank - passed;
    if (left == 1) /* along which axis a line lies is told by its dimension alone */
        for (int a = 0; a < 3; a++)
            t->axes |= t->v.dim[passed] == dim_of(fr, a) ? 1U << a : 0U;
    else
        t->axes = left == 0 ? 0 : left == 2 ? NETCDF_X | NETCDF_Y : NETCDF_X | NETCDF_Y | NETCDF_Z;
    bool fits = left <= 3 && (left != 1 || t->axes != 0);
    t->exact = true;
    for (int a = 0; a < left && left > 1 && fits; a++)
        fits = find_axis(fr, t, a);
    return fits;
}

/* ---- reading ---- */

enum { BLOCK_BYTES = 4 << 20 };

/* Rows of the chunks that a map lies in; 0: it lies in none. */
static size_t chunk_rows(const netcdf_variable *v) {
    size_t chunk[NETCDF_RANK];
    int storage = NC_CONTIGUOUS;
    return nc_inq_var_chunking(v->group, v->id, &storage, chunk) == NC_NOERR &&
                   storage == NC_CHUNKED
               ? chunk[v->rank - 2]
               : 0;
}

/* Rows to read at once: of whole chunks where those fit. */
static size_t rows_of(const netcdf_frame *fr, const netcdf_term *t, size_t row, size_t rows) {
    const size_t bytes = row * packed_bytes(&t->v.packed), chunk = chunk_rows(&t->v);
    size_t some = BLOCK_BYTES / (bytes ? bytes : 1);
    some = some < 1 ? 1 : some;
    if (chunk > some && chunk * bytes <= fr->f->m->limit / 8)
        some = chunk;
    else if (chunk > 0 && chunk <= some)
        some -= some % chunk;
    return some < rows ? some : rows;
}

/* Read numbers of a term that is `rows` rows of `row`, or a single number or line. */
static status read_rows(const netcdf_frame *fr, const netcdf_term *t, size_t rows, size_t row,
                        double *to) {
    const int rank = t->v.rank;
    const bool is_map = (t->axes & NETCDF_X) && (t->axes & NETCDF_Y);
    const size_t some = is_map ? rows_of(fr, t, row, rows) : 1;
    packed_samples packed = t->v.packed;
    size_t start[NETCDF_RANK], count[NETCDF_RANK];
    void *raw = mem_alloc(fr->f->m, some * row * packed_bytes(&packed));
    status st = raw ? netcdf_file_check(fr->f, &t->v, t->start) : ST_NOMEM;
    packed.out = SAMPLE_F64;
    memcpy(start, t->start, sizeof start);
    for (int i = 0; i < rank; i++)
        count[i] = 1;
    if (t->axes)
        count[rank - 1] = row;
    for (size_t first = 0, n; first < rows && st == ST_OK; first += n) {
        n = rows - first < some ? rows - first : some;
        if (is_map) {
            start[rank - 2] = first;
            count[rank - 2] = n;
        }
        const int error = nc_get_vara(t->v.group, t->v.id, start, count, raw);
        if (error != NC_NOERR)
            st = netcdf_file_failed(fr->f, t->v.path, error);
        else
            (void)packed_unpack(&packed, raw, to + first * row, n * row);
    }
    if (t->v.rank > 0) /* the library need not keep chunks that are not read again */
        (void)nc_set_var_chunk_cache(t->v.group, t->v.id, 0, 1, 0);
    mem_free(fr->f->m, raw);
    return st;
}

/* ---- maps and levels ---- */

/* Value i of n, of an axis that has one node more or less, or the same. at: between two of these,
 * the first and the second. */
static void between(size_t i, size_t has, size_t n, size_t at[2]) {
    at[0] = has < n && i > 0 ? i - 1 : i;
    at[1] = has > n ? i + 1 : i;
    at[0] = at[0] < has ? at[0] : has - 1;
    at[1] = at[1] < has ? at[1] : has - 1;
}

void netcdf_frame_widen(const netcdf_frame *fr, const double *from, const size_t has[2],
                        double *to) {
    size_t x[2], y[2];
    for (size_t j = 0; j < fr->n[1]; j++) {
        between(j, has[1], fr->n[1], y);
        const double *a = from + y[0] * has[0], *b = from + y[1] * has[0];
        for (size_t i = 0; i < fr->n[0]; i++) {
            between(i, has[0], fr->n[0], x);
            to[j * fr->n[0] + i] = 0.25 * ((a[x[0]] + a[x[1]]) + (b[x[0]] + b[x[1]]));
        }
    }
}

static status read_map(const netcdf_frame *fr, const netcdf_term *t, double *to) {
    const size_t has[2] = {t->v.count[t->v.rank - 1], t->v.count[t->v.rank - 2]};
    if (has[0] == fr->n[0] && has[1] == fr->n[1])
        return read_rows(fr, t, has[1], has[0], to);
    double *own = mem_array(fr->f->m, has[0] * has[1], sizeof *own);
    status st = own ? read_rows(fr, t, has[1], has[0], own) : ST_NOMEM;
    if (st == ST_OK)
        netcdf_frame_widen(fr, own, has, to);
    mem_free(fr->f->m, own);
    return st;
}

status netcdf_frame_map(const netcdf_frame *fr, const netcdf_term *t, double *to) {
    if (t->axes == (NETCDF_X | NETCDF_Y))
        return read_map(fr, t, to);
    const size_t count = t->axes == NETCDF_X ? fr->n[0] : t->axes == NETCDF_Y ? fr->n[1] : 1;
    double *line = mem_array(fr->f->m, count, sizeof *line);
    const status st = line ? read_rows(fr, t, 1, count, line) : ST_NOMEM;
    for (size_t c = 0; c < fr->columns && st == ST_OK; c++)
        to[c] = line[t->axes == NETCDF_X ? c % fr->n[0] : t->axes == NETCDF_Y ? c / fr->n[0] : 0];
    mem_free(fr->f->m, line);
    return st;
}

status netcdf_frame_levels(const netcdf_frame *fr, const netcdf_term *t, double *to) {
    status st = read_rows(fr, t, 1, t->axes ? fr->n[2] : 1, to);
    for (uint32_t k = 1; k < fr->n[2] && !t->axes && st == ST_OK; k++)
        to[k] = to[0];
    return st;
}
