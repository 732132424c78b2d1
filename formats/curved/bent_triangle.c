#include "formats/curved/bent_triangle.h"

#include <math.h>
#include <stddef.h>

#include "formats/base/vec3.h"
#include "formats/curved/patch.h"

/* The coefficient of a product of two shares. */
static const int of_pair[BENT_CORNERS][BENT_CORNERS] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
static const int edges[BENT_CORNERS][2] = {{0, 1}, {1, 2}, {0, 2}};

double bent_triangle_at(const double form[BENT_NODES], const double share[BENT_CORNERS]) {
    double sum = 0.0;
    for (int i = 0; i < BENT_CORNERS; i++) {
        double half = 0.0;
        for (int j = 0; j < BENT_CORNERS; j++)
            half += share[j] * form[of_pair[i][j]];
        sum += share[i] * half;
    }
    return sum;
}

/* ---- Turns ---- */

/* The parabola's point at s, whose sign on the first axis is asked for where the second is 0. */
static bool is_right(const double a[3], const double between[3], const double b[3], double s) {
    if ((a[0] >= 0.0) == (b[0] >= 0.0) && (a[0] >= 0.0) == (between[0] >= 0.0))
        return a[0] >= 0.0;                /* as beside() has it, whatever rounding does */
    s = s > 0.0 ? s < 1.0 ? s : 1.0 : 0.0; /* NaN is 0 */
    const double low = a[0] + s * (between[0] - a[0]), high = between[0] + s * (b[0] - between[0]);
    return low + s * (high - low) >= 0.0;
}

/* patch_turn() of a parabola: where it crosses the first axis, upward and downward, once each at
 * most. */
static int parabola_turn(const double a[3], const double between[3], const double b[3]) {
    const bool from_above = a[1] >= 0.0, to_above = b[1] >= 0.0;
    const double half = between[1] - a[1], bend = (a[1] - between[1]) + (b[1] - between[1]);
    const double square = between[1] * between[1] - a[1] * b[1];
    const double root = square > 0.0 ? sqrt(square) : 0.0;
    if (from_above == to_above && (from_above == (between[1] >= 0.0) || !(square > 0.0)))
        return 0;
    int sum = 0;
    if (!from_above || to_above) /* upward */
        sum += is_right(a, between, b, half <= 0.0 ? (root - half) / bend : a[1] / (-half - root));
    if (from_above || !to_above)
        sum -= is_right(a, between, b, half >= 0.0 ? (-half - root) / bend : a[1] / (root - half));
    return sum;
}

static int edge_turn(const bent_triangle *b, int edge) {
    const double *from = b->q[edges[edge][0]], *to = b->q[edges[edge][1]];
    return b->straight[edge] ? patch_turn(from, to)
                             : parabola_turn(from, b->q[BENT_CORNERS + edge], to);
}

/* ---- Places ---- */

/* A point where the map is 0, in the triangle or beside it. */
typedef struct candidate {
    double share[BENT_CORNERS];
    double outside; /* by how much it is outside; below 0: inside */
    int sense;
    bool taken;
} candidate;

enum { CANDIDATES = 16, DEEPEST = 26, PARTS = 512, LOOKS = 4096 };

typedef struct search {
    double q[2][BENT_NODES]; /* coefficients, by coordinate */
    double bend[2][3]; /* half the second derivatives: by 1 twice, by 1 and 2 twice, by 2 twice */
    int count;
    candidate found[CANDIDATES];
} search;

/* A triangle of parameters, the shares of corners 1 and 2: (u, v), (u + h, v), (u, v + h). */
typedef struct part {
    double u, v, h;
    int depth;
} part;

static void value_at(const search *s, const double at[2], double value[2], double slope[2][2]) {
    const double share[BENT_CORNERS] = {1.0 - at[0] - at[1], at[0], at[1]};
    for (int k = 0; k < 2; k++) {
        double half[BENT_CORNERS];
        for (int i = 0; i < BENT_CORNERS; i++) {
            half[i] = 0.0;
            for (int j = 0; j < BENT_CORNERS; j++)
                half[i] += share[j] * s->q[k][of_pair[i][j]];
        }
        value[k] = share[0] * half[0] + share[1] * half[1] + share[2] * half[2];
        slope[k][0] = 2.0 * (half[1] - half[0]);
        slope[k][1] = 2.0 * (half[2] - half[0]);
    }
}

/* x such that slope x = y; false: there is none. */
static bool solve(const double slope[2][2], double det, const double y[2], double x[2]) {
    x[0] = (y[0] * slope[1][1] - y[1] * slope[0][1]) / det;
    x[1] = (slope[0][0] * y[1] - slope[1][0] * y[0]) / det;
    return isfinite(x[0]) && isfinite(x[1]);
}

static double det_of(const double slope[2][2]) {
    return slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0];
}

/* Newton's method for the one point there is within reach of a middle. */
static void look_for(search *s, const double middle[2], const double guess[2], double reach) {
    enum { STEPS = 20 };
    double at[2] = {guess[0], guess[1]}, value[2], slope[2][2], det = 0.0;
    for (int n = 0; n < STEPS; n++) {
        double by[2];
        value_at(s, at, value, slope);
        det = det_of((const double(*)[2])slope);
        if (!solve((const double(*)[2])slope, det, value, by))
            return;
        for (int k = 0; k < 2; k++)
            at[k] -= by[k];
        if (!(real_max(fabs(at[0] - middle[0]), fabs(at[1] - middle[1])) <= 2.0 * reach))
            return;
        if (real_max(fabs(by[0]), fabs(by[1])) <= 0x1p-51)
            break;
    }
    const candidate c = {.share = {1.0 - at[0] - at[1], at[0], at[1]},
                         .outside = real_max(real_max(-at[0], -at[1]), at[0] + at[1] - 1.0),
                         .sense = det < 0.0 ? -1 : 1,
                         .taken = false};
    for (int i = 0; i < s->count; i++) { /* found from a triangle next to this one, too */
        const double away =
            real_max(fabs(s->found[i].share[1] - at[0]), fabs(s->found[i].share[2] - at[1]));
        if (away < 0x1p-24 && s->found[i].sense == c.sense)
            return;
    }
    if (s->count < CANDIDATES)
        s->found[s->count++] = c;
}

/* Whether there may be several points in a part: then it is to be cut. If there is one at most, it
 * is looked for. The map is its value in the middle, its slope there, and what bends, which is the
 * same everywhere. */
static bool look(search *s, const part *p) {
    const double middle[2] = {p->u + p->h / 3.0, p->v + p->h / 3.0};
    const double reach = 0.675 * fabs(p->h); /* some more than 2/3 */
    double value[2], slope[2][2], straight[2], most = 0.0;
    value_at(s, middle, value, slope);
    for (int k = 0; k < 2; k++) {
        const double bent = fabs(s->bend[k][0]) + fabs(s->bend[k][1]) + fabs(s->bend[k][2]);
        if (fabs(value[k]) > (fabs(slope[k][0]) + fabs(slope[k][1])) * reach + bent * reach * reach)
            return false;
    }
    const double det = det_of((const double(*)[2])slope);
    if (!solve((const double(*)[2])slope, det, value, straight))
        return true;
    for (int i = 0; i < 2; i++) {
        double bent = 0.0;
        for (int n = 0; n < 3; n++) {
            double by[2];
            if (!solve((const double(*)[2])slope, det, (double[2]){s->bend[0][n], s->bend[1][n]},
                       by))
                return true;
            bent += fabs(by[i]);
        }
        if (fabs(straight[i]) > reach + bent * reach * reach)
            return false;
        most = real_max(most, bent);
    }
    if (!(2.0 * most * reach < 0.5))
        return true;
    const double guess[2] = {middle[0] - straight[0], middle[1] - straight[1]};
    look_for(s, middle, guess, reach);
    return false;
}

/* The largest parts first. Where the ray goes along the face, they have no end: what some thousands
 * of them have not found is left to the edges. */
static void find_all(search *s) {
    part ahead[PARTS]; /* a ring */
    int next = 0, count = 1, looked = 0;
    ahead[0] = (part){0.0, 0.0, 1.0, 0};
    for (; next < count && looked < LOOKS; looked++) {
        const part p = ahead[next++ % PARTS];
        if (!look(s, &p) || p.depth == DEEPEST || count - next + 4 > PARTS)
            continue;
        const double h = 0.5 * p.h;
        const int depth = p.depth + 1;
        ahead[count++ % PARTS] = (part){p.u + h, p.v + h, -h, depth};
        ahead[count++ % PARTS] = (part){p.u, p.v + h, h, depth};
        ahead[count++ % PARTS] = (part){p.u + h, p.v, h, depth};
        ahead[count++ % PARTS] = (part){p.u, p.v, h, depth};
    }
}

/* ---- Both together ---- */

/* Where the ray passes the face closest by: a corner, or the middle of an edge. It crosses there,
 * as far as doubles can tell. */
static candidate closest(const search *s) {
    candidate best = {.share = {1.0, 0.0, 0.0}};
    double least = INFINITY;
    for (int n = 0; n < BENT_NODES; n++) {
        candidate c = {.share = {0.0, 0.0, 0.0}};
        double away = 0.0;
        if (n < BENT_CORNERS)
            c.share[n] = 1.0;
        else
            c.share[edges[n - BENT_CORNERS][0]] = c.share[edges[n - BENT_CORNERS][1]] = 0.5;
        for (int k = 0; k < 2; k++)
            away = real_max(away, fabs(bent_triangle_at(s->q[k], c.share)));
        if (away < least) {
            least = away;
            best = c;
        }
    }
    return best;
}

/* Take what is inside, then more or less until the senses add up to what the edges say: of those
 * that would help, the one that is closest to an edge. */
static void agree(search *s, int sum) {
    int taken = 0;
    for (int i = 0; i < s->count; i++) {
        s->found[i].taken = s->found[i].outside <= 0.0;
        taken += s->found[i].taken ? s->found[i].sense : 0;
    }
    while (taken != sum) {
        const int wanted = sum > taken ? 1 : -1;
        candidate *best = NULL;
        for (int i = 0; i < s->count; i++) {
            candidate *c = &s->found[i];
            if (c->sense == (c->taken ? -wanted : wanted) &&
                (!best || fabs(c->outside) < fabs(best->outside)))
                best = c;
        }
        if (!best) {
            if (s->count == CANDIDATES)
                return;
            best = &s->found[s->count++];
            *best = closest(s);
            best->sense = wanted;
        }
        best->taken = !best->taken;
        taken += wanted;
    }
}

static bent_crossing crossing_at(const candidate *c) {
    bent_crossing x = {.sense = c->sense};
    double sum = 0.0;
    for (int i = 0; i < BENT_CORNERS; i++) {
        x.share[i] = real_min(real_max(0.0, c->share[i]), 1.0);
        sum += x.share[i];
    }
    for (int i = 0; i < BENT_CORNERS; i++)
        x.share[i] /= sum;
    return x;
}

/* A triangle whose edges are straight is a patch with a side that is a point. */
static int cross_straight(const bent_triangle *b, bent_crossing out[BENT_CROSSINGS]) {
    double q[PATCH_CORNERS][3];
    patch_crossing found[PATCH_CROSSINGS];
    for (int i = 0; i < PATCH_CORNERS; i++)
        for (int a = 0; a < 3; a++)
            q[i][a] = b->q[i < BENT_CORNERS ? i : BENT_CORNERS - 1][a];
    const int count = patch_cross((const double(*)[3])q, found);
    for (int i = 0; i < count; i++) {
        const double u = found[i].at[0], v = found[i].at[1];
        out[i] = (bent_crossing){{(1.0 - v) * (1.0 - u), (1.0 - v) * u, v}, found[i].sense};
    }
    return count;
}

/* Whether all coefficients are on one side of the ray: then it is not crossed. */
static bool beside(const bent_triangle *b) {
    int above = 0, left = 0, right = 0;
    for (int i = 0; i < BENT_NODES; i++) {
        above += b->q[i][1] >= 0.0;
        right += b->q[i][0] > 0.0;
        left += b->q[i][0] < 0.0;
    }
    return above == 0 || above == BENT_NODES || right == BENT_NODES || left == BENT_NODES;
}

int bent_triangle_cross(const bent_triangle *b, bent_crossing out[BENT_CROSSINGS]) {
    if (beside(b))
        return 0;
    if (b->straight[0] && b->straight[1] && b->straight[2])
        return cross_straight(b, out);
    search s = {.count = 0};
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < BENT_NODES; i++)
            s.q[k][i] = b->q[i][k];
        const double *q = s.q[k];
        s.bend[k][0] = (q[1] - q[3]) - (q[3] - q[0]);
        s.bend[k][1] = 2.0 * ((q[4] - q[3]) - (q[5] - q[0]));
        s.bend[k][2] = (q[2] - q[5]) - (q[5] - q[0]);
    }
    find_all(&s);
    agree(&s, edge_turn(b, 0) + edge_turn(b, 1) - edge_turn(b, 2));
    int count = 0;
    for (int i = 0; i < s.count && count < BENT_CROSSINGS; i++)
        if (s.found[i].taken)
            out[count++] = crossing_at(&s.found[i]);
    return count;
}
