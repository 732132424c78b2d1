/* netcdf_formulas.h - heights by the parametric vertical coordinates of the CF conventions (1.10,
 * appendix D), and by pressures. Pure; any thread.
 */
#ifndef PREP_IMPORT_NETCDF_NETCDF_FORMULAS_H
#define PREP_IMPORT_NETCDF_NETCDF_FORMULAS_H

#include <stdbool.h>
#include <stddef.h>

enum { NETCDF_TERMS = 6 };

typedef struct netcdf_formula {
    const char *standard_name;
    const char *terms[NETCDF_TERMS]; /* in the order of t; NULL behind the last one */
    double (*value)(const double t[NETCDF_TERMS]);
    bool pressure; /* the value is one, in the units of the terms; else a height, in metres */
} netcdf_formula;

/* netcdf_formula_find() - find the formula of a standard name whose terms are all named in
 * formula_terms. NULL: there is none. */
const netcdf_formula *netcdf_formula_find(const char *standard_name, const char *formula_terms);

/* netcdf_formula_height() - the height in metres at which the U.S. Standard Atmosphere (1976) has a
 * pressure, in Pa; beyond 0.37 Pa as if its last layer went on. NaN: it is not above 0. */
double netcdf_formula_height(double pressure);

#endif
