/* netcdf_place.c - places a variable's samples by the coordinates of its dimensions. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/text.h"
#include "prep/import/cf_names.h"
#include "prep/import/netcdf/netcdf_minc.h"
#include "prep/import/netcdf/netcdf_roles.h"
#include "prep/import/netcdf/netcdf_variable.h"

static const double uneven = 1e-3; /* as a part of the step; beyond that, distances are uneven */

/* ---- reading ---- */

static bool is_longitude(int group, int id) {
    char units[32];
    netcdf_text(group, id, "units", units, sizeof units);
    return cf_is_east(units, "");
}

/* If longitudes turn over from 359 to 0, add a turn to all that follow. */
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

/* ---- notes ---- */

/* Begin the next part of a note: "a; b". */
static void begin_note(grid *g) {
    if (g->note[0] && strlen(g->note) + 3 < sizeof g->note)
        strcat(g->note, "; ");
}

/* Add a text, cut if there is no more room. */
static void add_note(grid *g, const char *text) {
    const size_t used = strlen(g->note);
    text_name(g->note + used, sizeof g->note - used, text);
}

static void turn_up(grid *g, int a, int group, int id, double *x) {
    char name[NC_MAX_NAME + 1] = "", text[NC_MAX_NAME + 64];
    for (uint32_t i = 0; i < g->dims[a]; i++)
        x[i] = -x[i];
    nc_inq_varname(group, id, name);
    snprintf(text, sizeof text, "%c is minus %s, which grows downwards", "xyz"[a], name);
    begin_note(g);
    add_note(g, text);
}

/* Note coordinates that would be heights only by a formula of other variables. */
static void note_formula(grid *g, int a, int group, int id) {
    char name[NC_MAX_NAME + 1] = "", terms[NETCDF_TEXT], text[NC_MAX_NAME + 128];
    netcdf_text(group, id, "formula_terms", terms, sizeof terms);
    if (!terms[0])
        return;
    nc_inq_varname(group, id, name);
    snprintf(text, sizeof text,
             "%c is %s as it is: the formula that makes heights of it is not used", "xyz"[a], name);
    begin_note(g);
    add_note(g, text);
}

/* Returns whether a variable named as coordinates is not used: it has several dimensions, or a
 * dimension with coordinates of its own. */
static bool is_unused(const netcdf_variable *v, int group, int id) {
    int rank = 0, dim = -1, in, own;
    nc_type type = NC_CHAR;
    nc_inq_varndims(group, id, &rank);
    nc_inq_vartype(group, id, &type);
    if (rank == 0 || type == NC_CHAR || type == NC_STRING)
        return false;
    if (rank > 1)
        return true;
    nc_inq_vardimid(group, id, &dim);
    for (int a = 0; a < 3; a++)
        if (dim == v->dim[v->rank - 1 - a])
            return !(netcdf_coordinates(v->group, dim, &in, &own) && in == group && own == id);
    return false;
}

/* List the axes without coordinates, as "x and y". */
static void list_indices(const netcdf_variable *v, char *to, size_t room) {
    int group, id;
    to[0] = 0;
    for (int a = 0; a < 3; a++)
        if (!netcdf_coordinates(v->group, v->dim[v->rank - 1 - a], &group, &id))
            text_add(to, room, "%s%c", to[0] ? " and " : "", "xyz"[a]);
}

static void note_unused(const netcdf_variable *v, grid *g) {
    char text[1024], name[NC_MAX_NAME + 1], counted[32];
    const char *at = text;
    int group, id, unused = 0;
    netcdf_text(v->group, v->id, "coordinates", text, sizeof text);
    while (cf_next_name(&at, name, sizeof name)) {
        if (!netcdf_find(v->group, name, &group, &id) || !is_unused(v, group, id))
            continue;
        if (unused == 0)
            begin_note(g);
        add_note(g, unused++ ? ", " : "coordinates that are not used: ");
        add_note(g, name);
    }
    list_indices(v, counted, sizeof counted);
    if (unused && counted[0]) {
        snprintf(text, sizeof text, " (%s count nodes)", counted);
        add_note(g, text);
    }
}

/* ---- all of it ---- */

static status place_dimension(mem *m, const char *file, const netcdf_variable *v, int a, grid *g) {
    int group, id;
    char unit[WORLD_UNIT];
    if (!netcdf_coordinates(v->group, v->dim[v->rank - 1 - a], &group, &id))
        return ST_OK;
    double *x = mem_array(m, g->dims[a], sizeof *x);
    if (!x)
        return ST_NOMEM;
    status st = read_coordinates(file, group, id, x, g->dims[a]);
    if (st == ST_OK && netcdf_goes_down(group, id))
        turn_up(g, a, group, id, x);
    if (st == ST_OK)
        st = place_axis(m, file, x, a, g);
    netcdf_text(group, id, "units", unit, sizeof unit);
    world_frame_set_unit(&g->frame, a, unit);
    note_formula(g, a, group, id);
    mem_free(m, x);
    return st;
}

status netcdf_variable_place(mem *m, const char *file, const netcdf_variable *v, bool indices,
                             grid *g) {
    char what[NETCDF_PATH + 256];
    if (v->minc)
        return indices ? ST_OK : netcdf_minc_place(file, v, g);
    snprintf(what, sizeof what, "%s: %s (--indices does without coordinates)", file, v->path);
    for (int a = 0; a < 3 && !indices; a++) {
        status st = place_dimension(m, what, v, a, g);
        if (st != ST_OK)
            return st;
    }
    if (!indices)
        note_unused(v, g);
    return ST_OK;
}

status netcdf_variable_times(mem *m, const char *file, const netcdf_variable *v, double **times,
                             char unit[WORLD_TIME_UNIT]) {
    int group, id;
    *times = NULL;
    unit[0] = 0;
    if (v->time < 0 || netcdf_variable_stacked(v) || v->steps < 2 || v->steps > UINT32_MAX ||
        v->count[v->time] != v->steps ||
        !netcdf_coordinates(v->group, v->dim[v->time], &group, &id))
        return ST_OK;
    *times = mem_array(m, v->steps, sizeof **times);
    netcdf_text(group, id, "units", unit, WORLD_TIME_UNIT);
    return *times ? read_coordinates(file, group, id, *times, (uint32_t)v->steps) : ST_NOMEM;
}
