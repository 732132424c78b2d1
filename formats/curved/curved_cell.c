#include "formats/curved/curved_cell.h"

#include <float.h>
#include <math.h>

#include "formats/base/simd_one.h"
#include "formats/base/vec3.h"
#include "formats/curved/curved_normal_template.h"
#include "formats/curved/hex_point.h"
#include "formats/curved/quadratic_path.h"

int curved_cell_sense(const curved_cell *c) {
    return c->quadratic ? quadratic_sense(&c->tet) : hexahedron_sense(c->hexahedron.p);
}

static void limits_of(const double *v, int count, double range[2]) {
    range[0] = range[1] = v[0];
    for (int n = 1; n < count; n++) {
        range[0] = real_min(range[0], v[n]);
        range[1] = real_max(range[1], v[n]);
    }
}

void curved_cell_range(const curved_cell *c, double range[2]) {
    if (c->quadratic)
        quadratic_range(c->tet.value, range);
    else
        limits_of(c->hexahedron.value, HEX_CORNERS, range);
}

void curved_cell_box(const curved_cell *c, double box[2][3]) {
    for (int a = 0; a < 3; a++) {
        double v[CELL_ROW], range[2];
        for (int n = 0; n < curved_cell_nodes(c); n++)
            v[n] = curved_cell_place(c, n)[a];
        if (c->quadratic)
            quadratic_range(v, range);
        else
            limits_of(v, HEX_CORNERS, range);
        box[0][a] = range[0];
        box[1][a] = range[1];
    }
}

bool curved_cell_find(const curved_cell *c, const double point[3], double at[3], double *value) {
    return c->quadratic ? quadratic_point_find(&c->tet, c->sense, point, at, value)
                        : hex_point_find(&c->hexahedron, c->sense, point, at, value);
}

void curved_cell_gradient(const curved_cell *c, const double at[3], double gradient[3],
                          float normal[3]) {
    double unit[3];
    if (c->quadratic)
        (void)quadratic_point_gradient(&c->tet, at, gradient);
    else
        (void)hex_point_gradient(&c->hexahedron, at, gradient);
    curved_normal(gradient, unit);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)unit[a];
}

int curved_cell_nearest(const curved_cell *c, const double at[3]) {
    int corner = 0;
    for (int a = 0; a < 3 && !c->quadratic; a++)
        corner |= (at[a] >= 0.5) << a;
    if (!c->quadratic)
        return corner;
    const double share[QUADRATIC_CORNERS] = {1.0 - at[0] - at[1] - at[2], at[0], at[1], at[2]};
    for (int n = 1; n < QUADRATIC_CORNERS; n++)
        if (share[n] > share[corner])
            corner = n;
    return corner;
}

void curved_quadratic_limits(const float v[QUADRATIC_NODES], float *least, float *greatest) {
    double value[QUADRATIC_NODES], range[2];
    for (int n = 0; n < QUADRATIC_NODES; n++)
        value[n] = (double)v[n];
    quadratic_range(value, range);
    /* No further than floats go: what is between the nodes hardly can. */
    *least = (float)real_max(-(double)FLT_MAX, range[0]);
    *greatest = (float)real_min((double)FLT_MAX, range[1]);
    if ((double)*least > range[0])
        *least = nextafterf(*least, -FLT_MAX);
    if ((double)*greatest < range[1])
        *greatest = nextafterf(*greatest, FLT_MAX);
}
