#include "tests/support/ref_media.h"

#include <math.h>
#include <stdlib.h>

typedef long double real;

static const real DEEP = 64, DEPTH_STEP = 1;

/* How much two rules may differ, of the brightest colour. */
static const real AGREE = 1e-16L;

enum { HALVINGS = 60, CUTS_MAX = 1 << 22 };

/* ---- Transfer functions ---- */

/* The stretch between two neighbouring points; beyond the ends, and of one value, both are one. */
typedef struct stretch {
    const leafcast_transfer_point *a, *b;
} stretch;

/* Where the value comes from `value` on and rises (1), falls (-1) or stays (0). */
static stretch stretch_from(const leafcast_transfer_point *p, int count, real value, int rising) {
    int below = 0, end = count; /* points 0 .. below - 1 lie below (falling), or not above */
    while (below < end) {
        const int middle = below + (end - below) / 2;
        if (rising < 0 ? (real)p[middle].value < value : (real)p[middle].value <= value)
            below = middle + 1;
        else
            end = middle;
    }
    if (below == 0)
        return (stretch){&p[0], &p[0]};
    if (below == count)
        return (stretch){&p[count - 1], &p[count - 1]};
    return (stretch){&p[below - 1], &p[below]};
}

/* What its ends count at a value, together 1. */
typedef struct weights {
    real a, b;
} weights;

/* That is `more` above `value`: near a point that is not the same as their sum. */
static weights weights_at(const stretch *s, real value, real more) {
    const real width = (real)s->b->value - s->a->value;
    const real b = (value - s->a->value) / width + more / width;
    const real a = (s->b->value - value) / width - more / width;
    if (!(width > 0))
        return (weights){1, 0};
    return (weights){fminl(fmaxl(a, 0), 1), fminl(fmaxl(b, 0), 1)};
}

static real extinction_of(const stretch *s, weights w) {
    return w.a * s->a->extinction + w.b * s->b->extinction;
}

static real colour_of(const stretch *s, weights w, int c) {
    return w.a * s->a->rgb[c] + w.b * s->b->rgb[c];
}

void ref_transfer(const leafcast_transfer_point *points, int count, long double value,
                  long double rgb[3], long double *extinction) {
    const stretch s = stretch_from(points, count, value, 0);
    const weights w = isnan(value) ? (weights){0, 0} : weights_at(&s, value, 0);
    *extinction = extinction_of(&s, w);
    for (int c = 0; c < 3; c++)
        rgb[c] = colour_of(&s, w, c);
}

/* ---- The way through one medium ---- */

/* What is next on the way through a medium. */
typedef enum event { NOTHING, ENDS, TURNS, MEETS } event;

typedef struct lane {
    const ref_medium *of;
    size_t at;   /* the piece that it is in, or before */
    bool inside; /* of that piece; else in a gap */
    real left;   /* of the piece, or of the gap */
    real k[4];   /* the value at x from here on */
    stretch on;  /* the stretch of the transfer function on which it goes on */
    event next;
    real reach; /* how far it is to that */
    real met;   /* MEETS: the point's value */
} lane;

static void enter_piece(lane *l, real gap) {
    const bool some = l->at < l->of->count;
    const ref_piece *p = &l->of->pieces[l->at];
    l->inside = some && !(gap > 0);
    l->left = !some ? INFINITY : l->inside ? p->t1 - p->t0 : gap;
    for (int i = 0; i < 4; i++)
        l->k[i] = l->inside ? p->k[i] : 0;
}

static lane lane_begin(const ref_medium *of, real t) {
    lane l = {.of = of};
    enter_piece(&l, of->count > 0 ? of->pieces[0].t0 - t : 0);
    return l;
}

static void leave(lane *l) {
    if (!l->inside) {
        enter_piece(l, 0);
        return;
    }
    const real t = l->of->pieces[l->at++].t1;
    enter_piece(l, l->at < l->of->count ? l->of->pieces[l->at].t0 - t : 0);
}

/* The next value of a point strictly above, or below; false where there is none. */
static bool next_value(const ref_medium *m, real value, bool above, real *next) {
    const stretch s = stretch_from(m->points, m->point_count, value, above ? 1 : -1);
    *next = above ? s.b->value : s.a->value;
    return above ? *next > value : *next < value;
}

/* The first x in (0, end] at which the monotone cubic has come from k[0] to `value`. */
static real meet(const real k[4], real value, real end) {
    const real from = k[0] - value;
    real lo = 0, hi = end;
    for (;;) {
        const real x = lo + (hi - lo) / 2;
        if (!(x > lo && x < hi))
            return hi;
        const real g = from + x * (k[1] + x * (k[2] + x * k[3]));
        if (from < 0 ? g >= 0 : g <= 0)
            hi = x;
        else
            lo = x;
    }
}

static void look_ahead(lane *l) {
    real turn[2], value;
    l->next = l->left < INFINITY ? ENDS : NOTHING;
    l->reach = l->left;
    if (!l->inside)
        return;
    if (ref_cubic_turns(l->k, l->left, turn) > 0) {
        l->next = TURNS;
        l->reach = turn[0];
    }
    const real there = ref_piece_at(l->k, l->reach);
    const int rising = (there > l->k[0]) - (there < l->k[0]);
    l->on = stretch_from(l->of->points, l->of->point_count, l->k[0], rising);
    if (rising != 0 && next_value(l->of, l->k[0], rising > 0, &value) &&
        (rising > 0 ? there > value : there < value)) {
        l->reach = meet(l->k, value, l->reach);
        l->next = MEETS;
        l->met = value;
    }
}

/* k about x instead of 0. */
static void shift(real k[4], real x) {
    const real *const c = k;
    const real to[3] = {ref_piece_at(c, x), c[1] + x * (2 * c[2] + 3 * x * c[3]),
                        c[2] + 3 * x * c[3]};
    for (int i = 0; i < 3; i++)
        k[i] = to[i];
}

static void advance(lane *l, real x) {
    if (l->reach > x || l->next == NOTHING) {
        l->left -= x;
        shift(l->k, x);
        return;
    }
    if (l->next == ENDS) {
        leave(l);
        return;
    }
    l->left -= x;
    shift(l->k, x);
    if (l->next == TURNS)
        l->k[1] = 0;
    else
        l->k[0] = l->met;
}

/* ---- Between two cuts ---- */

typedef struct span {
    const lane *lanes;
    int count;
    real depth[5]; /* the optical depth at x: depth[0] + depth[1] x + ... */
    ref_rule rule;
    real tolerance;
} span;

/* The extinction of one medium as a polynomial. */
static void add_extinction(const lane *l, real sum[4]) {
    const stretch *s = &l->on;
    if (!l->inside)
        return;
    const real width = (real)s->b->value - s->a->value;
    const real slope = width > 0 ? ((real)s->b->extinction - s->a->extinction) / width : 0;
    sum[0] += extinction_of(s, weights_at(s, l->k[0], 0));
    for (int i = 1; i < 4; i++)
        sum[i] += slope * l->k[i];
}

static span span_of(const lane *lanes, int count, real depth, ref_rule rule, real tolerance) {
    span s = {lanes, count, {depth}, rule, tolerance};
    real sum[4] = {0};
    for (int i = 0; i < count; i++)
        add_extinction(&lanes[i], sum);
    for (int i = 0; i < 4; i++)
        s.depth[i + 1] = sum[i] / (i + 1);
    return s;
}

static weights weights_there(const lane *l, real x) {
    return weights_at(&l->on, l->k[0], x * (l->k[1] + x * (l->k[2] + x * l->k[3])));
}

static real extinction_there(const span *s, real x) {
    real sum = 0;
    for (int i = 0; i < s->count; i++)
        if (s->lanes[i].inside)
            sum += extinction_of(&s->lanes[i].on, weights_there(&s->lanes[i], x));
    return sum;
}

/* Beyond depth[0]. */
static real depth_gained(const span *s, real x) {
    if (s->rule == REF_TANH_SINH) /* Simpson's rule is exact for cubics */
        return x / 6 *
               (extinction_there(s, 0) + 4 * extinction_there(s, x / 2) + extinction_there(s, x));
    return x * (s->depth[1] + x * (s->depth[2] + x * (s->depth[3] + x * s->depth[4])));
}

static bool is_empty(const span *s) {
    for (int i = 1; i < 5; i++)
        if (s->depth[i] != 0)
            return false;
    return true;
}

/* The light of one medium that reaches the eye from there, a length. */
static void add_emission(const lane *l, real x, real left, real rgb[3]) {
    const weights w = weights_there(l, x);
    const real e = left * extinction_of(&l->on, w);
    for (int c = 0; c < 3; c++)
        rgb[c] += e * colour_of(&l->on, w, c);
}

static void integrand(const span *s, real x, real rgb[3]) {
    const real left = expl(-(s->depth[0] + depth_gained(s, x)));
    for (int c = 0; c < 3; c++)
        rgb[c] = 0;
    for (int i = 0; i < s->count; i++)
        if (s->lanes[i].inside)
            add_emission(&s->lanes[i], x, left, rgb);
}

/* ---- Gauss and Kronrod ---- */

/* Nodes and weights on [-1, 1] (Kronrod 1965), from 0 on; every second is Gauss's too. */
static const real kronrod[8][3] = {
    {0.0L, 0.209482141084727828012999174891714L, 0.417959183673469387755102040816327L},
    {0.207784955007898467600689403773245L, 0.204432940075298892414161999234649L, 0},
    {0.405845151377397166906606412076961L, 0.190350578064785409913256402421014L,
     0.381830050505118944950369775488975L},
    {0.586087235467691130294144691697430L, 0.169004726639267902826583426598550L, 0},
    {0.741531185599394439863864773280788L, 0.140653259715525918745189590510238L,
     0.279705391489276667901467771423780L},
    {0.864864423359769072789712788640926L, 0.104790010322250183839876322541518L, 0},
    {0.949107912342758524526189684047851L, 0.063092092629978553290700663189204L,
     0.129484966168869693270611432679082L},
    {0.991455371120812639206854697526329L, 0.022935322010529224963732008058970L, 0}};

static real two_rules(const span *s, real a, real b, real rgb[3]) {
    const real middle = a + (b - a) / 2, half = (b - a) / 2;
    real fine[3] = {0}, coarse[3] = {0}, differ = 0;
    for (int n = 0; n < 8; n++)
        for (int sign = -1; sign <= (n > 0 ? 1 : -1); sign += 2) {
            real f[3];
            integrand(s, middle + sign * half * kronrod[n][0], f);
            for (int c = 0; c < 3; c++) {
                fine[c] += half * kronrod[n][1] * f[c];
                coarse[c] += half * kronrod[n][2] * f[c];
            }
        }
    for (int c = 0; c < 3; c++) {
        rgb[c] = fine[c];
        differ = fmaxl(differ, fabsl(fine[c] - coarse[c]));
    }
    return differ;
}

/* Adds to rgb; returns by how much the rules differ. */
static real by_halves(const span *s, real a, real b, int halvings, real rgb[3]) {
    real here[3];
    const real differ = two_rules(s, a, b, here), middle = a + (b - a) / 2;
    if (differ > s->tolerance && halvings > 0 && middle > a && middle < b)
        return by_halves(s, a, middle, halvings - 1, rgb) +
               by_halves(s, middle, b, halvings - 1, rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] += here[c];
    return differ;
}

/* ---- Tanh and sinh (Takahasi and Mori 1974) ---- */

/* The sum over the nodes first * h, (first + step) * h, ... of either sign. */
static void exponential_nodes(const span *s, real end, real h, int first, int step, real rgb[3]) {
    const real quarter = 0.785398163397448309615660845819876L;
    for (int n = first; n * h < 4.5L; n += step) {
        const real u = 2 * quarter * sinhl(n * h);
        /* 1 / (1 + e^2u), which is the node's distance from its end, of 1 */
        const real near = 1 / (1 + expl(2 * u));
        const real weight = h * end * quarter * coshl(n * h) / (coshl(u) * coshl(u));
        for (int side = 0; side < (n > 0 ? 2 : 1); side++) {
            real f[3];
            integrand(s, side ? end * near : end * (1 - near), f);
            for (int c = 0; c < 3; c++)
                rgb[c] += weight * f[c];
        }
    }
}

static real exponential(const span *s, real end, real rgb[3]) {
    real sum[3] = {0}, differ = INFINITY, h = 1;
    exponential_nodes(s, end, h, 0, 1, sum);
    for (int level = 0; level < 10 && differ > s->tolerance; level++) {
        real more[3] = {0};
        h /= 2;
        exponential_nodes(s, end, h, 1, 2, more);
        differ = 0;
        for (int c = 0; c < 3; c++) {
            more[c] += sum[c] / 2;
            differ = fmaxl(differ, fabsl(more[c] - sum[c]));
            sum[c] = more[c];
        }
    }
    for (int c = 0; c < 3; c++)
        rgb[c] += sum[c];
    return differ;
}

/* ---- The ray ---- */

typedef struct walk {
    const ref_media *m;
    lane lanes[REF_MEDIA_MAX];
    int surface;        /* the next one */
    real to_surface;    /* how far it is, INFINITY: none */
    real depth, behind; /* optical depth; what surfaces have let through */
    real tolerance;
    ref_colour sum;
} walk;

static real brightest(const ref_media *m) {
    real most = 0;
    for (int i = 0; i < m->count; i++)
        for (int n = 0; n < m->of[i].point_count; n++)
            for (int c = 0; c < 3; c++)
                most = fmaxl(most, m->of[i].points[n].rgb[c]);
    return most;
}

static walk walk_begin(const ref_media *m) {
    walk w = {.m = m, .to_surface = INFINITY, .behind = 1, .tolerance = AGREE * brightest(m)};
    real t = m->surface_count > 0 ? m->surfaces[0].t : INFINITY;
    for (int i = 0; i < m->count; i++)
        t = m->of[i].count > 0 ? fminl(t, m->of[i].pieces[0].t0) : t;
    for (int i = 0; i < m->count; i++)
        w.lanes[i] = lane_begin(&m->of[i], t);
    if (m->surface_count > 0)
        w.to_surface = m->surfaces[0].t - t;
    return w;
}

/* As far as the next cut; INFINITY: there is none. */
static real next_cut(walk *w) {
    real reach = w->to_surface;
    for (int i = 0; i < w->m->count; i++) {
        look_ahead(&w->lanes[i]);
        reach = fminl(reach, w->lanes[i].reach);
    }
    return reach;
}

/* As far as the optical depth gains no more than a step. */
static real not_too_deep(const span *s, real reach) {
    real lo = 0, hi = reach;
    if (depth_gained(s, reach) <= DEPTH_STEP)
        return reach;
    for (;;) {
        const real x = lo + (hi - lo) / 2;
        if (!(x > lo && x < hi))
            return hi;
        if (depth_gained(s, x) < DEPTH_STEP)
            lo = x;
        else
            hi = x;
    }
}

static void pass_surface(walk *w) {
    const ref_surface *s = &w->m->surfaces[w->surface++];
    const real left = w->behind * expl(-w->depth);
    for (int c = 0; c < 3; c++)
        w->sum.rgb[c] += left * s->opacity * s->rgb[c];
    w->behind *= 1 - (real)s->opacity;
    w->to_surface = w->surface < w->m->surface_count ? s[1].t - s->t : INFINITY;
}

/* From here to the next cut. */
static void pass(walk *w, real reach) {
    const span s = span_of(w->lanes, w->m->count, w->depth, w->m->rule, w->tolerance);
    real rgb[3] = {0};
    if (!is_empty(&s)) {
        reach = not_too_deep(&s, reach);
        w->sum.error +=
            w->behind * (s.rule == REF_TANH_SINH ? exponential(&s, reach, rgb)
                                                 : by_halves(&s, 0, reach, HALVINGS, rgb));
        w->depth += depth_gained(&s, reach);
    }
    for (int c = 0; c < 3; c++)
        w->sum.rgb[c] += w->behind * rgb[c];
    for (int i = 0; i < w->m->count; i++)
        advance(&w->lanes[i], reach);
    if (w->to_surface <= reach)
        pass_surface(w);
    else
        w->to_surface -= reach;
}

ref_colour ref_media_colour(const ref_media *m) {
    walk w = walk_begin(m);
    for (;;) {
        const real reach = next_cut(&w);
        if (!(reach < INFINITY) || w.depth > DEEP || w.behind == 0)
            break;
        if (w.sum.cuts++ == CUTS_MAX)
            abort(); /* it goes round in circles */
        pass(&w, reach);
    }
    const real left = w.behind * (w.depth > DEEP ? 0 : expl(-w.depth));
    w.sum.transmittance = left;
    for (int c = 0; c < 3; c++)
        w.sum.rgb[c] += left * m->background[3] * m->background[c];
    w.sum.alpha = 1 - left + left * m->background[3];
    return w.sum;
}

/* ---- Projections ---- */

static void widen(ref_extent *e, long double value, long double t) {
    if (!(value >= e->least)) {
        e->least = value;
        e->least_t = t;
    }
    if (!(value <= e->most)) {
        e->most = value;
        e->most_t = t;
    }
}

/* The integral of a piece's value. */
static real piece_sum(const ref_piece *p) {
    const real x = p->t1 - p->t0;
    return x * (p->k[0] + x * (p->k[1] / 2 + x * (p->k[2] / 3 + x * p->k[3] / 4)));
}

ref_extent ref_project(const ref_piece *pieces, size_t count) {
    ref_extent e = {NAN, NAN, NAN, NAN, 0, 0};
    for (size_t i = 0; i < count; i++) {
        const ref_piece *p = &pieces[i];
        real turn[2];
        const int turns = ref_cubic_turns(p->k, p->t1 - p->t0, turn);
        widen(&e, p->k[0], p->t0);
        for (int n = 0; n < turns; n++)
            widen(&e, ref_piece_at(p->k, turn[n]), p->t0 + turn[n]);
        widen(&e, ref_piece_at(p->k, p->t1 - p->t0), p->t1);
        e.length += p->t1 - p->t0;
        e.mean += piece_sum(p);
    }
    e.mean /= e.length;
    return e;
}

/* How far into the piece; INFINITY: nowhere. */
static real first_in(const ref_piece *p, real value) {
    real cuts[4] = {0}, turn[2] = {0};
    const int turns = ref_cubic_turns(p->k, p->t1 - p->t0, turn);
    if (p->k[0] >= value)
        return 0;
    for (int n = 0; n < turns; n++)
        cuts[n + 1] = turn[n];
    cuts[turns + 1] = p->t1 - p->t0;
    for (int n = 0; n <= turns; n++) {
        real k[4] = {p->k[0], p->k[1], p->k[2], p->k[3]};
        if (!(ref_piece_at(k, cuts[n + 1]) >= value))
            continue;
        shift(k, cuts[n]);
        return cuts[n] + meet(k, value, cuts[n + 1] - cuts[n]);
    }
    return INFINITY;
}

long double ref_first_at_least(const ref_piece *pieces, size_t count, long double value,
                               long double *f) {
    for (size_t i = 0; i < count; i++) {
        const real x = first_in(&pieces[i], value);
        if (!(x < INFINITY))
            continue;
        *f = ref_piece_at(pieces[i].k, x);
        return pieces[i].t0 + x;
    }
    *f = NAN;
    return NAN;
}
