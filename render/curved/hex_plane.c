#include "render/curved/hex_plane.h"

#include "formats/base/vec3.h"

#define WIDEN 0x1p-40 /* relative to the terms */

/* Where the ray is in the box of the corners. t * d errs by the rounding of all that is in it. */
static void cut_box(const hexahedron *h, const ray *r, double t[2]) {
    t[0] = -INFINITY;
    t[1] = INFINITY;
    for (int a = 0; a < 3; a++) {
        double lo = h->p[0][a], hi = lo;
        for (int c = 1; c < HEX_CORNERS; c++) {
            lo = real_min(lo, h->p[c][a]);
            hi = real_max(hi, h->p[c][a]);
        }
        const double room = WIDEN * (fabs(lo) + fabs(hi) + fabs(r->o[a]));
        lo -= r->o[a] + room;
        hi -= r->o[a] - room;
        if (r->d[a] == 0.0) {
            if (lo > 0.0 || hi < 0.0)
                t[1] = -INFINITY;
            continue;
        }
        const double ends[2] = {lo / r->d[a], hi / r->d[a]};
        t[0] = real_max(t[0], ends[r->d[a] < 0.0]);
        t[1] = real_min(t[1], ends[r->d[a] > 0.0]);
    }
}

/* The gradient in the middle of the cell; 0: there is none. Four parallel edges are added up, each
 * time: the factors cancel. */
static void gradient_of(const hexahedron *h, double out[3]) {
    double along[3][3], rise[3], across[3][3];
    for (int a = 0; a < 3; a++) {
        rise[a] = 0.0;
        for (int i = 0; i < 3; i++)
            along[a][i] = 0.0;
        for (int n = 0; n < 4; n++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            const int low = (n & 1) << b | (n >> 1) << c, high = low | 1 << a;
            rise[a] += h->value[high] - h->value[low];
            for (int i = 0; i < 3; i++)
                along[a][i] += h->p[high][i] - h->p[low][i];
        }
    }
    for (int a = 0; a < 3; a++)
        vec3_cross(along[(a + 1) % 3], along[(a + 2) % 3], across[a]);
    const double det = vec3_dot(along[0], across[0]);
    for (int i = 0; i < 3; i++) {
        const double g =
            (rise[0] * across[0][i] + rise[1] * across[1][i] + rise[2] * across[2][i]) / det;
        out[i] = isfinite(g) ? g : 0.0;
    }
}

hex_plane hex_plane_of(const hexahedron *h, const ray *r) {
    hex_plane out;
    double g[3], rest[2] = {INFINITY, -INFINITY}, size = 0.0, most = 0.0, at[3], away[3];
    cut_box(h, r, out.t);
    gradient_of(h, g);
    for (int c = 0; c < HEX_CORNERS; c++) {
        vec3_sub(h->p[c], h->p[0], away);
        const double left = h->value[c] - vec3_dot(g, away);
        rest[0] = real_min(rest[0], left);
        rest[1] = real_max(rest[1], left);
        most = real_max(most, fabs(h->value[c]));
    }
    const double reach = real_max(fabs(out.t[0]), fabs(out.t[1]));
    vec3_sub(r->o, h->p[0], at);
    for (int a = 0; a < 3; a++)
        size += fabs(g[a]) * (fabs(r->o[a]) + fabs(h->p[0][a]) + reach * fabs(r->d[a]));
    const double start = vec3_dot(g, at), rate = vec3_dot(g, r->d);
    const double end[2] = {start + rate * out.t[0], start + rate * out.t[1]};
    const double room = WIDEN * (size + most + fabs(rest[0]) + fabs(rest[1]));
    out.value[0] = real_min(end[0], end[1]) + rest[0] - room;
    out.value[1] = real_max(end[0], end[1]) + rest[1] + room;
    return out;
}
