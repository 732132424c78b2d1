/* transfer_curve.h - approximate a curve by points with lines between them, to half a step of 8
 * bits.
 */
#ifndef RENDER_APP_TRANSFER_CURVE_H
#define RENDER_APP_TRANSFER_CURVE_H

#include "render/app/transfer_list.h"

/* The largest distance of lines from the curve: in linear light, in sRGB, and in the share that an
 * extinction absorbs over a length of 1. */
#define TRANSFER_CURVE_ERROR (1.0 / 510)

typedef struct transfer_curve {
    double from, to; /* values, from <= to */
    /* Compute colour and extinction at the share s, 0 .. 1, of the way; p->value is set. */
    void (*at)(const void *ctx, double s, leafcast_transfer_point *p);
    const void *ctx;
} transfer_curve;

/* transfer_curve_add() - append the curve's points to the list. The point at s = 0 is left out if
 * the list ends in the same one. from == to gives a step. A kink takes up to 12 halvings: the rest
 * then lies within 2^-12 of the way. Errors as from transfer_list_add(). */
CHECKED status transfer_curve_add(transfer_list *out, const transfer_curve *c);

#endif
