#include "render/experiments/hex_exit.h"

#include <math.h>

#include "formats/base/vec3.h"

/* Parameters this near to an edge of a patch are on it; t and weights may be off by as much. */
static const double NEAR = 1e-9;

/* The Pluecker test of the ray with the edge from p to q: above 0 where the ray is to the left of
 * it, in the plane of the first two coordinates. */
static double turn_of(const double p[2], const double q[2]) {
    return p[0] * q[1] - p[1] * q[0];
}

/* ---- the three areas ---- */

/* M08's vertices: 0 to 3 on the entry face, 4 to 7 opposite of them; bit 0 and 1 of a vertex are
 * along the next two axes, `left` and `up`, after that of the entry face. A side is at 0 or 1 of
 * left. */
enum { LOWER, MIDDLE, UPPER, AREAS };

/* Edges that part an area's three faces, so that the ray passes them in the same sense. */
static const int PARTING[AREAS][2][2] = {{{0, 4}, {1, 5}}, {{4, 6}, {5, 7}}, {{6, 2}, {7, 3}}};

/* The cell's corners as vertices, by the entry face. */
static const uint8_t VERTICES[HEX_FACES][HEX_CORNERS] = {
    {0, 2, 4, 6, 1, 3, 5, 7}, {1, 3, 5, 7, 0, 2, 4, 6}, {0, 4, 1, 5, 2, 6, 3, 7},
    {2, 6, 3, 7, 0, 4, 1, 5}, {0, 1, 2, 3, 4, 5, 6, 7}, {4, 5, 6, 7, 0, 1, 2, 3}};

typedef struct labels {
    const double *p[HEX_CORNERS];
    double sense; /* of a turn that is to be above 0 */
    int side[2];  /* faces at 0 and 1 of left */
    int last[AREAS];
} labels;

static labels label(const hex_view *v) {
    const int axis = v->entry / 2, left = (axis + 1) % 3, up = (axis + 2) % 3;
    labels l = {.sense = v->entry & 1 ? -v->sense : v->sense,
                .side = {2 * left, 2 * left + 1},
                .last = {2 * up, v->entry ^ 1, 2 * up + 1}};
    for (int i = 0; i < HEX_CORNERS; i++)
        l.p[i] = v->q[VERTICES[v->entry][i]];
    return l;
}

static double test(hex_view *v, const labels *l, int from, int to) {
    v->tests++;
    return l->sense * turn_of(l->p[from], l->p[to]);
}

/* The first step, for both methods. */
static int area_of(hex_view *v, const labels *l) {
    const double low = test(v, l, 4, 5), high = test(v, l, 6, 7);
    return low < 0.0 ? LOWER : high > 0.0 ? UPPER : MIDDLE;
}

/* The second step: one test, or two. */
static int face_of(hex_view *v, const labels *l, int area) {
    const int(*edge)[2] = PARTING[area];
    if (test(v, l, edge[0][0], edge[0][1]) > 0.0)
        return l->side[0];
    return test(v, l, edge[1][0], edge[1][1]) < 0.0 ? l->side[1] : l->last[area];
}

static int corners_of(const hex_view *v, int face, const double *q[4]) {
    int corner[4];
    const int sense = hexahedron_face(face, corner);
    for (int i = 0; i < 4; i++)
        q[i] = v->q[corner[i]];
    return sense * v->sense;
}

/* ---- triangles ---- */

static void find_t(const double *const q[4], hex_point *p) {
    p->t = 0.0;
    for (int c = 0; c < 4; c++)
        p->t += p->weight[c] * q[c][2];
}

bool hex_exit_triangles(const double *const q[4], int turn, hex_point *out) {
    const int third = turn * turn_of(q[0], q[3]) < 0.0 ? 1 : 2;
    const double first = turn_of(q[third], q[3]), middle = turn_of(q[3], q[0]),
                 last = turn_of(q[0], q[third]), sum = first + middle + last;
    *out = (hex_point){.weight = {first / sum, 0.0, 0.0, last / sum}};
    out->weight[third] = middle / sum;
    find_t(q, out);
    return out->weight[0] >= -NEAR && out->weight[third] >= -NEAR && out->weight[3] >= -NEAR;
}

int hex_exit_pluecker(hex_view *v, hex_point *out) {
    const labels l = label(v);
    const int face = face_of(v, &l, area_of(v, &l));
    if (v->placed) {
        const double *q[4];
        const int turn = corners_of(v, face, q);
        v->tests += 3; /* the diagonal, and two edges: one is known from a step before */
        if (!hex_exit_triangles(q, turn, out))
            return -1;
    }
    return face;
}

/* ---- patches ---- */

/* The second parameter where the ray may meet the patch: the roots of a quadratic equation, of
 * which the square is left out where it is far below the rest. Returns how many. */
static int roots_of(double a, double b, double c, double root[2]) {
    if (fabs(a) <= 1e-12 * fabs(b)) {
        root[0] = -c / b;
        return b != 0.0;
    }
    const double square = b * b - 4.0 * a * c;
    if (!(square >= 0.0))
        return 0;
    const double sum = -0.5 * (b + copysign(sqrt(square), b));
    root[0] = sum / a;
    root[1] = c / sum;
    return 2;
}

/* How far inside of [0, 1] two parameters are; below 0: outside. */
static double depth_of(const double at[2]) {
    return real_min(real_min(at[0], 1.0 - at[0]), real_min(at[1], 1.0 - at[1]));
}

static void point_at(const double *const q[4], const double at[2], hex_point *out) {
    const double u = real_min(real_max(at[0], 0.0), 1.0), v = real_min(real_max(at[1], 0.0), 1.0);
    *out = (hex_point){.weight = {(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v}};
    find_t(q, out);
}

/* The equation is (q0 + u along) + v (across + u twist) = 0, in two coordinates. */
hex_met hex_exit_patch(const double *const q[4], double t, hex_point *out) {
    const double least = t - NEAR * (fabs(t) + fabs(q[0][2]));
    double along[2], across[2], twist[2], root[2];
    hex_met met = HEX_OFF;
    for (int k = 0; k < 2; k++) {
        along[k] = q[1][k] - q[0][k];
        across[k] = q[2][k] - q[0][k];
        twist[k] = q[3][k] - q[2][k] - along[k];
    }
    const int count =
        roots_of(turn_of(across, twist), turn_of(across, along) + turn_of(q[0], twist),
                 turn_of(q[0], along), root);
    for (int i = 0; i < count; i++) {
        const double run[2] = {along[0] + root[i] * twist[0], along[1] + root[i] * twist[1]};
        const int k = fabs(run[1]) > fabs(run[0]); /* the larger denominator */
        const double at[2] = {-(q[0][k] + root[i] * across[k]) / run[k], root[i]};
        const double depth = depth_of(at);
        hex_point p;
        if (!(depth >= -NEAR))
            continue;
        point_at(q, at, &p);
        if (p.t < least || (met != HEX_OFF && p.t >= out->t))
            continue;
        met = depth > NEAR ? HEX_ON : HEX_EDGE;
        *out = p;
    }
    return met;
}

/* Where no patch has the ray inside, some have it on an edge: the second step tells which one. */
static int choose_edge(hex_view *v, const labels *l, int area, const int face[3],
                       const hex_met met[3]) {
    const int told = face_of(v, l, area);
    int chosen = -1;
    for (int i = 0; i < 3; i++)
        if (met[i] == HEX_EDGE && (chosen < 0 || face[i] == told))
            chosen = i;
    return chosen;
}

int hex_exit_hybrid(hex_view *v, hex_point *out) {
    const labels l = label(v);
    const int area = area_of(v, &l), face[3] = {l.last[area], l.side[0], l.side[1]};
    hex_point point[3];
    hex_met met[3];
    int chosen = -1;
    for (int i = 0; i < 3 && chosen < 0; i++) {
        const double *q[4];
        (void)corners_of(v, face[i], q);
        v->patches++;
        met[i] = hex_exit_patch(q, v->t, &point[i]);
        chosen = met[i] == HEX_ON ? i : -1;
    }
    if (chosen < 0)
        chosen = choose_edge(v, &l, area, face, met);
    if (chosen < 0)
        return -1;
    *out = point[chosen];
    return face[chosen];
}
