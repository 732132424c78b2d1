/* path_stretch.h - a stretch of a ray in a curved cell: where its parameters are, and how fast the
 * value changes along it, by bounds that are proven.
 *
 * In the ray's space the stretch is where the map is (0, 0, t). Krawczyk's operator with
 * the inverse Jacobian at the middle shows that each t of the stretch has one such point in a box
 * about the middle, and only one. The box bounds the Jacobian, hence the speed of the parameters,
 * hence the slope of the value. Bounds are computed in doubles and widened by 2^-40 of their terms,
 * some thousand times what those round.
 */
#ifndef FORMATS_CURVED_PATH_STRETCH_H
#define FORMATS_CURVED_PATH_STRETCH_H

#include <stdbool.h>

#include "formats/curved/cell_form.h"
#include "formats/curved/path_part.h"

typedef struct path_stretch {
    const cell_form *form;
    double half;                   /* of its length in t */
    double at[3];                  /* parameters at its middle */
    double reach[3];               /* all its parameters differ from these by so much at most */
    double rate[3];                /* change of the parameters by t in the middle, */
    double spread[3];              /* and by how much more or less it is elsewhere */
    double straight[3][FORM_MOST]; /* the map times the inverse Jacobian in the middle */
    double apart[3]; /* row sums of what its Jacobian differs from 1 by; less than 7/8 */
} path_stretch;

/* path_stretch_locate() - the point of the map that is at t of the ray, by Newton's method from at.
 * False: not found. */
bool path_stretch_locate(const curved_map *m, double t, double at[3]);

/* path_stretch_of() - the stretch between two points of the ray. False: there is no proof for all
 * of it. at[] is still the middle if *located. */
bool path_stretch_of(const curved_map *m, const path_end *from, const path_end *to,
                     path_stretch *out, bool *located);

/* path_stretch_middle() - the point of the ray in a stretch's middle, with a value there.
 * False: the stretch is too short to have one between its ends. */
bool path_stretch_middle(const path_stretch *s, const double *v, const path_end *from,
                         const path_end *to, path_end *middle);

/* path_stretch_slope() - returns the slope by t of a value in the stretch's middle; it
 * differs from this by *error at most in the whole stretch. */
double path_stretch_slope(const path_stretch *s, const double *v, double *error);

/* path_stretch_steepest() - the greatest modulus, within the stretch's reach, of a value's
 * slope by each parameter. */
void path_stretch_steepest(const path_stretch *s, const double *v, double steepest[3]);

/* path_stretch_solve() - Newton's method for a point where the map's first two coordinates and v
 * are 0, from at. False: none found, or not within the stretch's reach. */
bool path_stretch_solve(const curved_map *m, const double *v, const path_stretch *s, double at[3]);

#endif
