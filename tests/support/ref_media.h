/* ref_media.h - emission and absorption along one ray, and its projections, in long double: what is
 * true of media.
 *
 *     colour        = integral of sum c(f) e(f) T dt,  then the background times what is left
 *     transmittance = T = exp(-integral of sum e(f) dt)
 *
 * The sums go over all media at a place; c is a transfer function's colour, e its extinction, each
 * linear between two points by itself, constant beyond the ends. Of points at one value the last
 * holds at it. Opaque and transparent surfaces cut the integral where they are.
 *
 * The ray is cut wherever any medium's value turns, meets a point of its transfer function, begins
 * or ends, and where a unit of optical depth has been passed. Between two cuts the value is a
 * monotone cubic in the distance from the first, which is where it is to the last bit: needles far
 * narrower than the rounding of t are seen. Emission there is integrated adaptively; what lies
 * behind an optical depth of 64 is left out. Nothing is shared with the renderer.
 */
#ifndef TESTS_SUPPORT_REF_MEDIA_H
#define TESTS_SUPPORT_REF_MEDIA_H

#include "render/leafcast.h" /* leafcast_transfer_point, which is the question itself */
#include "tests/support/ref_pieces.h"

/* The pieces of a ray, in order, that do not overlap; t counts world length. */
typedef struct ref_medium {
    const ref_piece *pieces;
    size_t count;
    const leafcast_transfer_point *points; /* at least one */
    int point_count;
} ref_medium;

typedef struct ref_surface {
    long double t;
    float rgb[3]; /* as it is lit */
    float opacity;
} ref_surface;

enum { REF_MEDIA_MAX = 16 };

/* Two ways to integrate what lies between two cuts, which have nothing in common. */
typedef enum ref_rule {
    REF_GAUSS_KRONROD, /* 7 and 15 points, halved until they agree; depths by antiderivative */
    REF_TANH_SINH      /* double exponential, steps halved until they agree; depths by Simpson */
} ref_rule;

typedef struct ref_media {
    const ref_medium *of;
    int count; /* at most REF_MEDIA_MAX */
    const ref_surface *surfaces;
    int surface_count;   /* by rising t */
    float background[4]; /* RGBA, not premultiplied */
    ref_rule rule;
} ref_media;

typedef struct ref_colour {
    long double rgb[3];        /* premultiplied, the background included */
    long double alpha;         /* the same */
    long double transmittance; /* of media and surfaces alone */
    long double error;         /* of rgb: the sum of all differences between two rules */
    size_t cuts;
} ref_colour;

/* ref_media_colour() - of the ray. */
ref_colour ref_media_colour(const ref_media *m);

/* ref_transfer() - colour and extinction at a value, NaN: nothing. */
void ref_transfer(const leafcast_transfer_point *points, int count, long double value,
                  long double rgb[3], long double *extinction);

/* ---- Projections ---- */

/* Of all pieces of a ray. Where there are none, all is NaN. */
typedef struct ref_extent {
    long double least, most, least_t, most_t; /* of equal ones the first */
    long double length, mean;                 /* of what has data */
} ref_extent;
ref_extent ref_project(const ref_piece *pieces, size_t count);

/* ref_first_at_least() - the first t with f >= value; NaN: there is none. *f: the value there. */
long double ref_first_at_least(const ref_piece *pieces, size_t count, long double value,
                               long double *f);

#endif
