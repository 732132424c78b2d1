#include "prep/import/netcdf/netcdf_minc.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "prep/import/minc.h"

/* ---- recognizing MINC ---- */

static int space_of(const netcdf_variable *v, int i) {
    char name[NC_MAX_NAME + 1] = "";
    nc_inq_dimname(v->group, v->dim[i], name);
    return minc_space(name);
}

/* Classic netCDF has no unsigned types. By default bytes are unsigned, others signed. */
static void find_sign(netcdf_variable *v) {
    static const sample_type with[] = {[1] = SAMPLE_I8, [2] = SAMPLE_I16, [4] = SAMPLE_I32};
    static const sample_type without[] = {[1] = SAMPLE_U8, [2] = SAMPLE_U16, [4] = SAMPLE_U32};
    const size_t size = sample_size(v->packed.type);
    char text[16];
    netcdf_text(v->group, v->id, "signtype", text, sizeof text);
    const bool plus = text[0] ? strcmp(text, "unsigned") == 0 : size == 1;
    packed_init(&v->packed, (plus ? without : with)[size], PACKED_NARROW);
}

/* The attribute as a double; NaN: there is none. */
static double limit_of(const netcdf_variable *v, const char *name, int at) {
    long double value;
    return netcdf_number(v->group, v->id, name, at, &value) ? (double)value : NAN;
}

static void find_range(netcdf_variable *v) {
    packed_samples *p = &v->packed;
    double told[2] = {limit_of(v, "valid_range", 0), limit_of(v, "valid_range", 1)}, range[2];
    if (isnan(told[0]) || isnan(told[1])) {
        told[0] = limit_of(v, "valid_min", 0);
        told[1] = limit_of(v, "valid_max", 0);
    }
    minc_range(p->type, told, range);
    p->has_range = true;
    p->least = range[0];
    p->most = range[1];
}

void netcdf_minc_find(netcdf_variable *v) {
    int spaces = 0, last = 0;
    for (int i = 0; i < v->rank; i++) {
        const bool is = space_of(v, i) >= 0;
        spaces += is;
        last += is && i >= v->rank - 3;
    }
    v->minc = strcmp(v->path, "image") == 0 && spaces > 0;
    if (!v->minc || v->refuse[0])
        return;
    if (spaces != 3 || last != 3) {
        snprintf(v->refuse, sizeof v->refuse,
                 "MINC 1 whose last dimensions are not xspace, yspace and zspace: mnc2nii makes "
                 "NIfTI of it");
        return;
    }
    if (!sample_is_integer(v->packed.type) || v->packed.wide)
        return;
    find_sign(v);
    find_range(v);
}

/* ---- where it lies ---- */

static status find_dimension(const char *file, const netcdf_variable *v, int space,
                             minc_dimension *d) {
    static const char *const names[] = {"xspace", "yspace", "zspace"};
    long double number;
    char text[32];
    int id;
    *d = minc_usual(space);
    if (nc_inq_varid(v->group, names[space], &id) != NC_NOERR)
        return ST_OK;
    netcdf_text(v->group, id, "spacing", text, sizeof text);
    if (strcmp(text, "irregular") == 0)
        return status_describe(ST_UNSUPPORTED,
                               "%s: MINC whose %s is irregular is not read: mincresample makes it "
                               "even",
                               file, names[space]);
    if (netcdf_number(v->group, id, "step", 0, &number))
        d->step = (double)number;
    if (netcdf_number(v->group, id, "start", 0, &number))
        d->start = (double)number;
    for (size_t i = 0; i < 3; i++)
        if (netcdf_number(v->group, id, "direction_cosines", i, &number))
            d->cosines[i] = (double)number;
    return ST_OK;
}

status netcdf_minc_place(const char *file, const netcdf_variable *v, grid *g) {
    minc_dimension d[3];
    status st = ST_OK;
    for (int a = 0; a < 3 && st == ST_OK; a++)
        st = find_dimension(file, v, space_of(v, v->rank - 1 - a), &d[a]);
    if (st == ST_OK)
        minc_place(d, g);
    return st;
}

/* ---- values ---- */

/* Read a slice's number. image-min and image-max lie along some of the image's first dimensions. */
static status read_end(const char *file, const netcdf_variable *v, const char *name,
                       const size_t *start, size_t slice, double *out) {
    int id, rank = 0, dims[NC_MAX_VAR_DIMS];
    size_t at[NC_MAX_VAR_DIMS];
    if (nc_inq_varid(v->group, name, &id) != NC_NOERR)
        return ST_OK;
    int error = nc_inq_varndims(v->group, id, &rank);
    error = error == NC_NOERR ? nc_inq_vardimid(v->group, id, dims) : error;
    for (int i = 0; error == NC_NOERR && i < rank; i++) {
        int along = 0;
        while (along < v->rank - 2 && v->dim[along] != dims[i])
            along++;
        if (along == v->rank - 2)
            return status_describe(ST_UNSUPPORTED,
                                   "%s: MINC whose %s is not one number a slice is not read: "
                                   "mnc2nii makes NIfTI of it",
                                   file, name);
        at[i] = along == v->rank - 3 ? slice : start[along];
    }
    error = error == NC_NOERR ? nc_get_var1_double(v->group, id, at, out) : error;
    return error == NC_NOERR ? ST_OK
                             : status_describe(ST_CORRUPT, "%s: %s: libnetcdf: %s", file, name,
                                               nc_strerror(error));
}

status netcdf_minc_scales(mem *m, const char *file, const netcdf_variable *v, const size_t *start,
                          double **out) {
    const size_t slices = v->count[v->rank - 3];
    const double valid[2] = {v->packed.least, v->packed.most};
    double *scales = *out = mem_array(m, 2 * slices, sizeof *scales);
    status st = scales ? ST_OK : ST_NOMEM;
    for (size_t z = 0; z < slices && st == ST_OK; z++) {
        double least = 0, most = 1;
        st = read_end(file, v, "image-min", start, z, &least);
        if (st == ST_OK)
            st = read_end(file, v, "image-max", start, z, &most);
        minc_scale(valid, least, most, &scales[2 * z], &scales[2 * z + 1]);
    }
    return st;
}
