#include "formats/curved/hex_path.h"

#include "formats/curved/patch.h"

/* All of it is made in everybody's order of the face's corners. */
static void cross_face(const hexahedron *h, const hex_path *path, int face, int sense,
                       path_crossings in_out[2]) {
    int corner[PATCH_CORNERS];
    double p[PATCH_CORNERS][3], value[PATCH_CORNERS];
    const int outward = hexahedron_face(face, corner);
    double mine[PATCH_CORNERS][3];
    for (int i = 0; i < PATCH_CORNERS; i++)
        for (int a = 0; a < 3; a++)
            mine[i][a] = path->q[a][corner[i]];
    if (patch_beside((const double(*)[3])mine)) /* most faces; whatever the order */
        return;
    for (int i = 0; i < PATCH_CORNERS; i++) {
        value[i] = h->value[corner[i]];
        for (int a = 0; a < 3; a++)
            p[i][a] = h->p[corner[i]][a];
    }
    const patch_order order = patch_order_of(p, value);
    double q[PATCH_CORNERS][3], t[PATCH_CORNERS], f[PATCH_CORNERS];
    for (int i = 0; i < PATCH_CORNERS; i++) {
        for (int a = 0; a < 3; a++)
            q[i][a] = mine[order.corner[i]][a];
        t[i] = q[i][2];
        f[i] = value[order.corner[i]];
    }
    patch_crossing found[PATCH_CROSSINGS];
    const int count = patch_cross(q, found);
    for (int i = 0; i < count; i++) {
        path_end e = {.t = patch_at(t, found[i].at), .value = patch_at(f, found[i].at)};
        double own[2];
        patch_own(&order, found[i].at, own);
        hexahedron_face_point(face, own, e.at);
        path_crossings_add(&in_out[found[i].sense * order.sense * outward * sense > 0], &e);
    }
}

int hex_path_of(const hexahedron *h, int sense, const sheared_ray *r, hex_path *out) {
    path_crossings in_out[2] = {{0}, {0}};
    for (int c = 0; c < HEX_CORNERS; c++) {
        double q[3];
        sheared_ray_place(r, h->p[c], q);
        for (int a = 0; a < 3; a++)
            out->q[a][c] = q[a];
    }
    for (int face = 0; face < HEX_FACES; face++)
        cross_face(h, out, face, (sense < 0 ? -1 : 1) * r->sense, in_out);
    out->count = path_parts(in_out, sense == 0, out->part);
    return out->count;
}
