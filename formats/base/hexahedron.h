/* hexahedron.h - a cell whose position and value are trilinear in three parameters, each in [0, 1].
 *
 * Corner c is where the parameters are the bits of c, the first one lowest. Its faces are bilinear
 * patches. Edges or faces may be collapsed to points or edges, as at poles and axes of grids.
 */
#ifndef FORMATS_BASE_HEXAHEDRON_H
#define FORMATS_BASE_HEXAHEDRON_H

enum { HEX_CORNERS = 8, HEX_FACES = 6 };

typedef struct hexahedron {
    double p[HEX_CORNERS][3]; /* floats, as doubles */
    double value[HEX_CORNERS];
} hexahedron;

/* What two bits of a file say of a cell. */
typedef enum hex_code {
    HEX_FOLDED = 0, /* the map's Jacobian is not proven to keep its sign in it */
    HEX_RIGHT = 1,  /* right-handed: it is positive */
    HEX_LEFT = 2,
    HEX_NONE = 3 /* there is no cell */
} hex_code;

/* hex_code_of() - of a hexahedron_sense(). hex_code_sense() - the other way round. */
static inline hex_code hex_code_of(int sense) {
    return sense > 0 ? HEX_RIGHT : sense < 0 ? HEX_LEFT : HEX_FOLDED;
}
static inline int hex_code_sense(hex_code code) {
    return code == HEX_RIGHT ? 1 : code == HEX_LEFT ? -1 : 0;
}

/* hexahedron_at() - the trilinear form of eight corners' values. hexahedron_slope() - its
 * derivatives by the parameters. hexahedron_twist() - its second ones: twist[a] by the two
 * parameters other than a; returns the third one, by all three. */
double hexahedron_at(const double v[HEX_CORNERS], const double at[3]);
void hexahedron_slope(const double v[HEX_CORNERS], const double at[3], double slope[3]);
double hexahedron_twist(const double v[HEX_CORNERS], const double at[3], double twist[3]);

/* hexahedron_gradient() - the value's gradient in space in the middle of the cell; 0 where it has
 * none. */
void hexahedron_gradient(const hexahedron *h, double gradient[3]);

/* hexahedron_sense() - 1 if positions are a right-handed map: the Jacobian's determinant is above 0
 * inside the cell, by its Bernstein coefficients in the cell or in parts of it; on faces and edges
 * it may be 0. -1: left-handed. 0: it is neither; the cell is folded, or flat. All of it to within
 * rounding: 2^-48 of the product of the longest edges along each parameter counts as 0. So an edge
 * is collapsed where its ends are the same, not where they only nearly are.
 *
 * Depends on the positions alone. A right- or left-handed cell meets a ray in parts on each of
 * which t rises, and which begin and end at its faces. */
int hexahedron_sense(const double p[HEX_CORNERS][3]);

/* hexahedron_face() - the corners of face 0 to 5 in the order of formats/curved/patch.h: of
 * parameter face / 2, at 0 if even, at 1 if odd; the other two parameters rise in their order.
 * Returns the sense of (d/d first) x (d/d second) in a right-handed cell: 1 outward, -1 inward. */
int hexahedron_face(int face, int corner[4]);

/* hexahedron_face_point() - a face's own parameters as the cell's. */
void hexahedron_face_point(int face, const double own[2], double at[3]);

#endif
