/* hostile_transfer.h - random transfer functions, each kind a trap for an integrator. */
#ifndef TESTS_SUPPORT_HOSTILE_TRANSFER_H
#define TESTS_SUPPORT_HOSTILE_TRANSFER_H

#include "render/leafcast.h"
#include "tests/support/fields.h"

/* A field as far as transfer functions care. */
typedef struct transfer_range {
    double least, most; /* its finite values */
    double length;      /* of a way through it, about */
    double some[4];     /* values of samples */
} transfer_range;

/* transfer_range_of() - of samples, some of them finite. */
transfer_range transfer_range_of(const float *samples, size_t count, double length,
                                 field_random *r);

/* hostile_transfer_kinds(), hostile_transfer_name() - smooth, opaque, thin, steps, needles, huge,
 * denormal, constant, positive, ... */
int hostile_transfer_kinds(void);
const char *hostile_transfer_name(int kind);

/* hostile_transfer() - one of a kind; returns the number of points, at most HOSTILE_POINTS_MAX. */
enum { HOSTILE_POINTS_MAX = 256 };
int hostile_transfer(int kind, const transfer_range *of, field_random *r,
                     leafcast_transfer_point points[HOSTILE_POINTS_MAX]);

#endif
