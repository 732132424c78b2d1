#include "formats/curved/cell_form.h"

#include "formats/base/hexahedron.h"
#include "formats/base/quadratic_tet.h"

static double trilinear_twist(const double *v, const double at[3], double twist[3],
                              double square[3]) {
    square[0] = square[1] = square[2] = 0.0;
    return hexahedron_twist(v, at, twist);
}

const cell_form form_trilinear = {
    .count = HEX_CORNERS, .at = hexahedron_at, .slope = hexahedron_slope, .twist = trilinear_twist};

static double twist_of_quadratic(const double *v, const double at[3], double twist[3],
                                 double square[3]) {
    (void)at;
    quadratic_twist(v, twist, square);
    return 0.0;
}

const cell_form form_quadratic = {.count = QUADRATIC_NODES,
                                  .squares = true,
                                  .at = quadratic_at,
                                  .slope = quadratic_slope,
                                  .twist = twist_of_quadratic};
