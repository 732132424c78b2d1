#include "prep/import/netcdf/netcdf_formulas.h"

#include <math.h>
#include <string.h>

#include "prep/import/cf_names.h"

/* ---- formulas ---- */

/* sigma eta depth */
static double ocean_sigma(const double *t) {
    return t[1] + t[0] * (t[2] + t[1]);
}

/* Height at a stretched level S of water from -depth to eta. */
static double stretched(double level, double eta, double depth) {
    return level + eta * (1 + level / depth);
}

/* s C eta depth depth_c */
static double ocean_s_g1(const double *t) {
    return stretched(t[4] * t[0] + (t[3] - t[4]) * t[1], t[2], t[3]);
}

/* s C eta depth depth_c */
static double ocean_s_g2(const double *t) {
    const double level = (t[4] * t[0] + t[3] * t[1]) / (t[3] + t[4]);
    return t[2] + (t[2] + t[3]) * level;
}

/* s eta depth a b depth_c */
static double ocean_s(const double *t) {
    const double a = t[3], b = t[4];
    const double c = a == 0 ? t[0] /* the limit */
                            : (1 - b) * sinh(a * t[0]) / sinh(a) +
                                  b * (tanh(a * (t[0] + 0.5)) / (2 * tanh(0.5 * a)) - 0.5);
    return t[1] * (1 + t[0]) + t[5] * t[0] + (t[2] - t[5]) * c;
}

/* sigma ps ptop */
static double atmosphere_sigma(const double *t) {
    return t[2] + t[0] * (t[1] - t[2]);
}

/* a b ps p0 */
static double atmosphere_hybrid(const double *t) {
    return t[0] * t[3] + t[1] * t[2];
}

/* ap b ps */
static double atmosphere_hybrid_ap(const double *t) {
    return t[0] + t[1] * t[2];
}

/* p0 lev */
static double atmosphere_ln(const double *t) {
    return t[0] * exp(-t[1]);
}

/* a b orog */
static double atmosphere_hybrid_height(const double *t) {
    return t[0] + t[1] * t[2];
}

/* ocean_s_coordinate with C is what ROMS wrote before the two others had a name,
 * hybrid_sigma_pressure what ECHAM and CDO did. */
static const netcdf_formula formulas[] = {
    {"ocean_sigma_coordinate", {"sigma", "eta", "depth"}, ocean_sigma, false},
    {"ocean_s_coordinate_g1", {"s", "C", "eta", "depth", "depth_c"}, ocean_s_g1, false},
    {"ocean_s_coordinate_g2", {"s", "C", "eta", "depth", "depth_c"}, ocean_s_g2, false},
    {"ocean_s_coordinate", {"s", "C", "eta", "depth", "depth_c"}, ocean_s_g1, false},
    {"ocean_s_coordinate", {"s", "eta", "depth", "a", "b", "depth_c"}, ocean_s, false},
    {"atmosphere_sigma_coordinate", {"sigma", "ps", "ptop"}, atmosphere_sigma, true},
    {"atmosphere_hybrid_sigma_pressure_coordinate",
     {"a", "b", "ps", "p0"},
     atmosphere_hybrid,
     true},
    {"atmosphere_hybrid_sigma_pressure_coordinate", {"ap", "b", "ps"}, atmosphere_hybrid_ap, true},
    {"hybrid_sigma_pressure", {"a", "b", "ps", "p0"}, atmosphere_hybrid, true},
    {"hybrid_sigma_pressure", {"ap", "b", "ps"}, atmosphere_hybrid_ap, true},
    {"atmosphere_ln_pressure_coordinate", {"p0", "lev"}, atmosphere_ln, true},
    {"atmosphere_hybrid_height_coordinate", {"a", "b", "orog"}, atmosphere_hybrid_height, false},
};

static bool has_all(const netcdf_formula *f, const char *formula_terms) {
    char name[CF_TEXT];
    bool all = true;
    for (int i = 0; i < NETCDF_TERMS && f->terms[i]; i++)
        all = all && cf_term(formula_terms, f->terms[i], name, sizeof name);
    return all;
}

const netcdf_formula *netcdf_formula_find(const char *standard_name, const char *formula_terms) {
    for (size_t i = 0; i < sizeof formulas / sizeof *formulas; i++)
        if (strcmp(formulas[i].standard_name, standard_name) == 0 &&
            has_all(&formulas[i], formula_terms))
            return &formulas[i];
    return NULL;
}

/* ---- the standard atmosphere ---- */

/* Layers up to 86 km: the geopotential height where one begins, and how fast it warms upwards. */
static const struct {
    double height, lapse; /* m, K / m */
} layers[] = {{0, -0.0065}, {11000, 0},       {20000, 0.001}, {32000, 0.0028},
              {47000, 0},   {51000, -0.0028}, {71000, -0.002}};
enum { LAYERS = sizeof layers / sizeof *layers };

double netcdf_formula_height(double pressure) {
    static const double gas = 9.80665 * 0.0289644 / 8.31432; /* K / m */
    double base = 101325, kelvin = 288.15;
    if (!(pressure > 0))
        return NAN;
    for (int i = 0;; i++) {
        const double lapse = layers[i].lapse;
        const double height =
            layers[i].height + (lapse == 0
                                    ? log(base / pressure) * kelvin / gas
                                    : kelvin / lapse * (pow(pressure / base, -lapse / gas) - 1));
        if (i + 1 == LAYERS || height <= layers[i + 1].height)
            return height;
        const double rise = layers[i + 1].height - layers[i].height;
        base *=
            lapse == 0 ? exp(-gas * rise / kelvin) : pow(1 + lapse * rise / kelvin, -gas / lapse);
        kelvin += lapse * rise;
    }
}
