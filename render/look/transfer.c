#include "render/look/transfer.h"

#include <math.h>
#include <string.h>

/* ---- Making ---- */

/* The span between two points; with a == b the one beyond the first or the last point. */
static transfer_span span_of(const leafcast_transfer_point *a, const leafcast_transfer_point *b) {
    transfer_span s = {.from = a->value, .to = b->value, .base = a->value};
    const leafcast_transfer_point *ends[2] = {a, b};
    s.inverse = 1.0 / (s.to - s.from);
    for (int e = 0; e < 2; e++) {
        s.k[e] = ends[e]->extinction;
        s.most_k = fmax(s.most_k, s.k[e]);
        for (int c = 0; c < 3; c++) {
            s.rgb[e][c] = ends[e]->rgb[c];
            s.most_rgb = fmax(s.most_rgb, s.rgb[e][c]);
            s.rgb_change = fmax(s.rgb_change, fabs(s.rgb[e][c] - s.rgb[0][c]));
        }
    }
    return s;
}

static transfer_span beyond(const leafcast_transfer_point *p, double from, double to) {
    transfer_span s = span_of(p, p);
    s.from = from;
    s.to = to;
    s.base = s.inverse = 0.0;
    return s;
}

/* Whether two neighbouring spans agree where they meet. */
static bool is_smooth(const transfer_span *a, const transfer_span *b) {
    bool same = a->k[1] == b->k[0];
    for (int c = 0; c < 3; c++)
        same = same && a->rgb[1][c] == b->rgb[0][c];
    return same;
}

static void take_in_rates(transfer_span *s, const transfer_span *of) {
    const double most = 1e300; /* times the smallest error this exceeds any change */
    s->k_rate = fmax(s->k_rate, fmin(fabs(of->k[1] - of->k[0]) * of->inverse, most));
    s->rgb_rate = fmax(s->rgb_rate, fmin(of->rgb_change * of->inverse, most));
}

/* Returns transfer_span.give. An error of the value at a cut adds twice that error times the rate.
 * This one is so small that it does no harm, even if the piece is a million times as deep as light
 * goes. */
static double give_of(const transfer_span *below, const transfer_span *above) {
    return 0x1p-32 * fmin(below->to - below->from, above->to - above->from);
}

/* Set the members that depend on neighbouring spans. */
static void reach_out(transfer *t) {
    for (int i = 0; i < t->spans; i++) {
        transfer_span *s = &t->span[i];
        const bool below = i > 0 && is_smooth(s - 1, s);
        const bool above = i + 1 < t->spans && is_smooth(s, s + 1);
        s->reach[0] = below ? s[-1].from : s->from;
        s->reach[1] = above ? s[1].to : s->to;
        s->give = above ? give_of(s, s + 1) : 0.0;
        take_in_rates(s, s);
        if (below)
            take_in_rates(s, s - 1);
        if (above)
            take_in_rates(s, s + 1);
    }
}

static void note_most(transfer *t, const leafcast_transfer_point *p) {
    t->most_k = fmax(t->most_k, p->extinction);
    for (int c = 0; c < 3; c++)
        t->most_rgb = fmax(t->most_rgb, p->rgb[c]);
}

static status note_from(transfer *t, mem *m) {
    t->from = mem_array(m, (size_t)t->spans, sizeof *t->from);
    if (!t->from)
        return ST_NOMEM;
    for (int i = 0; i < t->spans; i++)
        t->from[i] = t->span[i].from;
    return ST_OK;
}

static status note_columns(transfer *t, mem *m) {
    if (t->spans > TRANSFER_FEW)
        return ST_OK;
    t->column = mem_array(m, (size_t)TRANSFER_COLUMNS * TRANSFER_FEW, sizeof *t->column);
    if (!t->column)
        return ST_NOMEM;
    for (size_t i = 0; i < TRANSFER_FEW; i++) {
        const size_t span = i < (size_t)t->spans ? i : 0; /* vectors read all columns */
        double member[TRANSFER_COLUMNS];
        memcpy(member, &t->span[span], sizeof member);
        for (size_t k = 0; k < TRANSFER_COLUMNS; k++)
            t->column[k * TRANSFER_FEW + i] = member[k];
    }
    return ST_OK;
}

status transfer_init(transfer *t, mem *m, const leafcast_medium *medium) {
    const leafcast_transfer_point *p = medium->points;
    const int last = medium->count - 1;
    *t = (transfer){0};
    if (medium->count == 0)
        return ST_OK;
    t->span = mem_array(m, (size_t)medium->count + 1, sizeof *t->span);
    if (!t->span)
        return ST_NOMEM;
    t->span[t->spans++] = beyond(&p[0], -INFINITY, p[0].value);
    for (int i = 0; i <= last; i++) {
        note_most(t, &p[i]);
        if (i < last && p[i].value < p[i + 1].value)
            t->span[t->spans++] = span_of(&p[i], &p[i + 1]);
    }
    t->span[t->spans++] = beyond(&p[last], p[last].value, INFINITY);
    reach_out(t);
    const status st = note_from(t, m);
    return st == ST_OK ? note_columns(t, m) : st;
}

void transfer_release(transfer *t, mem *m) {
    mem_free(m, t->column);
    mem_free(m, t->from);
    mem_free(m, t->span);
    *t = (transfer){0};
}

/* ---- Asking ---- */

int transfer_find(const transfer *t, double value) {
    int lo = 0, hi = t->spans;
    while (hi - lo > 1) {
        const int middle = lo + (hi - lo) / 2;
        if (t->span[middle].from <= value)
            lo = middle;
        else
            hi = middle;
    }
    return lo;
}

void transfer_rgb(const transfer *t, double value, double rgb[3]) {
    const transfer_span *s = &t->span[transfer_find(t, value)];
    const double w = (value - s->base) * s->inverse;
    for (int c = 0; c < 3; c++)
        rgb[c] = (1.0 - w) * s->rgb[0][c] + w * s->rgb[1][c];
}

static void widen(double range[2], double x) {
    range[0] = fmin(range[0], x);
    range[1] = fmax(range[1], x);
}

static void take_in(transfer_extent *e, const transfer_span *s, double value) {
    const double w = fmin(fmax((value - s->base) * s->inverse, 0.0), 1.0);
    widen(e->k, (1.0 - w) * s->k[0] + w * s->k[1]);
    for (int c = 0; c < 3 && !transfer_is_empty(s); c++)
        widen(e->rgb[c], (1.0 - w) * s->rgb[0][c] + w * s->rgb[1][c]);
}

transfer_extent transfer_extent_of(const transfer *t, double lo, double hi) {
    const double none[2] = {INFINITY, 0.0};
    transfer_extent e = {.k = {INFINITY, 0.0}};
    for (int c = 0; c < 3; c++)
        memcpy(e.rgb[c], none, sizeof none);
    for (int i = transfer_find(t, lo); i < t->spans && t->span[i].from <= hi; i++) {
        take_in(&e, &t->span[i], fmax(lo, t->span[i].from));
        take_in(&e, &t->span[i], fmin(hi, t->span[i].to));
    }
    return e;
}

/* Bounded by the steepest span's rate. Across a step the change may be as large as the values. */
transfer_change transfer_change_of(const transfer *t, double lo, double hi, double e) {
    transfer_change c = {0};
    double most_k = 0.0;
    bool step = false;
    for (int i = transfer_find(t, lo); i < t->spans && t->span[i].from <= hi; i++) {
        const transfer_span *s = &t->span[i];
        c.k = fmax(c.k, s->k_rate);
        c.rgb = fmax(c.rgb, s->rgb_rate);
        c.most_rgb = fmax(c.most_rgb, s->most_rgb);
        most_k = fmax(most_k, s->most_k);
        step |= i + 1 < t->spans && s->to <= hi && s->reach[1] == s->to;
    }
    c.k = step ? most_k : fmin(c.k * e, most_k);
    c.rgb = step ? c.most_rgb : fmin(c.rgb * e, c.most_rgb);
    return c;
}

/* Merge interval `before` with the next one. Returns the new count. */
static int take_in_gap(interest_interval of[], int count, int before) {
    of[before].hi = of[before + 1].hi;
    of[before].hi_open = of[before + 1].hi_open;
    for (int i = before + 1; i + 1 < count; i++)
        of[i] = of[i + 1];
    return count - 1;
}

static int narrowest_gap(const interest_interval of[], int count) {
    int found = 0;
    for (int i = 1; i + 1 < count; i++)
        if (of[i + 1].lo - of[i].hi < of[found + 1].lo - of[found].hi)
            found = i;
    return found;
}

int transfer_interest(const transfer *t, interest_interval of[], int max) {
    int count = 0;
    bool goes_on = false;
    for (int i = 0; i < t->spans; i++) {
        const transfer_span *s = &t->span[i];
        const bool hi_open = s->to < INFINITY;
        if (!transfer_is_empty(s) && goes_on) {
            of[count - 1].hi = s->to;
            of[count - 1].hi_open = hi_open;
        } else if (!transfer_is_empty(s)) {
            if (count == max)
                count = take_in_gap(of, count, narrowest_gap(of, count));
            of[count++] = (interest_interval){s->from, s->to, !(s->k[0] > 0.0), hi_open};
        }
        goes_on = !transfer_is_empty(s);
    }
    return count;
}
