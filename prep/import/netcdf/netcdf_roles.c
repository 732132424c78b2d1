#include "prep/import/netcdf/netcdf_roles.h"

#include <string.h>
#include <strings.h>

#include "prep/import/cf_names.h"
#include "prep/import/netcdf/netcdf_variable.h"

/* ---- names ---- */

/* Find a variable by its path from the root: "/a/b/v". */
static bool find_path(int group, const char *path, int *in, int *id) {
    char group_path[CF_TEXT];
    const char *last = strrchr(path, '/');
    while (nc_inq_grp_parent(group, in) == NC_NOERR)
        group = *in;
    *in = group;
    if (last > path) {
        const size_t length = (size_t)(last - path);
        if (length >= sizeof group_path)
            return false;
        memcpy(group_path, path, length);
        group_path[length] = 0;
        if (nc_inq_grp_full_ncid(group, group_path, in) != NC_NOERR)
            return false;
    }
    return nc_inq_varid(*in, last + 1, id) == NC_NOERR;
}

bool netcdf_find(int group, const char *name, int *in, int *id) {
    if (name[0] == '/')
        return find_path(group, name, in, id);
    for (*in = group; nc_inq_varid(*in, name, id) != NC_NOERR;)
        if (nc_inq_grp_parent(*in, in) != NC_NOERR)
            return false;
    return true;
}

/* ---- roles ---- */

static status add_named(netcdf_roles *r, int group, const char *text, const char *role) {
    char name[NC_MAX_NAME + 1];
    while (cf_next_name(&text, name, sizeof name)) {
        netcdf_role one = {.name = role};
        if (!netcdf_find(group, name, &one.group, &one.id))
            continue;
        status st = mem_grow(r->m, &r->items, sizeof one, r->count, 32, &r->room);
        if (st != ST_OK)
            return st;
        r->items[r->count++] = one;
    }
    return ST_OK;
}

/* WRF tells heights by two variables of their own. */
static status add_geopotential(netcdf_roles *r, int group) {
    int id;
    if (nc_inq_varid(group, "PH", &id) != NC_NOERR || nc_inq_varid(group, "PHB", &id) != NC_NOERR)
        return ST_OK;
    return add_named(r, group, "PH PHB", "geopotential");
}

status netcdf_roles_add(netcdf_roles *r, int group) {
    int count = 0;
    const status added = add_geopotential(r, group);
    if (added != ST_OK)
        return added;
    nc_inq_nvars(group, &count);
    for (int id = 0; id < count; id++)
        for (int i = 0; i < CF_ROLES; i++) {
            char text[CF_TEXT];
            netcdf_text(group, id, cf_roles[i].attribute, text, sizeof text);
            status st = add_named(r, group, text, cf_roles[i].role);
            if (st != ST_OK)
                return st;
        }
    return ST_OK;
}

void netcdf_roles_release(netcdf_roles *r) {
    mem_free(r->m, r->items);
    r->items = NULL;
    r->count = 0;
}

const char *netcdf_roles_of(const netcdf_roles *r, int group, int id) {
    for (size_t i = 0; i < r->count; i++)
        if (r->items[i].group == group && r->items[i].id == id)
            return r->items[i].name;
    return NULL;
}

/* ---- dimensions ---- */

bool netcdf_coordinates(int group, int dim, int *in, int *id) {
    char name[NC_MAX_NAME + 1];
    int rank = 0, own = -1;
    nc_type type = NC_CHAR;
    return nc_inq_dimname(group, dim, name) == NC_NOERR && netcdf_find(group, name, in, id) &&
           nc_inq_varndims(*in, *id, &rank) == NC_NOERR && rank == 1 &&
           nc_inq_vardimid(*in, *id, &own) == NC_NOERR && own == dim &&
           nc_inq_vartype(*in, *id, &type) == NC_NOERR && type != NC_CHAR && type <= NC_UINT64;
}

static void read_coordinates(int group, int id, cf_coordinates *c) {
    netcdf_text(group, id, "units", c->units, sizeof c->units);
    netcdf_text(group, id, "standard_name", c->standard_name, sizeof c->standard_name);
    netcdf_text(group, id, "axis", c->axis, sizeof c->axis);
    if (!c->axis[0])
        netcdf_text(group, id, "cartesian_axis", c->axis, sizeof c->axis);
    netcdf_text(group, id, "time_origin", c->time_origin, sizeof c->time_origin);
    netcdf_text(group, id, "positive", c->positive, sizeof c->positive);
}

bool netcdf_is_time(int group, int dim) {
    cf_coordinates c = {0};
    char name[NC_MAX_NAME + 1] = "";
    int in, id;
    if (netcdf_coordinates(group, dim, &in, &id))
        read_coordinates(in, id, &c);
    nc_inq_dimname(group, dim, name);
    return cf_is_time(&c, name);
}

bool netcdf_goes_down(int group, int id) {
    cf_coordinates c = {0};
    char name[NC_MAX_NAME + 1] = "";
    read_coordinates(group, id, &c);
    nc_inq_varname(group, id, name);
    const bool is_depth = !c.positive[0] && strncasecmp(name, "depth", 5) == 0;
    return is_depth || cf_goes_down(&c);
}
