#include "formats/leaf/triangle_normal.h"

#include <math.h>
#include <stdlib.h>

enum { SCALE = 32767 };

static int32_t half_of(uint32_t code, unsigned shift) {
    const int32_t bits = (int32_t)(code >> shift & 0xffff);
    return bits < 0x8000 ? bits : bits - 0x10000;
}

static double with_sign(double size, double of) {
    return of < 0.0 ? -size : size;
}

uint32_t triangle_normal_encode(const double normal[3]) {
    const double most = fmax(fabs(normal[0]), fmax(fabs(normal[1]), fabs(normal[2])));
    if (!isfinite(normal[0] + normal[1] + normal[2]) || !(most > 0.0))
        return TRIANGLE_NO_NORMAL;
    double n[3], sum = 0.0;
    for (int a = 0; a < 3; a++) {
        n[a] = normal[a] / most; /* so that no sum is too large or too small */
        sum += fabs(n[a]);
    }
    double u = n[0] / sum, v = n[1] / sum;
    if (n[2] < 0.0) {
        const double x = u;
        u = with_sign(1.0 - fabs(v), x);
        v = with_sign(1.0 - fabs(x), v);
    }
    const int32_t low = (int32_t)nearbyint(u * SCALE), high = (int32_t)nearbyint(v * SCALE);
    return ((uint32_t)low & 0xffff) | (uint32_t)high << 16;
}

bool triangle_normal_is_code(uint32_t code) {
    return code == TRIANGLE_NO_NORMAL ||
           (half_of(code, 0) >= -SCALE && half_of(code, 16) >= -SCALE);
}

bool triangle_normal_decode(uint32_t code, double unit[3]) {
    const int32_t u = half_of(code, 0), v = half_of(code, 16);
    int32_t n[3] = {u, v, SCALE - abs(u) - abs(v)};
    if (u < -SCALE || v < -SCALE)
        return false;
    if (n[2] < 0) {
        n[0] = u < 0 ? abs(v) - SCALE : SCALE - abs(v);
        n[1] = v < 0 ? abs(u) - SCALE : SCALE - abs(u);
    }
    const double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
    for (int a = 0; a < 3; a++)
        unit[a] = n[a] / length;
    return true;
}
