#include "render/experiments/packet_frustum.h"

#include "formats/base/vec3.h"

void packet_frustum_begin(packet_frustum *s, const projection *p, float x, float y, int side) {
    s->projection = p;
    s->x = x;
    s->y = y;
    s->side = side;
    for (int a = 0; a < 3; a++) {
        s->eye[a] = p->eye[a];
        s->least[a] = INFINITY;
        s->most[a] = -INFINITY;
    }
}

void packet_frustum_add(packet_frustum *s, const double d[3]) {
    for (int a = 0; a < 3; a++) {
        s->least[a] = d[a] < s->least[a] ? d[a] : s->least[a];
        s->most[a] = d[a] > s->most[a] ? d[a] : s->most[a];
    }
}

/* ---- Boxes ---- */

/* Narrow [t_in, t_out] by the least and the greatest t at which rays meet the planes of an axis.
 * Quotients are monotone, rounded or not. */
static void packet_slab(double least, double most, double lo, double hi, double *t_in,
                        double *t_out) {
    double in = -INFINITY, out = INFINITY;
    if (least > 0.0) {
        in = lo / (lo > 0.0 ? most : least);
        out = hi / (hi > 0.0 ? least : most);
    } else if (most < 0.0) {
        in = hi / (hi < 0.0 ? least : most);
        out = lo / (lo < 0.0 ? most : least);
    } else if (lo > 0.0) {
        in = lo / most;
    } else if (hi < 0.0) {
        in = hi / least;
    }
    *t_in = in > *t_in ? in : *t_in;
    *t_out = out < *t_out ? out : *t_out;
}

/* Find the smallest and the largest pixel that the corners cover along one side. Returns false if
 * they miss the packet's pixels. */
static bool packet_span(const float at[8], float first, float margin, int side, int *from,
                        int *to) {
    float lo = at[0], hi = at[0];
    for (int c = 1; c < 8; c++) {
        lo = at[c] < lo ? at[c] : lo;
        hi = at[c] > hi ? at[c] : hi;
    }
    lo = ceilf(lo - first - margin);
    hi = floorf(hi - first + margin);
    if (!(lo <= hi && lo < (float)side && hi >= 0.0f))
        return false;
    *from = lo > 0.0f ? (int)lo : 0;
    *to = hi < (float)side ? (int)hi : side - 1;
    return true;
}

/* Find the pixels that a box can cover: all of them if it reaches behind the eye. */
static bool packet_pixels(const packet_frustum *s, const packet_box *b, packet_rect *out) {
    const projection *p = s->projection;
    float x[8], y[8], least = INFINITY, far = 0.0f;
    *out = (packet_rect){0, s->side - 1, 0, s->side - 1};
    for (int c = 0; c < 8; c++) {
        float w = 0.0f;
        x[c] = y[c] = 0.0f;
        for (int a = 0; a < 3; a++) {
            const float at = (float)(c >> a & 1 ? b->hi : b->lo)[a];
            x[c] += at * p->axis[a][0];
            y[c] += at * p->axis[a][1];
            w += at * p->axis[a][2];
        }
        least = w < least ? w : least;
        x[c] /= w;
        y[c] /= w;
    }
    for (int a = 0; a < 3; a++)
        far += p->axis[a][3] * (float)fmax(fabs(b->lo[a]), fabs(b->hi[a]));
    if (!(least > projection_depth_share * far))
        return true;
    return packet_span(x, s->x, p->margin, s->side, &out->x0, &out->x1) &&
           packet_span(y, s->y, p->margin, s->side, &out->y0, &out->y1);
}

bool packet_frustum_box(const packet_frustum *s, const packet_box *b, packet_reach *out) {
    double t_in = -INFINITY, t_out = INFINITY;
    for (int a = 0; a < 3; a++)
        packet_slab(s->least[a], s->most[a], b->lo[a], b->hi[a], &t_in, &t_out);
    /* Twice the margin of one ray, whose own interval is narrower. */
    const double slack = 2.0 * BOX_INTERVAL_MARGIN * (fabs(t_in) + fabs(t_out));
    out->near = t_in - slack;
    /* If the slack is not finite, every box may be met. */
    return !(out->near > t_out + slack) && !(out->near > s->far) && !(t_out + slack < 0.0) &&
           packet_pixels(s, b, &out->pixels);
}

/* ---- Isopolygons ---- */

/* Bounds the rounding of directions, corners and edge functions, relative to the sum of moduli. */
static const double certainty = 0x1p-38;

/* Returns the side of the edge from a to b on which all corner rays certainly are; 0: there is no
 * such side. */
static int side_of(const packet_frustum *s, const double a[3], const double b[3]) {
    double normal[3], terms = 0.0;
    int above = 0, below = 0;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        const double up = a[l] * (b[m] - a[m]), down = a[m] * (b[l] - a[l]);
        normal[k] = up - down;
        terms += fabs(up) + fabs(down);
    }
    for (int c = 0; c < 4; c++) {
        const double e =
            normal[0] * s->corner[0][c] + normal[1] * s->corner[1][c] + normal[2] * s->corner[2][c];
        above += e > certainty * terms;
        below += e < -certainty * terms;
    }
    return above == 4 ? 1 : below == 4 ? -1 : 0;
}

/* Returns 1 if all rays hit a triangle, -1 if all miss it, 0 if that is not certain. side[]: on
 * which side of each edge the rays are. A ray hits the triangle only if its edge functions are 0 or
 * have the sign of `front`, the side of the triangle on which the eye is. If the eye is almost in
 * the triangle's plane, the result is 0. */
static int view_triangle(const double a[4][3], int j, int k, const int side[3]) {
    const double volume = vec3_det(a[0], a[j], a[k]);
    const double size = vec3_size(a[0]) * vec3_size(a[j]) * vec3_size(a[k]);
    const int front = volume > certainty * size ? 1 : volume < -certainty * size ? -1 : 0;
    if (front == 0)
        return 0;
    if (side[0] == -front || side[1] == -front || side[2] == -front)
        return -1;
    return side[0] == front && side[1] == front && side[2] == front;
}

packet_view packet_frustum_polygon(const packet_frustum *s, const isopolygon *g) {
    double a[4][3];
    for (int i = 0; i < 4; i++)
        vec3_sub(g->p[i], s->eye, a[i]);
    const int across = side_of(s, a[2], a[0]);
    const int sides[3] = {side_of(s, a[0], a[1]), side_of(s, a[1], a[2]), across};
    const int first = view_triangle(a, 1, 2, sides);
    if (first > 0)
        return PACKET_HITS_FIRST;
    if (g->count == 3)
        return first < 0 ? PACKET_MISSES : PACKET_DIFFERS;
    const int others[3] = {side_of(s, a[2], a[3]), side_of(s, a[3], a[0]), -across};
    const int second = view_triangle(a, 2, 3, others);
    if (second > 0)
        return PACKET_HITS_SECOND;
    return first < 0 && second < 0 ? PACKET_MISSES : PACKET_DIFFERS;
}
