#include "prep/import/netcdf/netcdf_columns.h"

#include <math.h>
#include <string.h>
#include <strings.h>

#include "prep/import/cf_names.h"
#include "prep/import/netcdf/netcdf_roles.h"

static const double radian = 0.017453292519943295;

/* ---- which variables tell ---- */

/* What a variable says of columns. */
typedef enum saying { SAYS_EAST, SAYS_NORTH, SAYS_X, SAYS_Y, SAYINGS } saying;

typedef struct search {
    const netcdf_frame *fr;
    netcdf_term *terms; /* SAYINGS of them */
    bool has[SAYINGS];
    bool near; /* take those on other points of a staggered grid, too */
} search;

/* Whether a variable of lengths is along axis x or y: by its standard name, its axis, or its own
 * name. */
static saying plane_axis(int group, int id, const char *standard_name) {
    char axis[8], name[NC_MAX_NAME + 1] = "";
    netcdf_text(group, id, "axis", axis, sizeof axis);
    nc_inq_varname(group, id, name);
    if (strcmp(standard_name, "projection_x_coordinate") == 0 || strcasecmp(axis, "X") == 0)
        return SAYS_X;
    if (strcmp(standard_name, "projection_y_coordinate") == 0 || strcasecmp(axis, "Y") == 0)
        return SAYS_Y;
    if (standard_name[0] || axis[0])
        return SAYINGS;
    return name[0] == 'x' || name[0] == 'X'   ? SAYS_X
           : name[0] == 'y' || name[0] == 'Y' ? SAYS_Y
                                              : SAYINGS;
}

static bool is_degrees(const char *units) {
    return strcasecmp(units, "degrees") == 0 || strcasecmp(units, "degree") == 0;
}

/* What a variable of mere degrees says by its name, or its long name. */
static saying globe_axis(int group, int id) {
    char name[NC_MAX_NAME + 1] = "", long_name[64];
    nc_inq_varname(group, id, name);
    netcdf_text(group, id, "long_name", long_name, sizeof long_name);
    if (strncasecmp(name, "lon", 3) == 0 || strcasecmp(long_name, "longitude") == 0)
        return SAYS_EAST;
    return strncasecmp(name, "lat", 3) == 0 || strcasecmp(long_name, "latitude") == 0 ? SAYS_NORTH
                                                                                      : SAYINGS;
}

static saying what_says(int group, int id) {
    char units[64], standard_name[64];
    double factor;
    netcdf_text(group, id, "units", units, sizeof units);
    netcdf_text(group, id, "standard_name", standard_name, sizeof standard_name);
    if (!standard_name[0] && is_degrees(units))
        return globe_axis(group, id);
    if (cf_is_east(units, standard_name))
        return SAYS_EAST;
    if (cf_is_north(units, standard_name))
        return SAYS_NORTH;
    return cf_measure_of(units, &factor) == CF_LENGTH ? plane_axis(group, id, standard_name)
                                                      : SAYINGS;
}

/* Take a variable for what it says, unless another one said it before. */
static void take(search *s, int group, int id) {
    const saying what = what_says(group, id);
    if (what == SAYINGS || s->has[what])
        return;
    netcdf_term *t = &s->terms[what];
    s->has[what] = netcdf_frame_term(s->fr, group, id, t) && t->axes != 0 &&
                   !(t->axes & NETCDF_Z) && (s->near || t->exact);
}

static void take_named(search *s) {
    const netcdf_variable *v = &s->fr->v;
    char text[CF_TEXT], name[NC_MAX_NAME + 1];
    const char *at = text;
    int group, id;
    netcdf_text(v->group, v->id, "coordinates", text, sizeof text);
    while (cf_next_name(&at, name, sizeof name))
        if (netcdf_find(v->group, name, &group, &id))
            take(s, group, id);
}

/* What is on the very same points comes before what is near. */
static void take_all(search *s) {
    const netcdf_variable *v = &s->fr->v;
    int group, id, count = 0;
    take_named(s);
    s->near = true;
    take_named(s);
    s->near = false;
    for (int a = 0; a < 2; a++)
        if (netcdf_coordinates(v->group, v->dim[v->rank - 1 - a], &group, &id))
            take(s, group, id);
    nc_inq_nvars(v->group, &count);
    for (int near = 0; near < 2; near++)
        for (id = 0; id < count; id++) {
            s->near = near == 1;
            take(s, v->group, id);
        }
}

/* ---- reading ---- */

/* Read two terms into at[.][0] and [1], by their factors. */
static status read_both(const netcdf_frame *fr, const search *s, saying first, netcdf_columns *c) {
    double *numbers = mem_array(c->m, fr->columns, sizeof *numbers);
    status st = numbers ? ST_OK : ST_NOMEM;
    for (int i = 0; i < 2 && st == ST_OK; i++) {
        const netcdf_term *t = &s->terms[first + i];
        char units[64];
        double factor = 1;
        netcdf_text(t->v.group, t->v.id, "units", units, sizeof units);
        if (cf_measure_of(units, &factor) != CF_LENGTH)
            factor = 1;
        st = netcdf_frame_map(fr, t, numbers);
        for (size_t n = 0; n < fr->columns && st == ST_OK; n++)
            c->at[n][i] = numbers[n] * factor;
        c->moves = c->moves || t->moves;
    }
    mem_free(c->m, numbers);
    return st;
}

/* Beyond a pole there is nothing. */
static void check_norths(const netcdf_frame *fr, netcdf_columns *c) {
    for (size_t n = 0; n < fr->columns; n++)
        if (!(fabs(c->at[n][1]) <= 90 + 1e-3))
            c->at[n][1] = (double)NAN;
}

/* Whether columns stand apart along both axes: lengths may be there, but never set. */
static bool is_spread(const netcdf_frame *fr, const netcdf_columns *c) {
    bool spread[2] = {false, false};
    for (size_t n = 1; n < fr->columns; n++)
        for (int a = 0; a < 2; a++)
            spread[a] = spread[a] || c->at[n][a] != c->at[0][a];
    return spread[0] && spread[1];
}

static status refuse(const netcdf_frame *fr, bool sphere) {
    return status_describe(ST_UNSUPPORTED,
                           "%s: %s: nothing tells where its columns are: expected variables along "
                           "its last two dimensions, or named by its attribute coordinates, in "
                           "degrees_east and degrees_north%s",
                           file_path(fr->f->guard), fr->v.path,
                           sphere ? "" : ", or in metres along x and y");
}

/* ---- on the globe ---- */

static double turned(double degrees) {
    return remainder(degrees, 360);
}

/* Whether a row of longitudes goes around the globe, and ends a step before its first one. */
static bool closes(const double (*at)[3], uint32_t count) {
    double sum = 0, most = 0;
    for (uint32_t i = 0; i + 1 < count; i++) {
        const double step = turned(at[i + 1][0] - at[i][0]);
        sum += step;
        most = fmax(most, fabs(step));
    }
    const double last = turned(at[0][0] - at[count - 1][0]);
    return fabs(fabs(sum + last) - 360) < 1e-3 && last * sum > 0 && fabs(last) > 1e-3 &&
           fabs(last) <= 2 * most;
}

static bool is_whole(const double (*at)[3], uint32_t count) {
    bool whole = true;
    for (uint32_t i = 0; i < count; i++)
        whole = whole && isfinite(at[i][0]) && isfinite(at[i][1]);
    return whole;
}

/* The first row without gaps tells. */
static void find_closes(const netcdf_frame *fr, netcdf_columns *c) {
    const double(*at)[3] = (const double(*)[3])c->at;
    for (uint32_t j = 0; j < fr->n[1]; j++, at += fr->n[0])
        if (is_whole(at, fr->n[0])) {
            c->closes = closes(at, fr->n[0]);
            return;
        }
}

static void raise_globe(const netcdf_frame *fr, netcdf_columns *c) {
    for (size_t n = 0; n < fr->columns; n++) {
        const double east = c->at[n][0] * radian, north = c->at[n][1] * radian;
        c->at[n][0] = cos(north) * cos(east);
        c->at[n][1] = cos(north) * sin(east);
        c->at[n][2] = sin(north);
    }
}

/* ---- on a plane ---- */

/* The longitude of the column in the middle, or of the next one that is somewhere. */
static double middle_of(const netcdf_frame *fr, const netcdf_columns *c) {
    const size_t middle = fr->n[1] / 2 * (size_t)fr->n[0] + fr->n[0] / 2;
    size_t n = 0;
    while (n + 1 < fr->columns && !isfinite(c->at[(middle + n) % fr->columns][0]))
        n++;
    return c->at[(middle + n) % fr->columns][0];
}

static bool has_seam(const netcdf_frame *fr, const netcdf_columns *c) {
    bool seam = false;
    for (uint32_t j = 0; j < fr->n[1]; j++)
        for (uint32_t i = 0; i < fr->n[0]; i++) {
            const size_t n = (size_t)j * fr->n[0] + i;
            seam = seam || (i + 1 < fr->n[0] && netcdf_columns_is_torn(c, n, n + 1)) ||
                   (j + 1 < fr->n[1] && netcdf_columns_is_torn(c, n, n + fr->n[0]));
        }
    return seam;
}

/* Degrees times the length of one in the middle: a plate carree whose standard parallel is the
 * middle latitude. */
static void unroll(const netcdf_frame *fr, netcdf_columns *c) {
    const double east = middle_of(fr, c);
    double low = 90, high = -90;
    for (size_t n = 0; n < fr->columns; n++) {
        low = fmin(low, c->at[n][1]);
        high = fmax(high, c->at[n][1]);
    }
    const double north = (low + high) / 2, metres = NETCDF_EARTH * radian;
    for (size_t n = 0; n < fr->columns; n++) {
        c->at[n][2] = turned(c->at[n][0] - east);
        c->at[n][0] = c->at[n][2] * metres * cos(north * radian);
        c->at[n][1] = (c->at[n][1] - north) * metres;
    }
    c->seam = has_seam(fr, c);
}

/* ---- all of it ---- */

/* Columns that all stand along one axis are no grid, but a list. */
static bool are_both(const search *s, saying first) {
    return s->has[first] && s->has[first + 1] &&
           (s->terms[first].axes | s->terms[first + 1].axes) == (NETCDF_X | NETCDF_Y);
}

static status find_plane(const netcdf_frame *fr, const search *s, netcdf_columns *c, bool *found) {
    *found = false;
    if (c->sphere || !are_both(s, SAYS_X))
        return ST_OK;
    const status st = read_both(fr, s, SAYS_X, c);
    *found = st == ST_OK && is_spread(fr, c);
    for (size_t n = 0; n < fr->columns && *found; n++)
        c->at[n][2] = 0;
    return st;
}

static status find_degrees(const netcdf_frame *fr, const search *s, netcdf_columns *c) {
    if (!are_both(s, SAYS_EAST))
        return refuse(fr, c->sphere);
    const status st = read_both(fr, s, SAYS_EAST, c);
    if (st != ST_OK)
        return st;
    check_norths(fr, c);
    if (c->sphere) {
        find_closes(fr, c);
        raise_globe(fr, c);
    } else {
        unroll(fr, c);
    }
    return ST_OK;
}

static status find(const netcdf_frame *fr, search *s, netcdf_columns *c) {
    bool plane = false;
    take_all(s);
    c->at = mem_array(c->m, fr->columns, sizeof *c->at);
    const status st = c->at ? find_plane(fr, s, c, &plane) : ST_NOMEM;
    return st == ST_OK && !plane ? find_degrees(fr, s, c) : st;
}

status netcdf_columns_find(const netcdf_frame *fr, bool sphere, netcdf_columns *c) {
    search s = {.fr = fr};
    *c = (netcdf_columns){.m = fr->f->m, .sphere = sphere};
    s.terms = mem_array(c->m, SAYINGS, sizeof *s.terms);
    const status st = s.terms ? find(fr, &s, c) : ST_NOMEM;
    mem_free(c->m, s.terms);
    return st;
}

void netcdf_columns_release(netcdf_columns *c) {
    if (c->m)
        mem_free(c->m, c->at);
}

void netcdf_columns_place(const netcdf_columns *c, size_t column, double height, double to[3]) {
    const double *at = c->at[column], radius = NETCDF_EARTH + height;
    for (int a = 0; a < 3; a++)
        to[a] = c->sphere ? radius * at[a] : a < 2 ? at[a] : height;
}

bool netcdf_columns_is_torn(const netcdf_columns *c, size_t a, size_t b) {
    return fabs(c->at[a][2] - c->at[b][2]) > 180;
}
