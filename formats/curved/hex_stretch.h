/* hex_stretch.h - a stretch of a ray in a hexahedron: where its parameters are, and how fast a
 * trilinear value changes along it, by bounds that are proven.
 *
 * In the ray's space the stretch is where the trilinear map is (0, 0, t). Krawczyk's operator with
 * the inverse Jacobian at the middle shows that each t of the stretch has one such point in a box
 * about the middle, and only one. The box bounds the Jacobian, hence the speed of the parameters,
 * hence the slope of the value. Bounds are computed in doubles and widened by 2^-40 of their terms,
 * some thousand times what those round.
 */
#ifndef FORMATS_CURVED_HEX_STRETCH_H
#define FORMATS_CURVED_HEX_STRETCH_H

#include <stdbool.h>

#include "formats/curved/hex_path.h"

/* A trilinear map, coordinate by coordinate. */
typedef const double (*hex_map)[HEX_CORNERS];

typedef struct hex_stretch {
    double half;                     /* of its length in t */
    double at[3];                    /* parameters at its middle */
    double reach[3];                 /* all its parameters differ from these by so much at most */
    double rate[3];                  /* change of the parameters by t in the middle, */
    double spread[3];                /* and by how much more or less it is elsewhere */
    double straight[3][HEX_CORNERS]; /* the map times the inverse Jacobian in the middle */
    double apart[3]; /* row sums of what its Jacobian differs from 1 by; less than 7/8 */
} hex_stretch;

/* hex_stretch_locate() - the point of the map that is at t of the ray, by Newton's method from at.
 * False: not found. */
bool hex_stretch_locate(hex_map q, double t, double at[3]);

/* hex_stretch_of() - the stretch between two points of the ray. False: there is no proof for all of
 * it. at[] is still the middle if *located. */
bool hex_stretch_of(hex_map q, const hex_end *from, const hex_end *to, hex_stretch *out,
                    bool *located);

/* hex_stretch_middle() - the point of the ray in a stretch's middle, with a trilinear value there.
 * False: the stretch is too short to have one between its ends. */
bool hex_stretch_middle(const hex_stretch *s, const double v[HEX_CORNERS], const hex_end *from,
                        const hex_end *to, hex_end *middle);

/* hex_stretch_slope() - returns the slope by t of a trilinear value in the stretch's middle; it
 * differs from this by *error at most in the whole stretch. */
double hex_stretch_slope(const hex_stretch *s, const double v[HEX_CORNERS], double *error);

/* hex_stretch_steepest() - the greatest modulus, within the stretch's reach, of a trilinear value's
 * slope by each parameter. */
void hex_stretch_steepest(const hex_stretch *s, const double v[HEX_CORNERS], double steepest[3]);

/* hex_stretch_solve() - Newton's method for a point where the map's first two coordinates and v are
 * 0, from at. False: none found, or not within the stretch's reach. */
bool hex_stretch_solve(hex_map q, const double v[HEX_CORNERS], const hex_stretch *s, double at[3]);

#endif
