#include "formats/curved/patch.h"

#include <math.h>
#include <stdbool.h>

#include "formats/base/vec3.h"

/* What rounding took from the product of a and b, exactly (Dekker 1971): of halves of their bits.
 */
static double rest_of(double a, double b, double product) {
    const double many = 0x1p27 + 1.0, am = many * a, bm = many * b;
    const double a_high = am - (am - a), b_high = bm - (bm - b);
    const double a_low = a - a_high, b_low = b - b_high;
    return ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
}

/* Two products are compared exactly: each is a double and a rest. */
static int compare_products(double a, double b, double c, double d) {
    const double p = a * b, q = c * d;
    if (p != q)
        return p > q ? 1 : -1;
    const double p_rest = rest_of(a, b, p), q_rest = rest_of(c, d, q);
    return (p_rest > q_rest) - (p_rest < q_rest);
}

/* On which side of the directed line from one point to another the ray is: 1 left, -1 right, 0. */
static int side_of(const double from[3], const double to[3]) {
    return compare_products(from[0], to[1], to[0], from[1]);
}

static double turn_of(const double a[3], const double b[3]) {
    return a[0] * b[1] - a[1] * b[0];
}

int patch_turn(const double from[3], const double to[3]) {
    const bool up = to[1] >= 0.0;
    if (up == (from[1] >= 0.0))
        return 0;
    const int side = side_of(from, to);
    return up ? side >= 0 : -(side <= 0);
}

/* How often the edges turn about the ray, moved as patch.h says. */
static int turns(const double q[PATCH_CORNERS][3]) {
    static const int ring[PATCH_CORNERS] = {0, 1, 3, 2};
    int sum = 0;
    for (int k = 0; k < PATCH_CORNERS; k++)
        sum += patch_turn(q[ring[k]], q[ring[(k + 1) % PATCH_CORNERS]]);
    return sum;
}

/* A point where the bilinear map is 0, inside the square or not. */
typedef struct candidate {
    double at[2];
    double outside; /* by how much it is outside of the square; below 0: inside by so much */
} candidate;

static double largest(const double q[PATCH_CORNERS][3]) {
    double most = 0.0;
    for (int i = 0; i < PATCH_CORNERS; i++)
        most = real_max(most, real_max(fabs(q[i][0]), fabs(q[i][1])));
    return most;
}

/* The ray goes along the patch's straight line of this first parameter, as far as doubles can tell.
 * Moved as patch.h says, it is where the first derivative has the direction of the move. */
static candidate candidate_along(const double q[PATCH_CORNERS][3], double u) {
    const double low = q[1][1] - q[0][1], high = q[3][1] - q[2][1], v = low / (low - high);
    return (candidate){{u, v >= 0.0 && v <= 1.0 ? v : 0.5}, real_max(-u, u - 1.0)};
}

static candidate candidate_at(const double q[PATCH_CORNERS][3], double u) {
    double low[2], along[2];
    for (int k = 0; k < 2; k++) {
        low[k] = q[0][k] + u * (q[1][k] - q[0][k]);
        along[k] = q[2][k] + u * (q[3][k] - q[2][k]) - low[k];
    }
    const double size = along[0] * along[0] + along[1] * along[1];
    const double small = 0x1p-46 * largest(q);
    if (size <= small * small) /* that line of the patch is parallel to the ray */
        return real_max(fabs(low[0]), fabs(low[1])) <= small ? candidate_along(q, u)
                                                             : (candidate){{NAN, NAN}, INFINITY};
    const double v = -(low[0] * along[0] + low[1] * along[1]) / size;
    return (candidate){{u, v}, real_max(real_max(-u, u - 1.0), real_max(-v, v - 1.0))};
}

/* The first parameter solves a quadratic equation: the ray is on the line through the points with
 * that parameter on two opposite edges. Returns the number of finite solutions. If there is none
 * by rounding only, real is false, and where it nearly has one counts as a solution. */
static int solve(const double q[PATCH_CORNERS][3], candidate out[2], bool *real) {
    const double c = turn_of(q[0], q[2]), end = turn_of(q[1], q[3]);
    const double middle = 0.5 * (turn_of(q[0], q[3]) + turn_of(q[1], q[2]));
    const double a = (c - middle) + (end - middle), half = middle - c;
    const double square = half * half - a * c;
    const double root = square > 0.0 ? sqrt(square) : 0.0;
    *real = square > 0.0;
    const double far = half < 0.0 ? -half + root : -half - root;
    const double u[2] = {far / a, c / far};
    int count = 0;
    for (int i = 0; i < 2; i++) {
        const candidate found = candidate_at(q, u[i]);
        if (isfinite(found.at[0]) && isfinite(found.at[1]))
            out[count++] = found;
    }
    return count;
}

/* The same by the second parameter: where any first one would do. */
static int solve_across(const double q[PATCH_CORNERS][3], candidate out[2], bool *real) {
    double turned[PATCH_CORNERS][3];
    for (int i = 0; i < PATCH_CORNERS; i++)
        for (int k = 0; k < 2; k++)
            turned[(i & 1) << 1 | i >> 1][k] = q[i][k];
    const int count = solve((const double(*)[3])turned, out, real);
    for (int i = 0; i < count; i++)
        out[i] = (candidate){{out[i].at[1], out[i].at[0]}, out[i].outside};
    return count;
}

static double into_unit(double x) {
    return x > 0.0 ? x < 1.0 ? x : 1.0 : 0.0; /* NaN is 0 */
}

/* The corner that is next to the ray: the ray goes through it, and through a side that is a point.
 */
static candidate corner_by(const double q[PATCH_CORNERS][3]) {
    int next = 0;
    for (int i = 1; i < PATCH_CORNERS; i++)
        if (real_max(fabs(q[i][0]), fabs(q[i][1])) < real_max(fabs(q[next][0]), fabs(q[next][1])))
            next = i;
    return (candidate){{(double)(next & 1), (double)(next >> 1)}, 0.0};
}

/* The map's slopes by its parameters at a point. Returns their determinant. */
static double slopes_at(const double q[PATCH_CORNERS][3], const double at[2], double first[2],
                        double second[2]) {
    for (int k = 0; k < 2; k++) {
        first[k] = (1.0 - at[1]) * (q[1][k] - q[0][k]) + at[1] * (q[3][k] - q[2][k]);
        second[k] = (1.0 - at[0]) * (q[2][k] - q[0][k]) + at[0] * (q[3][k] - q[1][k]);
    }
    return first[0] * second[1] - first[1] * second[0];
}

/* A crossing near a solution. One step of Newton's method takes away what the quadratic's rounding
 * has left. sense: 0: the map's own there. */
static patch_crossing crossing_at(const double q[PATCH_CORNERS][3], const candidate *c, int sense) {
    double first[2], second[2], value[2], at[2] = {c->at[0], c->at[1]};
    const double det = slopes_at(q, at, first, second);
    for (int k = 0; k < 2; k++)
        value[k] = patch_at((const double[PATCH_CORNERS]){q[0][k], q[1][k], q[2][k], q[3][k]}, at);
    const double step[2] = {(value[0] * second[1] - value[1] * second[0]) / det,
                            (first[0] * value[1] - first[1] * value[0]) / det};
    if (fabs(step[0]) < 0x1p-10 && fabs(step[1]) < 0x1p-10)
        for (int k = 0; k < 2; k++)
            at[k] -= step[k];
    return (patch_crossing){{into_unit(at[0]), into_unit(at[1])},
                            sense ? sense : (det < 0.0 ? -1 : 1)};
}

int patch_cross(const double q[PATCH_CORNERS][3], patch_crossing out[PATCH_CROSSINGS]) {
    candidate found[2];
    bool real;
    if (patch_beside(q))
        return 0;
    const int sum = turns(q);
    int count = solve(q, found, &real);
    if (count == 0)
        count = solve_across(q, found, &real);
    if (sum == 0) {
        /* Both are in the square, or neither: the one that is further from its edges tells. */
        if (!real || count < 2 ||
            !(fabs(found[0].outside) > fabs(found[1].outside) ? found[0].outside < 0.0
                                                              : found[1].outside < 0.0))
            return 0;
        out[0] = crossing_at(q, &found[0], 0);
        out[1] = crossing_at(q, &found[1], -out[0].sense);
        return 2;
    }
    candidate *best = &found[0];
    if (count == 0)
        *best = corner_by(q);
    if (count == 2 && found[1].outside < best->outside)
        best = &found[1];
    out[0] = crossing_at(q, best, sum > 0 ? 1 : -1);
    return 1;
}

static int compare_corners(const double p[3], double value, const double q[3], double other) {
    for (int a = 0; a < 3; a++)
        if (p[a] != q[a])
            return p[a] < q[a] ? -1 : 1;
    return (value > other) - (value < other);
}

/* The eight orders of a quadrilateral begin at a corner and go round this way or that. */
static patch_order order_of_four(const double p[PATCH_CORNERS][3],
                                 const double value[PATCH_CORNERS]) {
    patch_order best = {.corner = {0, 1, 2, 3}, .sense = 1};
    for (int i = 1; i < 8; i++) {
        patch_order o = {.flip = {i & 1, i >> 1 & 1}, .swap = i >> 2};
        int less = 0;
        for (int k = 0; k < PATCH_CORNERS; k++) {
            const int x = o.swap ? k >> 1 : k & 1, y = o.swap ? k & 1 : k >> 1;
            o.corner[k] = (x ^ o.flip[0]) | (y ^ o.flip[1]) << 1;
            const int mine = o.corner[k], its = best.corner[k];
            if (less == 0)
                less = compare_corners(p[mine], value[mine], p[its], value[its]);
        }
        o.sense = (o.flip[0] ^ o.flip[1] ^ o.swap) ? -1 : 1;
        if (less < 0)
            best = o;
    }
    return best;
}

/* Three corners, by size. Each exchange of two turns the triangle over. */
static patch_order order_of_three(const double p[PATCH_CORNERS][3],
                                  const double value[PATCH_CORNERS], int twin, int along) {
    static const int ring[PATCH_CORNERS] = {0, 1, 3, 2};
    patch_order o = {.sense = 1, .triangle = true, .twin = twin, .along = along};
    int count = 0;
    for (int k = 0; k < PATCH_CORNERS; k++) {
        if (ring[k] == (twin ^ 1 << along))
            continue;
        int i = count++;
        for (; i > 0 && compare_corners(p[ring[k]], value[ring[k]], p[o.corner[i - 1]],
                                        value[o.corner[i - 1]]) < 0;
             i--) {
            o.corner[i] = o.corner[i - 1];
            o.sense = -o.sense;
        }
        o.corner[i] = ring[k];
    }
    o.corner[3] = o.corner[2];
    return o;
}

patch_order patch_order_of(const double p[PATCH_CORNERS][3], const double value[PATCH_CORNERS]) {
    static const struct {
        int twin, along;
    } sides[PATCH_CORNERS] = {{0, 0}, {2, 0}, {0, 1}, {1, 1}};
    int same = 0, side = 0;
    for (int k = 0; k < PATCH_CORNERS; k++) {
        const int i = sides[k].twin, j = i ^ 1 << sides[k].along;
        if (compare_corners(p[i], value[i], p[j], value[j]) == 0) {
            same++;
            side = k;
        }
    }
    return same == 1 ? order_of_three(p, value, sides[side].twin, sides[side].along)
                     : order_of_four(p, value);
}

/* By the shares of the three corners: that of the twins tells how near their side is. */
static void own_of_three(const patch_order *o, const double at[2], double own[2]) {
    const double share[3] = {(1.0 - at[1]) * (1.0 - at[0]), (1.0 - at[1]) * at[0], at[1]};
    double twins = 0.0, other[2] = {0.0, 0.0};
    for (int i = 0; i < 3; i++)
        if (o->corner[i] == o->twin)
            twins = share[i];
        else
            other[o->corner[i] >> o->along & 1] = share[i];
    const double both = other[0] + other[1];
    own[!o->along] = (o->twin >> !o->along & 1) ? twins : 1.0 - twins;
    own[o->along] = both > 0.0 ? other[1] / both : 0.5;
}

void patch_own(const patch_order *o, const double at[2], double own[2]) {
    if (o->triangle) {
        own_of_three(o, at, own);
        return;
    }
    for (int k = 0; k < 2; k++) {
        const double x = at[o->swap ? !k : k];
        own[k] = o->flip[k] ? 1.0 - x : x;
    }
}
