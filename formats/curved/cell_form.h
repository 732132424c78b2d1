/* cell_form.h - what position and value are in a curved cell: polynomials of three parameters, by
 * coefficients whose least and greatest bound them.
 *
 * What a ray has to know of a cell, it knows of all shapes by these few questions; each shape of
 * polynomial is a row.
 */
#ifndef FORMATS_CURVED_CELL_FORM_H
#define FORMATS_CURVED_CELL_FORM_H

#include <stdbool.h>

enum { FORM_MOST = 10 };

typedef struct cell_form {
    int count;    /* of coefficients */
    bool squares; /* a parameter may come twice in a product */
    double (*at)(const double *v, const double at[3]);
    void (*slope)(const double *v, const double at[3], double slope[3]);
    /* Second derivatives at a point: twist[a] by the two parameters other than a, square[a] half
     * the one by a twice, the same everywhere. Returns the third one, by all three, which is too.
     */
    double (*twist)(const double *v, const double at[3], double twist[3], double square[3]);
} cell_form;

extern const cell_form form_trilinear; /* hexahedra: hexahedron.h */
extern const cell_form form_quadratic; /* tets of ten nodes: quadratic_tet.h */

/* A cell in the space of one ray (sheared_ray.h). */
typedef struct curved_map {
    const cell_form *form;
    double q[3][FORM_MOST]; /* position, by coordinate */
    double value[FORM_MOST];
} curved_map;

#endif
