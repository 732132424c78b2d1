#include "formats/curvilinear/plot3d_flow.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"

static const double gas_gamma = 1.4, gas_constant = 1;

static void density(const double *q, double *out) {
    *out = q[0];
}

static void momentum(const double *q, double *out) {
    memcpy(out, q + 1, 3 * sizeof *out);
}

static void energy(const double *q, double *out) {
    *out = q[4];
}

static void velocity(const double *q, double *out) {
    for (int a = 0; a < 3; a++)
        out[a] = q[1 + a] / q[0];
}

static double square(const double *q) {
    double v[3];
    velocity(q, v);
    return v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
}

static void pressure(const double *q, double *out) {
    *out = (gas_gamma - 1) * (q[4] - 0.5 * q[0] * square(q));
}

static void temperature(const double *q, double *out) {
    pressure(q, out);
    *out /= q[0] * gas_constant;
}

static void sound_speed(const double *q, double *out) {
    pressure(q, out);
    *out = sqrt(gas_gamma * *out / q[0]);
}

static void mach(const double *q, double *out) {
    sound_speed(q, out);
    *out = sqrt(square(q)) / *out;
}

static double logarithm(double x) {
    return x > 0 && isfinite(x) ? portable_log(x) : NAN;
}

static void entropy(const double *q, double *out) {
    pressure(q, out);
    *out = gas_constant / (gas_gamma - 1) *
           (logarithm(gas_gamma * *out) - gas_gamma * logarithm(q[0]));
}

const plot3d_flow plot3d_flows[PLOT3D_FLOWS] = {
    {"density", 1, density},         {"momentum", 3, momentum}, {"energy", 1, energy},
    {"velocity", 3, velocity},       {"pressure", 1, pressure}, {"temperature", 1, temperature},
    {"sound_speed", 1, sound_speed}, {"mach", 1, mach},         {"entropy", 1, entropy},
};
