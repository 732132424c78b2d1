#include "tests/support/in_sphere.h"

#include <assert.h>
#include <stdint.h>

/* to - from, which is exact: both are whole. */
static void offset(const float *from, const float *to, int64_t out[3]) {
    for (int a = 0; a < 3; a++) {
        assert(to[a] == (float)(int64_t)to[a] && to[a] <= IN_SPHERE_MAX && to[a] >= -IN_SPHERE_MAX);
        out[a] = (int64_t)to[a] - (int64_t)from[a];
    }
}

static __int128 determinant(const int64_t a[3], const int64_t b[3], const int64_t c[3]) {
    return (__int128)a[0] * ((__int128)b[1] * c[2] - (__int128)b[2] * c[1]) -
           (__int128)a[1] * ((__int128)b[0] * c[2] - (__int128)b[2] * c[0]) +
           (__int128)a[2] * ((__int128)b[0] * c[1] - (__int128)b[1] * c[0]);
}

__int128 in_sphere_volume(const float *a, const float *b, const float *c, const float *d) {
    int64_t ab[3], ac[3], ad[3];
    offset(a, b, ab);
    offset(a, c, ac);
    offset(a, d, ad);
    return determinant(ab, ac, ad);
}

static __int128 square(const int64_t a[3]) {
    return (__int128)a[0] * a[0] + (__int128)a[1] * a[1] + (__int128)a[2] * a[2];
}

/* The determinant of rows (x y z, x^2 + y^2 + z^2) of a .. d, seen from e: offsets are below 2^22,
 * squares below 2^46, minors below 2^69, so that no sum reaches 2^118. */
int in_sphere(const float *a, const float *b, const float *c, const float *d, const float *e) {
    int64_t ea[3], eb[3], ec[3], ed[3];
    offset(e, a, ea);
    offset(e, b, eb);
    offset(e, c, ec);
    offset(e, d, ed);
    const __int128 sum =
        -square(ea) * determinant(eb, ec, ed) + square(eb) * determinant(ea, ec, ed) -
        square(ec) * determinant(ea, eb, ed) + square(ed) * determinant(ea, eb, ec);
    const __int128 volume = in_sphere_volume(a, b, c, d);
    assert(volume != 0);
    const int sign = sum > 0 ? 1 : sum < 0 ? -1 : 0;
    return volume > 0 ? -sign : sign;
}
