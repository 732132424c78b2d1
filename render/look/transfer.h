/* transfer.h - a transfer function as rays want it: cut into spans of the value, in each of which
 * colour and extinction are linear.
 */
#ifndef RENDER_LOOK_TRANSFER_H
#define RENDER_LOOK_TRANSFER_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"
#include "stream/interest.h"

/* The values v with from <= v < to. There the extinction is k[0] + w (k[1] - k[0]), likewise the
 * colour, with w = (v - base) inverse in [0, 1]. The first span begins at -INFINITY, the last one
 * ends at INFINITY: they are constant, and w is 0. All members are double: vectors load them by
 * fours, or look them up in columns. */
typedef struct transfer_span {
    double from, to;
    /* A value that is off by e leads to a function that is off by e times the rates, as long as it
     * and what it is taken for lie between reach[0] and reach[1]: in this span, and in those next
     * to it unless there is a step between. */
    double reach[2];

    double base, inverse; /* of the width */
    double k[2];

    double rgb[2][3];
    double most_rgb;   /* the largest component of its colours, */
    double rgb_change; /* and how much one changes at most */

    double most_k; /* the larger of k[0], k[1] */
    double k_rate, rgb_rate;
    /* How far off the value may be where a ray is cut at `to`: a small part of the narrower of the
     * two spans, or nothing where there is a step. */
    double give;
} transfer_span;

/* Spans of which columns are kept: of each member, those of all spans. */
enum { TRANSFER_FEW = 16, TRANSFER_COLUMNS = sizeof(transfer_span) / sizeof(double) };

typedef struct transfer {
    transfer_span *span;
    int spans;       /* at least 1; 0: nothing is filled */
    double *from;    /* of each span, once more */
    double *column;  /* TRANSFER_COLUMNS, each TRANSFER_FEW long; NULL: there are more spans */
    double most_k;   /* the largest extinction, */
    double most_rgb; /* and the largest component of a colour */
} transfer;

/* transfer_init() - of a medium that has been checked (arguments.h). transfer_release() - also
 * where that failed, and of a zeroed one. */
CHECKED status transfer_init(transfer *t, mem *m, const leafcast_medium *medium);
void transfer_release(transfer *t, mem *m);

/* transfer_is_empty() - nothing is where the value is in the span. */
static inline bool transfer_is_empty(const transfer_span *s) {
    return s->k[0] == 0.0 && s->k[1] == 0.0;
}

/* transfer_find() - the number of the span that holds a value. */
int transfer_find(const transfer *t, double value);

/* transfer_rgb() - the colour of a value. */
void transfer_rgb(const transfer *t, double value, double rgb[3]);

/* transfer_reaches() - where the value is within e of the end of a span, but not the last one's,
 * rates tell what may change. */
static inline bool transfer_reaches(const transfer *t, int span, double e) {
    const transfer_span *s = &t->span[span];
    return s[0].reach[1] > s->to + e && s[1].reach[0] < s->to - e;
}

/* Extinction and colour of all values in a range; colours that nothing has do not count. */
typedef struct transfer_extent {
    double k[2], rgb[3][2]; /* the least and the largest */
} transfer_extent;

/* transfer_extent_of() - of [lo, hi]. */
transfer_extent transfer_extent_of(const transfer *t, double lo, double hi);

/* What is different at most where two values are, both in a range and up to e apart. */
typedef struct transfer_change {
    double k, rgb;   /* by so much; */
    double most_rgb; /* and the largest component of the range's colours, used or not */
} transfer_change;

/* transfer_change_of() - in [lo, hi]. */
transfer_change transfer_change_of(const transfer *t, double lo, double hi, double e);

/* transfer_interest() - into intervals[]: the values that matter, those of some extinction; where
 * there would be more intervals than `max`, the narrowest gaps between them are taken in. Returns
 * how many there are. */
int transfer_interest(const transfer *t, interest_interval intervals[], int max);

#endif
