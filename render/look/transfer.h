/* transfer.h - a transfer function, cut into spans of the value. In each span colour and extinction
 * are linear.
 */
#ifndef RENDER_LOOK_TRANSFER_H
#define RENDER_LOOK_TRANSFER_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"
#include "stream/interest.h"

/* The values v with from <= v < to. There the extinction is k[0] + w (k[1] - k[0]), with w = (v -
 * base) inverse in [0, 1]; the colour likewise. The first span begins at -INFINITY, the last one
 * ends at INFINITY: both are constant, and w is 0. All members are double: vectors load four at
 * once, or look them up in columns. */
typedef struct transfer_span {
    double from, to;
    /* An error e of the value changes colour and extinction by at most e times the rates, as long
     * as the true and the computed value lie between reach[0] and reach[1]: in this span, or in a
     * neighbour without a step between. */
    double reach[2];

    double base, inverse; /* inverse: 1 / the span's width */
    double k[2];

    double rgb[2][3];
    double most_rgb;   /* the largest component of its colours, */
    double rgb_change; /* and the most that one changes in the span */

    double most_k; /* the larger of k[0], k[1] */
    double k_rate, rgb_rate;
    /* Allowed error of the value where a ray is cut at `to`: a small part of the narrower of the
     * two spans, or 0 where there is a step. */
    double give;
} transfer_span;

/* Up to TRANSFER_FEW spans are also kept in columns: one for each member, with its values in all
 * spans. */
enum { TRANSFER_FEW = 16, TRANSFER_COLUMNS = sizeof(transfer_span) / sizeof(double) };

typedef struct transfer {
    transfer_span *span;
    int spans;       /* at least 1; 0: there is no medium */
    double *from;    /* `from` of each span, in a row */
    double *column;  /* TRANSFER_COLUMNS columns of TRANSFER_FEW each; NULL: there are more spans */
    double most_k;   /* the largest extinction, */
    double most_rgb; /* and the largest component of a colour */
} transfer;

/* transfer_init() - make a transfer from a medium that has been checked (arguments.h).
 * transfer_release() - free it; also after a failed init, or if it is zeroed. */
CHECKED status transfer_init(transfer *t, mem *m, const leafcast_medium *medium);
void transfer_release(transfer *t, mem *m);

/* transfer_is_empty() - whether values in the span have no extinction. */
static inline bool transfer_is_empty(const transfer_span *s) {
    return s->k[0] == 0.0 && s->k[1] == 0.0;
}

/* transfer_find() - the number of the span that holds a value. */
int transfer_find(const transfer *t, double value);

/* transfer_rgb() - the colour of a value. */
void transfer_rgb(const transfer *t, double value, double rgb[3]);

/* transfer_reaches() - whether the rates bound the change for values within e of the span's upper
 * end. Not for the last span. */
static inline bool transfer_reaches(const transfer *t, int span, double e) {
    const transfer_span *s = &t->span[span];
    return s[0].reach[1] > s->to + e && s[1].reach[0] < s->to - e;
}

/* Extinction and colour of all values in a range; colours without extinction do not count. */
typedef struct transfer_extent {
    double k[2], rgb[3][2]; /* the least and the largest */
} transfer_extent;

/* transfer_extent_of() - the extent of [lo, hi]. */
transfer_extent transfer_extent_of(const transfer *t, double lo, double hi);

/* The greatest difference between two values of a range that are up to e apart. */
typedef struct transfer_change {
    double k, rgb;   /* of extinction and colour; */
    double most_rgb; /* the largest component of the range's colours, used or not */
} transfer_change;

/* transfer_change_of() - the change in [lo, hi]. */
transfer_change transfer_change_of(const transfer *t, double lo, double hi, double e);

/* transfer_interest() - write the values with some extinction into intervals[]. Closes the
 * narrowest gaps where there would be more than `max` intervals. Returns their number. */
int transfer_interest(const transfer *t, interest_interval intervals[], int max);

#endif
