/* cf_names.h - the words of the conventions of CF, whatever library reads the file: netCDF's own,
 * and HDF5's, in which netCDF-4 is written.
 *
 * Variables that others name in an attribute describe those: they are coordinates, bounds, errors
 * and the like, and no fields. Pure; any thread.
 */
#ifndef PREP_IMPORT_CF_NAMES_H
#define PREP_IMPORT_CF_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/* What an attribute names, and what that is then; CF_ROLES of them. */
enum { CF_ROLES = 7, CF_TEXT = 1024 };
typedef struct cf_role {
    const char *attribute, *role;
} cf_role;
extern const cf_role cf_roles[CF_ROLES];

/* cf_next_name() - the next name of a list such as "area: a volume: v", without its keys, which end
 * in a colon; *at moves behind it. False: there are no more. */
bool cf_next_name(const char **at, char *to, size_t room);

/* What coordinates say of themselves; "" where an attribute is missing. */
typedef struct cf_coordinates {
    char units[128], standard_name[64], axis[8], time_origin[64], positive[16];
} cf_coordinates;

/* cf_is_time() - whether they are times: by units ("days since ..", months), axis T or a standard
 * name; where none of these is told, by the name of the dimension. */
bool cf_is_time(const cf_coordinates *c, const char *dimension);

/* cf_goes_down() - whether they grow downwards: depths (positive: down) and pressures. */
bool cf_goes_down(const cf_coordinates *c);

#endif
