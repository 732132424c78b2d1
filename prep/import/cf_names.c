#include "prep/import/cf_names.h"

#include <string.h>
#include <strings.h>

const cf_role cf_roles[CF_ROLES] = {{"coordinates", "coordinates"},
                                    {"bounds", "bounds"},
                                    {"climatology", "bounds"},
                                    {"ancillary_variables", "ancillary"},
                                    {"grid_mapping", "grid mapping"},
                                    {"cell_measures", "cell measures"},
                                    {"formula_terms", "terms of a formula"}};

static const char gaps[] = " \t\r\n,";

bool cf_next_name(const char **at, char *to, size_t room) {
    for (;;) {
        *at += strspn(*at, gaps);
        const size_t length = strcspn(*at, gaps);
        if (length == 0)
            return false;
        const char *word = *at;
        *at += length;
        if (word[length - 1] == ':' || length >= room)
            continue;
        memcpy(to, word, length);
        to[length] = 0;
        return true;
    }
}

static bool has_word(const char *text, const char *word) {
    return strcasestr(text, word) != NULL;
}

static bool is_any(const char *text, const char *const *words) {
    while (*words && strcasecmp(text, *words) != 0)
        words++;
    return *words != NULL;
}

/* Returns whether a name is that of times, such as "Time", "time_counter", "MONTH_REG", "day". */
static bool is_called_time(const char *name) {
    static const char *const exact[] = {"day",   "days", "hour", "hours", "year",
                                        "years", "date", "t",    NULL};
    return has_word(name, "time") || has_word(name, "month") || is_any(name, exact);
}

bool cf_is_time(const cf_coordinates *c, const char *dimension) {
    static const char *const names[] = {"time", "forecast_reference_time", NULL};
    static const char *const months[] = {"month", "months", "month number", NULL};
    if (has_word(c->units, " since ") || strcasecmp(c->axis, "T") == 0 ||
        is_any(c->standard_name, names) || is_any(c->units, months) || c->time_origin[0])
        return true;
    return !c->axis[0] && !c->standard_name[0] && is_called_time(dimension);
}

bool cf_goes_down(const cf_coordinates *c) {
    static const char *const pressures[] = {"Pa",       "hPa",       "kPa", "mbar",
                                            "millibar", "millibars", "mb",  "dbar",
                                            "decibar",  "decibars",  NULL};
    if (c->positive[0])
        return strcasecmp(c->positive, "down") == 0;
    if (strncmp(c->standard_name, "depth", 5) == 0)
        return true;
    return is_any(c->units, pressures);
}

/* ---- places ---- */

bool cf_is_east(const char *units, const char *standard_name) {
    static const char *const known[] = {"degrees_east", "degree_east", "degree_E", "degrees_E",
                                        "degreeE",      "degreesE",    NULL};
    return is_any(units, known) || strcmp(standard_name, "longitude") == 0;
}

bool cf_is_north(const char *units, const char *standard_name) {
    static const char *const known[] = {"degrees_north", "degree_north", "degree_N", "degrees_N",
                                        "degreeN",       "degreesN",     NULL};
    return is_any(units, known) || strcmp(standard_name, "latitude") == 0;
}

cf_measure cf_measure_of(const char *units, double *factor) {
    static const struct {
        const char *const names[6];
        cf_measure is;
        double factor;
    } known[] = {
        {{"m", "meter", "meters", "metre", "metres", NULL}, CF_LENGTH, 1},
        {{"km", "kilometer", "kilometers", "kilometre", "kilometres", NULL}, CF_LENGTH, 1000},
        {{"cm", "centimeter", "centimeters", "centimetre", "centimetres", NULL}, CF_LENGTH, 0.01},
        {{"gpm", "geopotential meter", "geopotential metre", NULL}, CF_LENGTH, 1},
        {{"dbar", "decibar", "decibars", NULL}, CF_LENGTH, 1},
        {{"Pa", "pascal", "pascals", NULL}, CF_PRESSURE, 1},
        {{"hPa", "mbar", "mb", "millibar", "millibars", NULL}, CF_PRESSURE, 100},
        {{"kPa", "kilopascal", "kilopascals", NULL}, CF_PRESSURE, 1000},
        {{"bar", "bars", NULL}, CF_PRESSURE, 100000}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (is_any(units, known[i].names)) {
            *factor = known[i].factor;
            return known[i].is;
        }
    return CF_OTHER;
}

bool cf_term(const char *formula_terms, const char *term, char *to, size_t room) {
    const size_t length = strlen(term);
    for (const char *at = formula_terms; *(at += strspn(at, gaps));) {
        const size_t word = strcspn(at, gaps);
        const bool is = word == length + 1 && at[length] == ':' && strncmp(at, term, length) == 0;
        at += word;
        if (is)
            return cf_next_name(&at, to, room);
    }
    return false;
}
