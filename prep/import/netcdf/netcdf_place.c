/* netcdf_place.c - where a variable's samples lie: the coordinates of its dimensions. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "prep/import/netcdf/netcdf_variable.h"

static const double uneven = 1e-3; /* of the step: more is no equal distance */

/* ---- reading ---- */

/* A dimension's coordinates are the variable of its name, in the same group or one around it. */
static bool find_coordinates(const netcdf_variable *v, int dim, int *group, int *id) {
    char name[NC_MAX_NAME + 1];
    if (nc_inq_dimname(v->group, dim, name) != NC_NOERR)
        return false;
    for (*group = v->group;;) {
        int rank = 0, own = -1;
        nc_type type = NC_CHAR;
        if (nc_inq_varid(*group, name, id) == NC_NOERR)
            return nc_inq_varndims(*group, *id, &rank) == NC_NOERR && rank == 1 &&
                   nc_inq_vardimid(*group, *id, &own) == NC_NOERR && own == dim &&
                   nc_inq_vartype(*group, *id, &type) == NC_NOERR && type != NC_CHAR &&
                   type <= NC_UINT64;
        if (nc_inq_grp_parent(*group, group) != NC_NOERR)
            return false;
    }
}

static bool is_longitude(int group, int id) {
    static const char *const known[] = {"degrees_east", "degree_east", "degree_E",
                                        "degrees_E",    "degreeE",     "degreesE"};
    char units[32];
    netcdf_text(group, id, "units", units, sizeof units);
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(units, known[i]) == 0)
            return true;
    return false;
}

/* From 359 on to 0: all that follows is a turn further. */
static void unwind(double *x, uint32_t count) {
    const double sign = count > 1 && x[1] < x[0] ? -1 : 1;
    double turn = 0;
    for (uint32_t i = 1; i < count; i++) {
        if (sign * (x[i] + turn - x[i - 1]) < 0 && turn == 0)
            turn = sign * 360;
        x[i] += turn;
    }
}

static status read_coordinates(const char *file, int group, int id, double *x, uint32_t count) {
    long double scale = 1, offset = 0;
    const int error = nc_get_var_double(group, id, x);
    if (error != NC_NOERR)
        return status_describe(error == NC_ENOMEM ? ST_NOMEM : ST_CORRUPT,
                               "%s: reading coordinates: libnetcdf: %s", file, nc_strerror(error));
    netcdf_number(group, id, "scale_factor", 0, &scale);
    netcdf_number(group, id, "add_offset", 0, &offset);
    for (uint32_t i = 0; i < count; i++)
        x[i] = x[i] * (double)scale + (double)offset;
    if (is_longitude(group, id))
        unwind(x, count);
    return ST_OK;
}

/* ---- placing ---- */

static bool is_even(const double *x, uint32_t count, double *step) {
    *step = (x[count - 1] - x[0]) / (count - 1);
    for (uint32_t i = 0; i < count; i++)
        if (!(fabs(x[i] - (x[0] + i * *step)) <= uneven * fabs(*step)))
            return false;
    return *step != 0;
}

static status place_axis(mem *m, const char *file, const double *x, int a, grid *g) {
    double step;
    if (is_even(x, g->dims[a], &step)) {
        g->to_world[a][a] = step;
        g->to_world[a][3] = x[0];
        return ST_OK;
    }
    return grid_set_axis(g, m, file, a, x);
}

static status place_dimension(mem *m, const char *file, const netcdf_variable *v, int a, grid *g) {
    int group, id;
    if (!find_coordinates(v, v->dim[v->rank - 1 - a], &group, &id))
        return ST_OK;
    double *x = mem_array(m, g->dims[a], sizeof *x);
    if (!x)
        return ST_NOMEM;
    status st = read_coordinates(file, group, id, x, g->dims[a]);
    if (st == ST_OK)
        st = place_axis(m, file, x, a, g);
    mem_free(m, x);
    return st;
}

status netcdf_variable_place(mem *m, const char *file, const netcdf_variable *v, bool indices,
                             grid *g) {
    char what[NETCDF_PATH + 256];
    snprintf(what, sizeof what, "%s: %s (--indices does without coordinates)", file, v->path);
    for (int a = 0; a < 3 && !indices; a++) {
        status st = place_dimension(m, what, v, a, g);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}
