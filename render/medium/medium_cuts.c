#include "render/medium/medium_cuts.h"

#include "render/ray/cubic.h"

/* fmin() and fmax() without a library call; not for NaN. */
static double lesser(double a, double b) {
    return a < b ? a : b;
}
static double greater(double a, double b) {
    return a > b ? a : b;
}

void medium_cuts_clear(medium_cuts *c) {
    c->count = c->cuts.count = c->stretches.count = c->stretches.stepped = 0;
}

/* ---- Adding ---- */

typedef struct part {
    double a, b, fa, fb;
    int low, high; /* spans of the lesser and of the greater of fa and fb */
} part;

/* Add a stretch that ends at `to`, or at the next cut. */
static void add_stretch(medium_cuts *c, unsigned piece, int span, bool is_cut, double to) {
    medium_stretch_list *s = &c->stretches;
    const unsigned n = s->count++;
    s->piece[n] = (uint16_t)piece;
    s->span[n] = (uint16_t)span;
    s->is_cut[n] = is_cut;
    s->to[n] = to;
}

static void add_cut(medium_cut_list *cuts, unsigned piece, const part *p, double v, double enough) {
    const unsigned n = cuts->count++;
    cuts->piece[n] = (uint16_t)piece;
    cuts->v[n] = v;
    cuts->enough[n] = enough;
    cuts->a[n] = p->a;
    cuts->b[n] = p->b;
    cuts->fa[n] = p->fa;
    cuts->fb[n] = p->fb;
}

/* Look at ends of spans that the part's values do not reach, but its values plus or minus e do.
 * Returns whether rates bound the change at all of them. */
static bool is_smooth_beside(const transfer *t, const part *p, double e) {
    const double least = lesser(p->fa, p->fb) - e, most = greater(p->fa, p->fb) + e;
    for (int k = p->low - 1; k >= 0 && t->span[k].to > least; k--)
        if (!transfer_reaches(t, k, 2.0 * e))
            return false;
    for (int k = p->high; k + 1 < t->spans && t->span[k].to <= most; k++)
        if (!transfer_reaches(t, k, 2.0 * e))
            return false;
    return true;
}

static bool add_part(medium_cuts *c, const transfer *t, unsigned piece, const part *p, double e) {
    const bool up = p->fa < p->fb;
    const int end = up ? p->high : p->low, first = p->low + p->high - end;
    if (!is_smooth_beside(t, p, e))
        return false;
    for (int i = first; i != end; i += up ? 1 : -1) {
        const int below = up ? i : i - 1;
        const double enough = greater(e, t->span[below].give);
        if (!transfer_reaches(t, below, 2.0 * e + enough))
            return false;
        add_cut(&c->cuts, piece, p, t->span[below].to, enough);
        add_stretch(c, piece, i, true, p->b);
    }
    add_stretch(c, piece, end, false, p->b);
    return true;
}

static void add_piece(medium_cuts *c, unsigned i) {
    const unsigned n = c->count++;
    c->piece[n] = (uint16_t)i;
    c->end[n] = (uint16_t)c->stretches.count;
    c->lost[n] = false;
}

/* Add the parts between turns of the value, as integrate_parts() does. */
static bool add_parts(medium_cuts *c, const transfer *t, const segment *s, unsigned i, double e) {
    double at[2];
    const int turns = cubic_extrema(s->b, at);
    part p = {.b = 0.0, .fb = s->b[0], .low = transfer_find(t, s->b[0])};
    int last = p.low, room = MEDIUM_STRETCHES_OF_PIECE;
    for (int k = 0; k <= turns; k++) {
        p.a = p.b;
        p.fa = p.fb;
        p.b = k < turns ? at[k] : 1.0;
        p.fb = k < turns ? segment_at(s, at[k]) : s->b[3];
        const int next = transfer_find(t, p.fb);
        p.low = last < next ? last : next;
        p.high = last < next ? next : last;
        last = next;
        room -= p.high - p.low + 1;
        if (room < 0 || !add_part(c, t, i, &p, e))
            return false;
    }
    return true;
}

bool medium_cuts_add(medium_cuts *c, const transfer *t, const segment_columns *pieces, unsigned i,
                     double value_error, int low, int high) {
    const unsigned cuts = c->cuts.count, stretches = c->stretches.count;
    segment s = {.degree = (uint32_t)pieces->degree};
    bool added;
    for (int k = 0; k <= pieces->degree; k++)
        s.b[k] = pieces->b[k][i];
    if (s.degree == 1 || cubic_is_monotone(s.b)) {
        const part all = {0.0, 1.0, s.b[0], s.b[s.degree], low, high};
        added = high - low < MEDIUM_STRETCHES_OF_PIECE && add_part(c, t, i, &all, value_error);
    } else {
        added = add_parts(c, t, &s, i, value_error);
    }
    if (added) {
        add_piece(c, i);
    } else {
        c->cuts.count = cuts;
        c->stretches.count = stretches;
    }
    return added;
}

void medium_cuts_add_whole(medium_cuts *c, unsigned i, int span) {
    add_stretch(c, i, span, false, 1.0);
    add_piece(c, i);
}

/* ---- Placing ---- */

/* A place in a piece, as in medium_stretch.c. */
typedef struct place {
    double at, off;
} place;

/* Move stretch `from` to number `to`, which is not behind it, if anything is seen of it. Returns
 * the next free number. */
static unsigned keep(medium_stretch_list *s, const transfer *t, unsigned to, unsigned from,
                     const place ends[2]) {
    if (!(ends[0].at < ends[1].at) || transfer_is_empty(&t->span[s->span[from]]))
        return to;
    s->piece[to] = s->piece[from];
    s->span[to] = s->span[from];
    s->from[to] = ends[0].at;
    s->to[to] = ends[1].at;
    s->off[to] = greater(ends[0].off, ends[1].off);
    return to + 1;
}

void medium_cuts_place(medium_cuts *c, const transfer *t) {
    medium_stretch_list *s = &c->stretches;
    unsigned kept = 0, cut = 0;
    for (unsigned n = 0, i = 0; n < c->count; n++) {
        const unsigned first = kept;
        place ends[2] = {{0.0, 0.0}};
        for (; i < c->end[n]; i++) {
            ends[1] = (place){s->to[i], 0.0};
            if (s->is_cut[i]) {
                c->lost[n] |= c->cuts.off[cut] > c->cuts.enough[cut];
                ends[1] = (place){c->cuts.at[cut], c->cuts.off[cut]};
                cut++;
                if (ends[1].at < ends[0].at)
                    ends[1] = (place){ends[0].at, greater(ends[0].off, ends[1].off)};
            }
            kept = keep(s, t, kept, i, ends);
            ends[0] = ends[1];
        }
        if (c->lost[n])
            kept = first;
        c->end[n] = (uint16_t)kept;
    }
    s->count = kept;
}
