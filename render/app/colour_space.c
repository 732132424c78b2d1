#include "render/app/colour_space.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "formats/base/portable_math.h"
#include "render/look/picture_bytes.h"

bool colour_space_find(const char *name, colour_space *space) {
    static const struct {
        const char *name;
        colour_space space;
    } NAMES[] = {{"RGB", COLOUR_RGB},
                 {"HSV", COLOUR_HSV},
                 {"Lab", COLOUR_LAB},
                 {"CIELAB", COLOUR_LAB},
                 {"Wrapped", COLOUR_HSV_WRAPPED},
                 {"Diverging", COLOUR_DIVERGING}};
    for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++)
        if (strcmp(name, NAMES[i].name) == 0) {
            *space = NAMES[i].space;
            return true;
        }
    return false;
}

static double between(double a, double b, double s) {
    return (1.0 - s) * a + s * b;
}

static void linear_of(const double encoded[3], double linear[3]) {
    for (int i = 0; i < 3; i++)
        linear[i] = picture_linear(encoded[i]);
}

static void between_light(const double a[3], const double b[3], double s, double linear[3]) {
    double from[3], to[3];
    linear_of(a, from);
    linear_of(b, to);
    for (int i = 0; i < 3; i++)
        linear[i] = between(from[i], to[i], s);
}

/* x^e for x >= 0. */
static double power(double x, double e) {
    return x > 0.0 ? portable_exp(e * portable_log(x)) : 0.0;
}

/* ---- HSV (Smith 1978) ---- */

static void hsv_of(const double rgb[3], double hsv[3]) {
    const double most = fmax(rgb[0], fmax(rgb[1], rgb[2]));
    const double span = most - fmin(rgb[0], fmin(rgb[1], rgb[2]));
    hsv[0] = 0.0;
    hsv[1] = most > 0.0 ? span / most : 0.0;
    hsv[2] = most;
    if (!(hsv[1] > 0.0))
        return;
    const int main = rgb[0] >= most ? 0 : rgb[1] >= most ? 1 : 2;
    const double off = (rgb[(main + 1) % 3] - rgb[(main + 2) % 3]) / span;
    hsv[0] = (2.0 * main + off) / 6.0;
    if (hsv[0] < 0.0)
        hsv[0] += 1.0;
}

/* Returns the share of a component whose own hue is `at`, by its distance from `hue` in sixths of a
 * turn. */
static double hue_share(double hue, double at) {
    double away = fabs(6.0 * (hue - at));
    away = away > 3.0 ? 6.0 - away : away;
    return away < 1.0 ? 1.0 : away < 2.0 ? 2.0 - away : 0.0;
}

static void rgb_of_hsv(const double hsv[3], double rgb[3]) {
    for (int i = 0; i < 3; i++)
        rgb[i] = hsv[2] * between(1.0, hue_share(hsv[0], i / 3.0), hsv[1]);
}

static void between_hsv(bool wrapped, const double a[3], const double b[3], double s,
                        double rgb[3]) {
    double from[3], to[3], hsv[3];
    hsv_of(a, from);
    hsv_of(b, to);
    if (wrapped && from[0] - to[0] > 0.5)
        from[0] -= 1.0;
    else if (wrapped && to[0] - from[0] > 0.5)
        to[0] -= 1.0;
    for (int i = 0; i < 3; i++)
        hsv[i] = between(from[i], to[i], s);
    if (hsv[0] < 0.0)
        hsv[0] += 1.0;
    rgb_of_hsv(hsv, rgb);
}

/* ---- CIE L*a*b* ---- */

/* White point D65, primaries of sRGB (IEC 61966-2-1). */
static const double WHITE[3] = {0.9505, 1.0, 1.089};
static const double TO_XYZ[3][3] = {
    {0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}};
static const double FROM_XYZ[3][3] = {
    {3.2406, -1.5372, -0.4986}, {-0.9689, 1.8758, 0.0415}, {0.0557, -0.2040, 1.0570}};

/* Returns the cube root; near 0, where that is steep, a line. */
static double lightness(double t) {
    return t > 0.008856 ? power(t, 1.0 / 3.0) : 7.787 * t + 16.0 / 116.0;
}

static double of_lightness(double f) {
    const double cube = f * f * f;
    return cube > 0.008856 ? cube : (f - 16.0 / 116.0) / 7.787;
}

static void lab_of(const double rgb[3], double lab[3]) {
    double linear[3], f[3];
    linear_of(rgb, linear);
    for (int i = 0; i < 3; i++)
        f[i] = lightness(
            (TO_XYZ[i][0] * linear[0] + TO_XYZ[i][1] * linear[1] + TO_XYZ[i][2] * linear[2]) /
            WHITE[i]);
    lab[0] = 116.0 * f[1] - 16.0;
    lab[1] = 500.0 * (f[0] - f[1]);
    lab[2] = 200.0 * (f[1] - f[2]);
}

double colour_space_encoded(double linear) {
    return linear > 0.0031308 ? 1.055 * power(linear, 1.0 / 2.4) - 0.055 : 12.92 * linear;
}

/* Scale colours that are too bright, in sRGB values, then clamp components below 0 to black. */
static void bring_back(double linear[3]) {
    const double most = fmax(linear[0], fmax(linear[1], linear[2]));
    if (most > 1.0) {
        const double brightest = colour_space_encoded(most);
        for (int i = 0; i < 3; i++)
            linear[i] = picture_linear(colour_space_encoded(linear[i]) / brightest);
    }
    for (int i = 0; i < 3; i++)
        linear[i] = fmin(fmax(linear[i], 0.0), 1.0);
}

static void linear_of_lab(const double lab[3], double linear[3]) {
    const double y = (lab[0] + 16.0) / 116.0;
    const double f[3] = {y + lab[1] / 500.0, y, y - lab[2] / 200.0};
    double xyz[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = of_lightness(f[i]) * WHITE[i];
    for (int i = 0; i < 3; i++)
        linear[i] = FROM_XYZ[i][0] * xyz[0] + FROM_XYZ[i][1] * xyz[1] + FROM_XYZ[i][2] * xyz[2];
    bring_back(linear);
}

static void between_lab(const double a[3], const double b[3], double s, double linear[3]) {
    double from[3], to[3], lab[3];
    lab_of(a, from);
    lab_of(b, to);
    for (int i = 0; i < 3; i++)
        lab[i] = between(from[i], to[i], s);
    linear_of_lab(lab, linear);
}

/* ---- Moreland, Diverging Color Maps for Scientific Visualization, 2009 ---- */

/* L*a*b* in polar form; angles in turns. */
typedef struct msh {
    double m, s, h;
} msh;

static const double TURN = 6.283185307179586; /* radians */

static msh msh_of(const double rgb[3]) {
    double lab[3];
    lab_of(rgb, lab);
    const double across = sqrt(lab[1] * lab[1] + lab[2] * lab[2]);
    msh p = {sqrt(lab[0] * lab[0] + across * across), 0.0, 0.0};
    if (p.m > 0.001)
        p.s = portable_angle(across, lab[0]);
    if (p.s * TURN > 0.001)
        p.h = portable_angle(lab[2], lab[1]);
    return p;
}

static bool saturated(const msh *p) {
    return p->s * TURN > 0.05;
}

/* Returns whether two hues are at least 0.33 of half a turn apart. */
static bool distinct(const msh *a, const msh *b) {
    const double apart = fabs(a->h - b->h);
    return (apart > 0.5 ? 1.0 - apart : apart) > 0.33 / 2.0;
}

/* Returns the hue to give an unsaturated colour of magnitude m when interpolating to this one. */
static double spun_hue(const msh *to, double m) {
    if (to->m >= m - 0.1)
        return to->h;
    const double spin = to->s * sqrt(m * m - to->m * to->m) / (to->m * portable_sin(to->s));
    return to->h > -0.3 / 2.0 ? to->h + spin : to->h - spin;
}

static void between_diverging(const double a[3], const double b[3], double s, double linear[3]) {
    msh from = msh_of(a), to = msh_of(b);
    if (saturated(&from) && saturated(&to) && distinct(&from, &to)) {
        const msh white = {fmax(88.0, fmax(from.m, to.m)), 0.0, 0.0};
        *(s < 0.5 ? &to : &from) = white;
        s = s < 0.5 ? 2.0 * s : 2.0 * s - 1.0;
    }
    if (!saturated(&from) && saturated(&to))
        from.h = spun_hue(&to, from.m);
    else if (!saturated(&to) && saturated(&from))
        to.h = spun_hue(&from, to.m);
    const double m = between(from.m, to.m, s), turns = between(from.s, to.s, s);
    const double hue = between(from.h, to.h, s), across = m * portable_sin(turns);
    linear_of_lab((const double[3]){m * portable_cos(turns), across * portable_cos(hue),
                                    across * portable_sin(hue)},
                  linear);
}

void colour_space_between(colour_space space, const double a[3], const double b[3], double s,
                          double linear[3]) {
    double rgb[3];
    switch (space) {
    case COLOUR_LINEAR: between_light(a, b, s, linear); return;
    case COLOUR_LAB: between_lab(a, b, s, linear); return;
    case COLOUR_DIVERGING: between_diverging(a, b, s, linear); return;
    case COLOUR_HSV:
    case COLOUR_HSV_WRAPPED: between_hsv(space == COLOUR_HSV_WRAPPED, a, b, s, rgb); break;
    case COLOUR_RGB:
        for (int i = 0; i < 3; i++)
            rgb[i] = between(a[i], b[i], s);
    }
    for (int i = 0; i < 3; i++)
        rgb[i] = fmin(fmax(rgb[i], 0.0), 1.0);
    linear_of(rgb, linear);
}
