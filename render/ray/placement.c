#include "render/ray/placement.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "formats/base/box3.h"
#include "render/leafcast.h"

/* ---- Norms ---- */

/* The Frobenius norm of a 3 x 3 matrix with rows of `stride` numbers; of numbers that are divided
 * by `scale` first. */
static double frobenius(const double *m, int stride, double scale) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            sum += m[stride * i + j] / scale * (m[stride * i + j] / scale);
    return sqrt(sum);
}

/* A bound of the spectral norm: the root of the product of the greatest sums of a row and of a
 * column. It is the norm itself where axes go to axes. */
static double spectral_most(const double *m, int stride) {
    double rows = 0.0, columns = 0.0;
    for (int i = 0; i < 3; i++) {
        double row = 0.0, column = 0.0;
        for (int j = 0; j < 3; j++) {
            row += fabs(m[stride * i + j]);
            column += fabs(m[stride * j + i]);
        }
        rows = fmax(rows, row);
        columns = fmax(columns, column);
    }
    return fmin(sqrt(rows) * sqrt(columns), frobenius(m, stride, 1.0)) * (1.0 + 0x1p-40);
}

static double largest(const double *place) {
    double most = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            most = fmax(most, fabs(place[4 * i + j]));
    return most;
}

/* ---- Making ---- */

status placement_check(const double *place) {
    affine unit;
    double scaled[12];
    if (!place)
        return ST_OK;
    const double most = largest(place);
    if (!(most >= 1.0 / LEAFCAST_SCALE_MOST && most <= LEAFCAST_SCALE_MOST))
        return status_describe(ST_USAGE,
                               "leafcast_shown.place: the largest of the nine numbers that scale "
                               "and turn is %g: %g to %g is possible",
                               most, 1.0 / LEAFCAST_SCALE_MOST, LEAFCAST_SCALE_MOST);
    for (int i = 3; i < 12; i += 4)
        if (!(fabs(place[i]) <= LEAFCAST_PLACE_MOST))
            return status_describe(ST_USAGE,
                                   "leafcast_shown.place: it moves by %g: at most %g is possible",
                                   place[i], LEAFCAST_PLACE_MOST);
    for (int i = 0; i < 12; i++)
        scaled[i] = i % 4 == 3 ? 0.0 : place[i] / most;
    affine_init(&unit, scaled);
    const double uneven =
        frobenius(scaled, 4, 1.0) * frobenius((const double *)unit.to_grid, 3, 1.0);
    if (uneven <= LEAFCAST_SCALE_UNEVEN) /* a NaN is not */
        return ST_OK;
    return status_describe(
        ST_USAGE,
        "leafcast_shown.place: it flattens space, or nearly: some lengths shrink "
        "more than %g times as much as others",
        LEAFCAST_SCALE_UNEVEN);
}

placement placement_of(const double *place) {
    placement p = {.moved = place != NULL};
    if (!place)
        return p;
    affine_init(&p.space, place);
    const double(*m)[4] = (const double(*)[4])p.space.to_world;
    const double *inverse = (const double *)p.space.to_grid;
    p.grow = spectral_most(place, 4);
    p.shrink = 1.0 / spectral_most(inverse, 3);
    const double volume = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                          m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                          m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
    p.size = cbrt(fabs(volume));
    return p;
}

void placement_follow(double place[12], const double next[12]) {
    double out[12];
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 4; c++) {
            out[4 * r + c] = c == 3 ? next[4 * r + 3] : 0.0;
            for (int k = 0; k < 3; k++)
                out[4 * r + c] += next[4 * r + k] * place[4 * k + c];
        }
    memcpy(place, out, sizeof out);
}

/* ---- There and back ---- */

const double *placement_point(const placement *p, const double scene[3], double own[3]) {
    if (!p->moved)
        return scene;
    affine_point_to_grid(&p->space, scene, own);
    return own;
}

const double *placement_vector(const placement *p, const double scene[3], double own[3]) {
    if (!p->moved)
        return scene;
    affine_vector_to_grid(&p->space, scene, own);
    return own;
}

void placement_to_scene(const placement *p, const double own[3], double scene[3]) {
    if (p->moved)
        affine_point_to_world(&p->space, own, scene);
    else
        memcpy(scene, own, 3 * sizeof *scene);
}

void placement_widen(const placement *p, const double own[3], double scene[2][3]) {
    double at[3], low[3], high[3];
    placement_to_scene(p, own, at);
    for (int i = 0; i < 3; i++) {
        double far = p->moved ? fabs(p->space.to_world[i][3]) : 0.0;
        for (int a = 0; a < 3 && p->moved; a++)
            far += fabs(p->space.to_world[i][a] * own[a]);
        low[i] = at[i] - 4.0 * DBL_EPSILON * far;
        high[i] = at[i] + 4.0 * DBL_EPSILON * far;
    }
    box3_widen(scene, low, high);
}

void placement_box(const placement *p, const double own[2][3], double scene[2][3]) {
    box3_begin(scene);
    for (int k = 0; k < 8; k++) {
        double corner[3];
        for (int a = 0; a < 3; a++)
            corner[a] = own[k >> a & 1][a];
        placement_widen(p, corner, scene);
    }
}

/* A bound of how far a place of that reach is off, on an axis of the volume's own world, as the
 * scene's world rounds it, and the way from there. */
static double off_by(const placement *p, const double reach[3], int axis) {
    double sum = reach[axis];
    for (int i = 0; i < 3; i++) {
        double scene = fabs(p->space.to_world[i][3]);
        for (int a = 0; a < 3; a++)
            scene += fabs(p->space.to_world[i][a]) * reach[a];
        sum += fabs(p->space.to_grid[axis][i]) * scene;
    }
    return 8.0 * DBL_EPSILON * sum;
}

void placement_take_back(const placement *p, const double reach[3], surface_point *point) {
    const double own[3] = {point->gradient[0], point->gradient[1], point->gradient[2]};
    const double normal[3] = {(double)point->normal[0], (double)point->normal[1],
                              (double)point->normal[2]};
    double to[3], length = 0.0;
    for (int a = 0; a < 3; a++)
        point->error += fabs(own[a]) * off_by(p, reach, a);
    point->span *= p->shrink;
    affine_gradient_to_world(&p->space, own, point->gradient);
    affine_gradient_to_world(&p->space, normal, to);
    for (int a = 0; a < 3; a++)
        length += to[a] * to[a];
    length = sqrt(length);
    for (int a = 0; a < 3 && length > 0.0; a++)
        point->normal[a] = (float)(to[a] / length);
}
