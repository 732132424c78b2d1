#include "prep/import/netcdf/netcdf_slices.h"

#include <stdio.h>
#include <string.h>

#include "formats/base/file.h"
#include "formats/base/text.h"
#include "prep/import/netcdf/netcdf_hdf5.h"
#include "prep/import/netcdf/netcdf_minc.h"
#include "prep/import/netcdf/netcdf_stay.h"
#include "prep/import/packed_slices.h"

typedef struct netcdf_slices {
    mem *m;
    netcdf_file own; /* zeros: it is another's */
    const netcdf_file *file;
    netcdf_variable v;
    size_t start[NETCDF_RANK]; /* of the step */
    packed_slices slices;
    netcdf_hdf5 place;
} netcdf_slices;

static void close_slices(void *ctx) {
    netcdf_slices *s = ctx;
    packed_slices_end(&s->slices);
    netcdf_hdf5_release(&s->place);
    if (s->own.m)
        netcdf_file_close(&s->own);
    mem_free(s->m, s);
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
    return netcdf_file_failed(s->file, what, error);
}

static status read_slices(void *ctx, uint32_t first, uint32_t count, void *slices) {
    netcdf_slices *s = ctx;
    return packed_slices_read(&s->slices, first, count, slices);
}

static status begin_slices(netcdf_slices *s, const grid *g) {
    const netcdf_variable *v = &s->v;
    s->slices = (packed_slices){.m = s->m,
                                .file = file_path(s->file->guard),
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
    status st = v->minc && v->packed.has_range ? netcdf_minc_scales(s->m, file_path(s->file->guard),
                                                                    v, s->start, &s->slices.scales)
                                               : ST_OK;
    return st == ST_OK ? packed_slices_begin(&s->slices) : st;
}

static bool find_place(void *ctx, sample_place *out) {
    netcdf_slices *s = ctx;
    return netcdf_stay_find(s->file->guard, &s->v, s->start, out) ||
           netcdf_hdf5_find(file_path(s->file->guard), &s->v, s->start, &s->place, out);
}

/* ---- opening ---- */

static status make_grid(netcdf_slices *s, bool indices, grid *g) {
    const netcdf_variable *v = &s->v;
    const absent_parts absent = netcdf_storage_absent(&s->file->storage, v->path);
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
    status st = grid_check(g, file_path(s->file->guard));
    return st == ST_OK ? netcdf_variable_place(s->m, file_path(s->file->guard), v, indices, g) : st;
}

static status open_slices(netcdf_slices *s, const import_request *q, const netcdf_wish *wish,
                          grid *g) {
    status st = s->file ? ST_OK : netcdf_file_open(s->m, q, &s->own);
    s->file = s->file ? s->file : &s->own;
    if (st == ST_OK)
        st = netcdf_choice_find(s->file, q, wish, &s->v);
    if (st == ST_OK)
        st = netcdf_choice_start(q, &s->v, s->start);
    if (st == ST_OK)
        st = netcdf_file_check(s->file, &s->v, s->start);
    if (st == ST_OK)
        st = make_grid(s, wish->indices, g);
    return st == ST_OK ? begin_slices(s, g) : st;
}

static status open_source(mem *m, const netcdf_file *f, const import_request *q,
                          const netcdf_wish *wish, slice_source *out) {
    netcdf_slices *s = mem_zalloc(m, sizeof *s);
    grid g = {0};
    if (!s)
        return ST_NOMEM;
    s->m = m;
    s->file = f;
    s->place = (netcdf_hdf5){.m = m, .tell_chunks = q->chunks};
    const status st = open_slices(s, q, wish, &g);
    if (st != ST_OK) {
        grid_release(&g, m);
        close_slices(s);
        return st;
    }
    *out = (slice_source){.format = s->v.minc ? "MINC 1" : "netCDF",
                          .name = file_path(s->file->guard),
                          .m = m,
                          .g = g,
                          .read = read_slices,
                          .place = find_place,
                          .place_ctx = s,
                          .close = close_slices,
                          .ctx = s};
    return ST_OK;
}

status netcdf_slices_open(mem *m, const import_request *q, const netcdf_wish *wish,
                          slice_source *out) {
    return open_source(m, NULL, q, wish, out);
}

status netcdf_slices_open_in(const netcdf_file *f, const import_request *q, const netcdf_wish *wish,
                             slice_source *out) {
    return open_source(f->m, f, q, wish, out);
}

status netcdf_slices_list(mem *m, const import_request *q, const netcdf_wish *wish,
                          const import_list *to) {
    netcdf_file f;
    status st = netcdf_file_open(m, q, &f);
    if (st == ST_OK)
        st = netcdf_choice_list(&f, q, wish, NULL, to);
    netcdf_file_close(&f);
    return st;
}
