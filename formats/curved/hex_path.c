#include "formats/curved/hex_path.h"

#include "formats/curved/patch.h"

/* Crossings in one sense, in order of t. */
typedef struct crossings {
    int count;
    hex_end end[HEX_FACES * PATCH_CROSSINGS];
} crossings;

static void add(crossings *s, const hex_end *e) {
    int i = s->count++;
    for (; i > 0 && s->end[i - 1].t > e->t; i--)
        s->end[i] = s->end[i - 1];
    s->end[i] = *e;
}

/* All of it is made in everybody's order of the face's corners. */
static void cross_face(const hexahedron *h, const hex_path *path, int face, int sense,
                       crossings in_out[2]) {
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
        hex_end e = {.t = patch_at(t, found[i].at), .value = patch_at(f, found[i].at)};
        double own[2];
        patch_own(&order, found[i].at, own);
        hexahedron_face_point(face, own, e.at);
        add(&in_out[found[i].sense * order.sense * outward * sense > 0], &e);
    }
}

int hex_path_of(const hexahedron *h, int sense, const sheared_ray *r, hex_path *out) {
    crossings in_out[2] = {{0}, {0}};
    out->count = 0;
    for (int c = 0; c < HEX_CORNERS; c++) {
        double q[3];
        sheared_ray_place(r, h->p[c], q);
        for (int a = 0; a < 3; a++)
            out->q[a][c] = q[a];
    }
    for (int face = 0; face < HEX_FACES; face++)
        cross_face(h, out, face, (sense < 0 ? -1 : 1) * r->sense, in_out);
    /* The signs of all faces add up to 0: as many go in as come out. */
    for (int i = 0; i < in_out[0].count && i < in_out[1].count && i < HEX_PARTS; i++) {
        const hex_end *in = &in_out[0].end[i], *to = &in_out[1].end[i];
        const bool back = sense == 0 && to->t < in->t; /* which is which means nothing there */
        out->part[out->count++] = back ? (hex_part){{*to, *in}} : (hex_part){{*in, *to}};
    }
    return out->count;
}

void hex_part_walk(const hex_part *part, hex_look *look, void *ctx) {
    struct {
        hex_end end;
        int depth;
    } ahead[HEX_DEPTH + 1];
    hex_end here = part->end[0];
    int count = 1;
    ahead[0].end = part->end[1];
    ahead[0].depth = 0;
    while (count > 0) {
        const int depth = ahead[count - 1].depth;
        hex_end middle;
        if (look(ctx, &here, &ahead[count - 1].end, depth, &middle) && depth < HEX_DEPTH) {
            ahead[count - 1].depth = depth + 1;
            ahead[count].end = middle;
            ahead[count++].depth = depth + 1;
        } else {
            here = ahead[--count].end;
        }
    }
}
