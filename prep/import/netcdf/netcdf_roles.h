/* netcdf_roles.h - roles of variables and dimensions by the CF conventions (cf_names.h). */
#ifndef PREP_IMPORT_NETCDF_NETCDF_ROLES_H
#define PREP_IMPORT_NETCDF_NETCDF_ROLES_H

#include <stdbool.h>
#include <stddef.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

typedef struct netcdf_role {
    int group, id;    /* of the variable */
    const char *name; /* such as "bounds", for a list; constant */
} netcdf_role;

/* Zeros: no role is known. */
typedef struct netcdf_roles {
    mem *m;
    netcdf_role *items;
    size_t count, room;
} netcdf_roles;

/* netcdf_roles_add() - add the roles of variables that attributes in one group name. ST_NOMEM. */
CHECKED status netcdf_roles_add(netcdf_roles *r, int group);
void netcdf_roles_release(netcdf_roles *r);

/* netcdf_roles_of() - the role of a variable; NULL: it is a field. */
const char *netcdf_roles_of(const netcdf_roles *r, int group, int id);

/* netcdf_find() - find a variable by its name, in a group or the groups around it, or by its path
 * from the root. */
bool netcdf_find(int group, const char *name, int *in, int *id);

/* netcdf_coordinates() - find the coordinates of a dimension: the variable of its name, of numbers
 * along it alone, in the same group or one around it. */
bool netcdf_coordinates(int group, int dim, int *in, int *id);

/* netcdf_is_time() - returns whether a dimension counts times. netcdf_goes_down() - returns whether
 * coordinates grow downwards. */
bool netcdf_is_time(int group, int dim);
bool netcdf_goes_down(int group, int id);

#endif
