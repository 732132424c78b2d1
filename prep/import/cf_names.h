/* cf_names.h - names of the CF conventions, for files read by netCDF and by HDF5, in which netCDF-4
 * is written.
 *
 * Variables named in another variable's attribute describe that one. They are coordinates, bounds,
 * errors and the like, and not fields. Pure; any thread.
 */
#ifndef PREP_IMPORT_CF_NAMES_H
#define PREP_IMPORT_CF_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/* Attributes that name variables, and the role of those; CF_ROLES of them. */
enum { CF_ROLES = 7, CF_TEXT = 1024 };
typedef struct cf_role {
    const char *attribute, *role;
} cf_role;
extern const cf_role cf_roles[CF_ROLES];

/* cf_next_name() - the next name of a list such as "area: a volume: v", without its keys, which end
 * in a colon. Moves *at behind it. Returns false at the end. */
bool cf_next_name(const char **at, char *to, size_t room);

/* Attributes of a coordinate variable; "": missing. */
typedef struct cf_coordinates {
    char units[128], standard_name[64], axis[8], time_origin[64], positive[16];
} cf_coordinates;

/* cf_is_time() - returns whether the coordinates are times: by units ("days since ..", months),
 * axis T or a standard name. If all of these are missing, by the name of the dimension. */
bool cf_is_time(const cf_coordinates *c, const char *dimension);

/* cf_goes_down() - returns whether coordinates grow downwards: depths (positive: down, or by their
 * standard name) and pressures. */
bool cf_goes_down(const cf_coordinates *c);

/* cf_is_east() - returns whether coordinates are longitudes on a globe. cf_is_north() - whether
 * they are latitudes. */
bool cf_is_east(const char *units, const char *standard_name);
bool cf_is_north(const char *units, const char *standard_name);

/* cf_measure_of() - what numbers of these units measure, and by how many metres or pascals each.
 * Decibars of the sea are metres. */
typedef enum cf_measure { CF_OTHER, CF_LENGTH, CF_PRESSURE } cf_measure;
cf_measure cf_measure_of(const char *units, double *factor);

/* cf_term() - the variable that formula_terms names for a term, as in "s: s_rho eta: zeta". Returns
 * false if it names none. */
bool cf_term(const char *formula_terms, const char *term, char *to, size_t room);

#endif
