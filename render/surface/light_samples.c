#include "render/surface/light_samples.h"

#include <math.h>

#include "formats/base/portable_math.h"

static const uint32_t R2_A = 0xc13fa9a9, R2_B = 0x91e10da5, GOLDEN = 0x9e3779b9;

static uint32_t reversed(uint32_t m) {
    uint32_t out = 0;
    for (int i = 0; i < 32; i++)
        out |= (m >> i & 1u) << (31 - i);
    return out;
}

void light_samples_point(const frame *f, uint32_t pixel, uint32_t q, int k, int n, double uv[2]) {
    const uint32_t x = (uint32_t)f->camera.window[0] + pixel % f->width,
                   y = (uint32_t)f->camera.window[1] + pixel / f->width;
    const uint64_t all = (uint64_t)n * (f->samples > 0 ? f->samples : 1);
    const uint32_t m = f->sample * (uint32_t)n + (uint32_t)k;
    const uint32_t u = (uint32_t)(((2 * (uint64_t)m + 1) << 31) / all);
    uv[0] = (double)(uint32_t)(u + x * R2_A + y * R2_B + q * GOLDEN) * 0x1p-32;
    uv[1] = (double)(uint32_t)(reversed(m) + x * R2_B + y * R2_A) * 0x1p-32;
}

/* Set `to` to the unit vector at `turns` around a unit axis, at the angle with this sine and
 * cosine from it. Duff et al. 2017, "Building an Orthonormal Basis, Revisited". */
static void around(const double axis[3], double sine, double cosine, double turns, double to[3]) {
    const double x = axis[0], y = axis[1], z = axis[2], sign = z < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + z), b = x * y * a;
    const double side[3] = {1.0 + sign * x * x * a, sign * b, -sign * x};
    const double other[3] = {b, sign + y * y * a, -y};
    double s, c;
    portable_sincos(turns, &s, &c);
    for (int i = 0; i < 3; i++)
        to[i] = sine * (c * side[i] + s * other[i]) + cosine * axis[i];
}

lit_way light_samples_light(const leafcast_light *light, const lit_way *middle,
                            const double uv[2]) {
    const double share = light->radius / middle->distance, square = share * share,
                 half = portable_sin(light->radius / 720.0);
    /* 1 - cos of the cone's angle, and of the sample's: small angles lose no digits. */
    const double cone = light->point ? square / (1.0 + sqrt(1.0 - square)) : 2.0 * half * half;
    const double from_axis = uv[0] * cone, sine_square = from_axis * (2.0 - from_axis);
    lit_way way = {.distance = middle->distance};
    around(middle->to, sqrt(sine_square), 1.0 - from_axis, uv[1], way.to);
    if (light->point)
        way.distance *= 1.0 - from_axis - sqrt(fmax(square - sine_square, 0.0));
    return way;
}

void light_samples_about(const float normal[3], const double uv[2], double to[3]) {
    double axis[3], length = 0.0;
    for (int a = 0; a < 3; a++)
        length += (double)normal[a] * (double)normal[a];
    for (int a = 0; a < 3; a++)
        axis[a] = (double)normal[a] / sqrt(length);
    around(axis, sqrt(uv[0]), sqrt(1.0 - uv[0]), uv[1], to);
}
