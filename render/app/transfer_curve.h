/* transfer_curve.h - a curve as points between which lines do, to half a step of 8 bits.
 */
#ifndef RENDER_APP_TRANSFER_CURVE_H
#define RENDER_APP_TRANSFER_CURVE_H

#include "render/app/transfer_list.h"

/* How far lines may be from a curve: in linear light, as a screen shows it (sRGB), and of what an
 * extinction swallows over a length of 1. */
#define TRANSFER_CURVE_ERROR (1.0 / 510)

typedef struct transfer_curve {
    double from, to; /* values, from <= to */
    /* Colour and extinction at the share s, 0 .. 1, of the way between them; p->value is set. */
    void (*at)(const void *ctx, double s, leafcast_transfer_point *p);
    const void *ctx;
} transfer_curve;

/* transfer_curve_add() - its points behind those of the list: from s = 0 on, unless the list ends
 * in the same one; a step where from == to. A kink takes up to 12 halvings: what is left then lies
 * within 2^-12 of the way. Errors as of transfer_list_add(). */
CHECKED status transfer_curve_add(transfer_list *out, const transfer_curve *c);

#endif
