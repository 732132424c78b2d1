/* curved_cell.h - a cell with bent faces, of whatever shape: what is asked of it without a ray. */
#ifndef FORMATS_CURVED_CURVED_CELL_H
#define FORMATS_CURVED_CURVED_CELL_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/cell_row.h"
#include "formats/base/hexahedron.h"
#include "formats/base/quadratic_tet.h"

typedef struct curved_cell {
    bool quadratic; /* which of the two it is */
    union {
        hexahedron hexahedron;
        quadratic_tet tet;
    };
    int sense;       /* hexahedron_sense(), quadratic_sense() */
    uint64_t number; /* in the whole file */
} curved_cell;

/* curved_cell_nodes() - the number of its nodes. curved_cell_place(), _value() - what node n has.
 */
static inline int curved_cell_nodes(const curved_cell *c) {
    return c->quadratic ? QUADRATIC_NODES : HEX_CORNERS;
}
static inline const double *curved_cell_place(const curved_cell *c, int n) {
    return c->quadratic ? c->tet.p[n] : c->hexahedron.p[n];
}
static inline double curved_cell_value(const curved_cell *c, int n) {
    return c->quadratic ? c->tet.value[n] : c->hexahedron.value[n];
}
/* The values themselves. */
static inline double *curved_cell_values(curved_cell *c) {
    return c->quadratic ? c->tet.value : c->hexahedron.value;
}

/* curved_cell_put() - set a node of a cell whose .quadratic is set. */
static inline void curved_cell_put(curved_cell *c, int n, const double p[3], double value) {
    for (int a = 0; a < 3; a++)
        (c->quadratic ? c->tet.p[n] : c->hexahedron.p[n])[a] = p[a];
    curved_cell_values(c)[n] = value;
}

/* curved_cell_sense() - its sense, of its places. curved_cell_range() - what its values lie
 * between; of a quadratic tet they may be beyond those of the nodes. curved_cell_box() - what all
 * of it lies in. */
int curved_cell_sense(const curved_cell *c);
void curved_cell_range(const curved_cell *c, double range[2]);
void curved_cell_box(const curved_cell *c, double box[2][3]);

/* curved_cell_find() - hex_point_find(), quadratic_point_find(). curved_cell_gradient() - the
 * gradient of the value in the world at parameters, and the isosurface's unit normal, down the
 * gradient; 0 where there is none. */
bool curved_cell_find(const curved_cell *c, const double point[3], double at[3], double *value);
void curved_cell_gradient(const curved_cell *c, const double at[3], double gradient[3],
                          float normal[3]);

/* curved_cell_nearest() - the node whose parameters are closest: a corner of a hexahedron's or of a
 * tet. */
int curved_cell_nearest(const curved_cell *c, const double at[3]);

/* The same of floats, for masks, ranges and boxes of many: what a quadratic form by its nodes'
 * values lies between. Rounded outward. */
void curved_quadratic_limits(const float v[QUADRATIC_NODES], float *least, float *greatest);

#endif
