#include "formats/curved/hex_open.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { FORMS = 4 }; /* three of position, one of value */

/* Of a corner's forms. */
static double *form_of(hex_opened *o, int form, int corner) {
    return form < 3 ? &o->map.q[form][corner] : &o->map.value[corner];
}

static bool same(const hexahedron *h, int a, int b) {
    return h->p[a][0] == h->p[b][0] && h->p[a][1] == h->p[b][1] && h->p[a][2] == h->p[b][2] &&
           h->value[a] == h->value[b];
}

static int corner_at(int a, int i, int b, int j, int c, int k) {
    return i << a | j << b | k << c;
}

/* Whether the edges along an axis, at a side of another, are points: both of them, or the one at a
 * side of the third. */
static bool is_point(const hexahedron *h, int along, int across, int side, int end) {
    const int third = 3 - along - across;
    return same(h, corner_at(along, 0, across, side, third, end),
                corner_at(along, 1, across, side, third, end));
}

/* The side at which all four corners are one: its axis, or -1. */
static int find_apex(const hexahedron *h, int *side) {
    for (int a = 0; a < 3; a++)
        for (*side = 0; *side < 2; ++*side) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            const int first = corner_at(a, *side, b, 0, c, 0);
            if (same(h, first, corner_at(a, *side, b, 1, c, 0)) &&
                same(h, first, corner_at(a, *side, b, 0, c, 1)) &&
                same(h, first, corner_at(a, *side, b, 1, c, 1)))
                return a;
        }
    return -1;
}

/* The edges that are points at both ends of the third axis; or at one side of it, in a tet. */
static bool find_edge(const hexahedron *h, int third, int end, hex_opened *o) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++)
            for (int side = 0; side < 2 && a != b; side++) {
                if (third >= 0 && (a == third || b == third))
                    continue;
                if (!is_point(h, a, b, side, end) || (third < 0 && !is_point(h, a, b, side, !end)))
                    continue;
                o->along = a;
                o->across = b;
                o->edge_side = side;
                return true;
            }
    return false;
}

static void open_edge(hex_opened *o) {
    const int a = o->along, b = o->across, c = 3 - a - b, side = o->edge_side;
    for (int end = 0; end < 2; end++)
        for (int f = 0; f < FORMS; f++)
            *form_of(o, f, corner_at(a, 1, b, side, c, end)) =
                *form_of(o, f, corner_at(a, 0, b, side, c, end)) +
                (*form_of(o, f, corner_at(a, 1, b, !side, c, end)) -
                 *form_of(o, f, corner_at(a, 0, b, !side, c, end)));
}

static void open_apex(hex_opened *o) {
    const int a = o->apex, b = (a + 1) % 3, c = (a + 2) % 3, side = o->apex_side;
    for (int n = 1; n < 4; n++)
        for (int f = 0; f < FORMS; f++)
            *form_of(o, f, corner_at(a, side, b, n & 1, c, n >> 1)) +=
                *form_of(o, f, corner_at(a, !side, b, n & 1, c, n >> 1)) -
                *form_of(o, f, corner_at(a, !side, b, 0, c, 0));
}

/* Whether the base opposite to an apex is a parallelogram. */
static bool has_even_base(const hexahedron *h, int a, int side) {
    const int b = (a + 1) % 3, c = (a + 2) % 3;
    int corner[4];
    for (int n = 0; n < 4; n++)
        corner[n] = corner_at(a, !side, b, n & 1, c, n >> 1);
    bool even =
        h->value[corner[3]] - h->value[corner[2]] == h->value[corner[1]] - h->value[corner[0]];
    for (int i = 0; i < 3; i++)
        even = even &&
               h->p[corner[3]][i] - h->p[corner[2]][i] == h->p[corner[1]][i] - h->p[corner[0]][i];
    return even;
}

void hex_open(const hexahedron *h, const hex_path *path, hex_opened *out) {
    out->map.form = &form_trilinear;
    for (int k = 0; k < 3; k++)
        memcpy(out->map.q[k], path->q[k], sizeof path->q[k]);
    memcpy(out->map.value, h->value, sizeof h->value);
    out->along = -1;
    out->apex = find_apex(h, &out->apex_side);
    if (find_edge(h, out->apex, !out->apex_side, out))
        open_edge(out);
    else if (out->apex >= 0 && !has_even_base(h, out->apex, out->apex_side))
        out->apex = -1;
    if (out->apex >= 0)
        open_apex(out);
}

/* How far a parameter is from the side where edges are points: 1 to 0. */
static double from_side(double x, int side) {
    return side ? 1.0 - x : x;
}

void hex_open_into(const hex_opened *o, double at[3]) {
    if (o->along >= 0)
        at[o->along] *= from_side(at[o->across], o->edge_side);
    for (int n = 1; n < 3 && o->apex >= 0; n++)
        at[(o->apex + n) % 3] *= from_side(at[o->apex], o->apex_side);
}

/* Where edges are points, any parameter along them will do. */
static double quotient(double x, double share) {
    return share > 0.0 ? real_min(real_max(0.0, x / share), 1.0) : 0.5;
}

void hex_open_out(const hex_opened *o, double at[3]) {
    for (int n = 1; n < 3 && o->apex >= 0; n++)
        at[(o->apex + n) % 3] =
            quotient(at[(o->apex + n) % 3], from_side(at[o->apex], o->apex_side));
    if (o->along >= 0)
        at[o->along] = quotient(at[o->along], from_side(at[o->across], o->edge_side));
}

void hex_open_parts(const hex_opened *o, const hex_path *path, path_part out[PATH_PARTS]) {
    for (int i = 0; i < path->count; i++) {
        out[i] = path->part[i];
        for (int k = 0; k < 2; k++)
            hex_open_into(o, out[i].end[k].at);
    }
}
