#include "formats/base/hexahedron.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "formats/base/vec3.h"

#include "formats/base/simd_one.h" /* before templates */

#include "formats/base/form_template.h"

double hexahedron_at(const double v[HEX_CORNERS], const double at[3]) {
    double edge[4], face[2];
    for (int i = 0; i < 4; i++)
        edge[i] = v[2 * i] + at[0] * (v[2 * i + 1] - v[2 * i]);
    for (int i = 0; i < 2; i++)
        face[i] = edge[2 * i] + at[1] * (edge[2 * i + 1] - edge[2 * i]);
    return face[0] + at[2] * (face[1] - face[0]);
}

void hexahedron_slope(const double v[HEX_CORNERS], const double at[3], double slope[3]) {
    form_rise_of_corners(v, at, slope);
}

double hexahedron_twist(const double v[HEX_CORNERS], const double at[3], double twist[3]) {
    double all = 0.0;
    for (int a = 0; a < 3; a++) {
        const int b = 1 << (a + 1) % 3, c = 1 << (a + 2) % 3, n = 1 << a;
        const double low = (v[b | c] - v[b]) - (v[c] - v[0]);
        const double high = (v[n | b | c] - v[n | b]) - (v[n | c] - v[n]);
        twist[a] = low + at[a] * (high - low);
        all = high - low;
    }
    return all;
}

/* Four parallel edges are added up, each time: the factors cancel. */
void hexahedron_gradient(const hexahedron *h, double gradient[3]) {
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
        gradient[i] = isfinite(g) ? g : 0.0;
    }
}

int hexahedron_face(int face, int corner[4]) {
    const int a = face / 2, b = a == 0, c = a == 2 ? 1 : 2;
    const int base = (face & 1) << a;
    for (int i = 0; i < 4; i++)
        corner[i] = base | (i & 1) << b | (i >> 1) << c;
    return ((face & 1) != 0) == (a != 1) ? 1 : -1;
}

void hexahedron_face_point(int face, const double own[2], double at[3]) {
    const int a = face / 2, b = a == 0, c = a == 2 ? 1 : 2;
    at[a] = (double)(face & 1);
    at[b] = own[0];
    at[c] = own[1];
}

/* The Jacobian's determinant has degree 2 in each parameter. A Bernstein coefficient is the mean of
 * the determinants of three edges each, one along each axis, that lie right for it. */
typedef struct determinant {
    double least, greatest; /* of the coefficients, each less or more by its rounding */
    double rounding;
} determinant;

static determinant determinant_of(const double p[HEX_CORNERS][3]) {
    double edge[3][4][3], sum[27] = {0.0}, most[3] = {0.0, 0.0, 0.0};
    int count[27] = {0};
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 4; i++) {
            const int corner = (i & 1) << (a + 1) % 3 | (i >> 1) << (a + 2) % 3;
            vec3_sub(p[corner | 1 << a], p[corner], edge[a][i]);
            most[a] = fmax(most[a], vec3_size(edge[a][i]));
        }
    /* edge[a][i]: at (i & 1) of parameter a + 1, and i >> 1 of parameter a + 2. */
    for (int x = 0; x < 4; x++)
        for (int y = 0; y < 4; y++)
            for (int z = 0; z < 4; z++) {
                const int i = (y >> 1) + (z & 1), j = (x & 1) + (z >> 1), k = (x >> 1) + (y & 1);
                const int at = i + 3 * (j + 3 * k);
                sum[at] += vec3_det(edge[0][x], edge[1][y], edge[2][z]);
                count[at]++;
            }
    determinant d = {INFINITY, -INFINITY, 0x1p-48 * most[0] * most[1] * most[2]};
    for (int i = 0; i < 27; i++) {
        const double mean = sum[i] / count[i];
        d.least = fmin(d.least, mean);
        d.greatest = fmax(d.greatest, mean);
    }
    return d;
}

/* A half of the cell along an axis. */
static void halve(const double p[HEX_CORNERS][3], int axis, int side, double half[HEX_CORNERS][3]) {
    memcpy(half, p, sizeof(double[HEX_CORNERS][3]));
    for (int c = 0; c < HEX_CORNERS; c++)
        if ((c >> axis & 1) != side)
            for (int a = 0; a < 3; a++)
                half[c][a] = 0.5 * (p[c][a] + p[c ^ 1 << axis][a]);
}

/* 1, -1, 0 as hexahedron_sense(). left: how many more parts may be looked at. */
static int sense_of(const double p[HEX_CORNERS][3], int depth, int *left) {
    const determinant d = determinant_of(p);
    if (d.least >= -d.rounding && d.greatest > d.rounding)
        return 1;
    if (d.greatest <= d.rounding && d.least < -d.rounding)
        return -1;
    if (depth == 0 || *left <= 0 || !(d.greatest > d.rounding && d.least < -d.rounding))
        return 0;
    *left -= 2;
    double half[HEX_CORNERS][3];
    halve(p, depth % 3, 0, half);
    const int sense = sense_of(half, depth - 1, left);
    if (sense == 0)
        return 0;
    halve(p, depth % 3, 1, half);
    return sense_of(half, depth - 1, left) == sense ? sense : 0;
}

/* A cell that bends little. Then the determinants that are the Bernstein coefficients' have one
 * sign: the same answer, in less time. 0: not known. */
static int sense_if_straight(const double p[HEX_CORNERS][3]) {
    double form[3][FORM_TERMS], rounding[3];
    form_bend b;
    for (int a = 0; a < 3; a++) {
        double away[HEX_CORNERS];
        for (int c = 0; c < HEX_CORNERS; c++)
            away[c] = p[c][a] - p[0][a];
        form_of_corners(away, form[a]);
        rounding[a] = 0x1p-48 * form_size(form[a], TRILINEAR);
    }
    if (!form_bend_of(form, TRILINEAR, rounding, &b) || !form_is_single(&b, TRILINEAR, 1.0))
        return 0;
    return b.det > 0.0 ? 1 : -1;
}

int hexahedron_sense(const double p[HEX_CORNERS][3]) {
    enum { DEPTH = 12, PARTS = 1024 };
    const int straight = sense_if_straight(p);
    if (straight)
        return straight;
    int left = PARTS;
    return sense_of(p, DEPTH, &left);
}
