#include "formats/curved/quadratic_path.h"

#include <math.h>
#include <string.h>

#include "formats/base/simd_one.h"
#include "formats/base/vec3.h"
#include "formats/curved/bent_triangle.h"
#include "formats/curved/curved_normal_template.h"
#include "formats/curved/path_stretch.h"

/* Everybody's order of a face's corners: by position, then by value, which all who share it have
 * alike. Returns its sense in one's own order. */
static int order_corners(const quadratic_tet *c, const int node[BENT_CORNERS],
                         int corner[BENT_CORNERS]) {
    int sense = 1;
    for (int k = 0; k < BENT_CORNERS; k++) {
        int i = k;
        for (; i > 0; i--) {
            const double *mine = c->p[node[k]], *its = c->p[node[corner[i - 1]]];
            int a = 0;
            while (a < 2 && mine[a] == its[a])
                a++;
            const bool same = mine[a] == its[a];
            if (same ? c->value[node[k]] >= c->value[node[corner[i - 1]]] : mine[a] > its[a])
                break;
            corner[i] = corner[i - 1];
            sense = -sense;
        }
        corner[i] = k;
    }
    return sense;
}

/* The place in a face's list of nodes of that between two of its corners. */
static int node_between(int a, int b) {
    return a + b == 1 ? 3 : a + b == 3 ? 4 : 5;
}

/* The nodes of a face in everybody's order: the corners, then those of the edges 01, 12, 02. */
static int order_face(const quadratic_tet *c, int face, int node[BENT_NODES]) {
    const int *own = quadratic_face(face);
    int corner[BENT_CORNERS];
    const int sense = order_corners(c, own, corner);
    for (int k = 0; k < BENT_CORNERS; k++) {
        node[k] = own[corner[k]];
        node[BENT_CORNERS + k] =
            own[node_between(corner[k > 1 ? 0 : k], corner[k > 1 ? 2 : k + 1])];
    }
    return sense;
}

/* All of it is made in everybody's order. */
static void cross_face(const quadratic_tet *c, unsigned straight, const curved_map *map, int face,
                       int sense, path_crossings in_out[2]) {
    int node[BENT_NODES];
    const int order = order_face(c, face, node);
    bent_triangle b;
    double t[BENT_NODES], value[BENT_NODES];
    for (int i = 0; i < BENT_NODES; i++) {
        for (int a = 0; a < 3; a++)
            b.q[i][a] = map->q[a][node[i]];
        if (i >= BENT_CORNERS)
            b.straight[i - BENT_CORNERS] = straight >> (node[i] - QUADRATIC_CORNERS) & 1;
        t[i] = map->q[2][node[i]];
        value[i] = map->value[node[i]];
    }
    bent_crossing found[BENT_CROSSINGS];
    const int count = bent_triangle_cross(&b, found);
    for (int i = 0; i < count; i++) {
        path_end e = {.t = bent_triangle_at(t, found[i].share),
                      .value = bent_triangle_at(value, found[i].share)};
        for (int k = 0; k < BENT_CORNERS; k++)
            if (node[k] > 0)
                e.at[node[k] - 1] = found[i].share[k];
        path_crossings_add(&in_out[found[i].sense * order * sense > 0], &e);
    }
}

/* Whether all coefficients are on one side of the ray, along one of two axes: then no face is
 * crossed. That of an edge that counts as straight is between two corners, so it need not be looked
 * at by itself. */
static bool is_beside(const double q[3][QUADRATIC_NODES]) {
    int above = 0, left = 0, right = 0;
    for (int n = 0; n < QUADRATIC_NODES; n++) {
        double at[2] = {q[0][n], q[1][n]};
        for (int a = 0; a < 2 && n >= QUADRATIC_CORNERS; a++) {
            const int *edge = quadratic_edge(n - QUADRATIC_CORNERS);
            at[a] = quadratic_control(q[a][edge[0]], q[a][edge[1]], at[a]);
        }
        above += at[1] >= 0.0;
        right += at[0] > 0.0;
        left += at[0] < 0.0;
    }
    return above == 0 || above == QUADRATIC_NODES || right == QUADRATIC_NODES ||
           left == QUADRATIC_NODES;
}

bool quadratic_path_place(const quadratic_tet *c, const sheared_ray *r, quadratic_path *out) {
    double q[3][QUADRATIC_NODES];
    for (int n = 0; n < QUADRATIC_NODES; n++) {
        double place[3];
        sheared_ray_place(r, c->p[n], place);
        for (int a = 0; a < 3; a++)
            q[a][n] = place[a];
    }
    out->count = 0;
    if (is_beside((const double(*)[QUADRATIC_NODES])q)) /* most cells that are near */
        return false;
    out->straight = quadratic_straight_edges(c);
    out->map.form = &form_quadratic;
    for (int a = 0; a < 3; a++)
        quadratic_form(q[a], out->straight, out->map.q[a]);
    quadratic_form(c->value, 0, out->map.value);
    return true;
}

int quadratic_path_cross(const quadratic_tet *c, int sense, const sheared_ray *r,
                         quadratic_path *out) {
    path_crossings in_out[2] = {{0}, {0}};
    for (int face = 0; face < QUADRATIC_FACES; face++)
        cross_face(c, out->straight, &out->map, face, (sense < 0 ? -1 : 1) * r->sense, in_out);
    out->count = path_parts(in_out, sense == 0, out->part);
    return out->count;
}

int quadratic_path_of(const quadratic_tet *c, int sense, const sheared_ray *r,
                      quadratic_path *out) {
    return quadratic_path_place(c, r, out) ? quadratic_path_cross(c, sense, r, out) : 0;
}

bool quadratic_point_find(const quadratic_tet *c, int sense, const double point[3], double at[3],
                          double *value) {
    static const double up[3] = {0.0, 0.0, 1.0};
    const sheared_ray r = sheared_ray_of(point, up);
    quadratic_path path;
    path_end e;
    if (!path_parts_at(path.part, quadratic_path_of(c, sense, &r, &path), 0.0, &e))
        return false;
    double in[3] = {e.at[0], e.at[1], e.at[2]};
    if (sense != 0 && path_stretch_locate(&path.map, 0.0, in)) {
        e.value = quadratic_at(path.map.value, in);
        memcpy(e.at, in, sizeof e.at);
    }
    memcpy(at, e.at, sizeof e.at);
    *value = e.value;
    return true;
}

bool quadratic_point_gradient(const quadratic_tet *c, const double at[3], double gradient[3]) {
    return quadratic_gradient(c, at, gradient);
}
