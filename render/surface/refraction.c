#include "render/surface/refraction.h"

#include <math.h>

void refraction_mirror(const double direction[3], const float normal[3], double to[3]) {
    double along = 0.0, square = 0.0, length = 0.0;
    for (int a = 0; a < 3; a++) {
        along += direction[a] * (double)normal[a];
        square += (double)normal[a] * (double)normal[a];
    }
    for (int a = 0; a < 3; a++) {
        to[a] = direction[a] - 2.0 * along / square * (double)normal[a];
        length += to[a] * to[a];
    }
    for (int a = 0; a < 3; a++)
        to[a] /= sqrt(length);
}

/* Set `unit` to the normal on the side that the ray comes from. Returns the cosine of the angle
 * between them. */
static double face(const double direction[3], const float normal[3], double unit[3]) {
    double along = 0.0, square = 0.0;
    for (int a = 0; a < 3; a++) {
        along += direction[a] * (double)normal[a];
        square += (double)normal[a] * (double)normal[a];
    }
    const double length = along > 0.0 ? -sqrt(square) : sqrt(square);
    for (int a = 0; a < 3; a++)
        unit[a] = (double)normal[a] / length;
    return fmin(-along / length, 1.0);
}

/* The share that is mirrored: the mean of both directions in which light swings. */
static double fresnel(double ratio, double before, double behind) {
    const double across = (ratio * before - behind) / (ratio * before + behind);
    const double along = (ratio * behind - before) / (ratio * behind + before);
    return 0.5 * (across * across + along * along);
}

refraction refraction_of(const double direction[3], const float normal[3], double ratio) {
    refraction out = {.share = 1.0};
    double unit[3], length = 0.0;
    const double before = face(direction, normal, unit);
    const double square = 1.0 - ratio * ratio * (1.0 - before * before);
    refraction_mirror(direction, normal, out.mirrored);
    if (!(square > 0.0))
        return out;
    const double behind = sqrt(square);
    for (int a = 0; a < 3; a++) {
        out.refracted[a] = ratio * direction[a] + (ratio * before - behind) * unit[a];
        length += out.refracted[a] * out.refracted[a];
    }
    for (int a = 0; a < 3; a++)
        out.refracted[a] /= sqrt(length);
    out.share = fresnel(ratio, before, behind);
    return out;
}
