/* transfer.h - a transfer function as rays want it: cut into spans of the value, in each of which
 * colour and extinction are linear.
 */
#ifndef RENDER_TRANSFER_H
#define RENDER_TRANSFER_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"
#include "stream/interest.h"

/* The values v with from <= v < to. There the extinction is k[0] + w (k[1] - k[0]), likewise the
 * colour, with w = (v - base) inverse in [0, 1]. The first span begins at -INFINITY, the last one
 * ends at INFINITY: they are constant, and w is 0. All members are double: vectors look them up by
 * column. */
typedef struct transfer_span {
    double from, to;
    double base, inverse; /* of the width */
    double k[2];
    double rgb[2][3];
    double most_k;     /* the larger of k[0], k[1] */
    double most_rgb;   /* the largest component of its colours, */
    double rgb_change; /* and how much one changes at most */
    /* A value that is off by e leads to a function that is off by e times these, as long as it and
     * what it is taken for lie between reach[0] and reach[1]: in this span, and in those next to it
     * unless there is a step between. */
    double k_rate, rgb_rate;
    double reach[2];
} transfer_span;

/* Spans that are narrower are steps. */
#define TRANSFER_NARROWEST 1e-290

typedef struct transfer {
    transfer_span *span;
    int spans;       /* at least 1; 0: nothing is filled */
    double *columns; /* the same, member by member */
    double most_k;   /* the largest extinction, */
    double most_rgb; /* and the largest component of a colour */
} transfer;

/* transfer_init() - of a medium that has been checked (arguments.h). transfer_release() - also
 * where that failed, and of a zeroed one. */
CHECKED status transfer_init(transfer *t, mem *m, const leafcast_medium *medium);
void transfer_release(transfer *t, mem *m);

/* transfer_column() - a member of all spans; offset: its own in the struct. */
static inline const double *transfer_column(const transfer *t, size_t offset) {
    return t->columns + offset / sizeof(double) * (size_t)t->spans;
}

/* transfer_is_empty() - nothing is where the value is in the span. */
static inline bool transfer_is_empty(const transfer_span *s) {
    return s->k[0] == 0.0 && s->k[1] == 0.0;
}

/* transfer_find() - the number of the span that holds a value. */
int transfer_find(const transfer *t, double value);

/* transfer_interest() - into intervals[]: the values that matter, those of some extinction; where
 * there would be more intervals than `max`, the narrowest gaps between them are taken in. Returns
 * how many there are. */
int transfer_interest(const transfer *t, interest_interval intervals[], int max);

#endif
