#include "formats/mesh/mesh_polygon.h"

#include <math.h>
#include <string.h>

/* A polygon seen along an axis, so that it turns to the left, and what is left of it. */
typedef struct flat {
    size_t corners;
    double at[MESH_POLYGON_EARS][2];
    uint16_t next[MESH_POLYGON_EARS], previous[MESH_POLYGON_EARS];
} flat;

status mesh_polygon_reserve(mesh_polygon_room *r, size_t corners) {
    if (corners <= r->room)
        return ST_OK;
    mem *m = r->m;
    mesh_polygon_release(r);
    r->xyz = mem_array(m, 2 * corners, sizeof *r->xyz);
    r->cut = mem_array(m, 2 * corners, sizeof *r->cut);
    if (!r->xyz || !r->cut)
        return ST_NOMEM;
    r->room = 2 * corners;
    return ST_OK;
}

void mesh_polygon_release(mesh_polygon_room *r) {
    mem_free(r->m, r->xyz);
    mem_free(r->m, r->cut);
    *r = (mesh_polygon_room){.m = r->m};
}

static void cut_fan(mesh_polygon_room *r, size_t corners) {
    for (size_t i = 0; i + 2 < corners; i++) {
        r->cut[i][0] = 0;
        r->cut[i][1] = (uint32_t)i + 1;
        r->cut[i][2] = (uint32_t)i + 2;
    }
}

/* Newell's normal, of corners relative to the first: far from the origin nothing cancels. */
static void find_normal(const double (*xyz)[3], size_t corners, double normal[3]) {
    memset(normal, 0, 3 * sizeof *normal);
    for (size_t i = 0; i < corners; i++) {
        const double *p = xyz[i], *q = xyz[i + 1 < corners ? i + 1 : 0];
        for (int a = 0; a < 3; a++) {
            const int b = (a + 1) % 3, c = (a + 2) % 3;
            normal[a] +=
                (p[b] - xyz[0][b]) * (q[c] - xyz[0][c]) - (p[c] - xyz[0][c]) * (q[b] - xyz[0][b]);
        }
    }
}

static void flatten(const double (*xyz)[3], size_t corners, flat *f) {
    double normal[3];
    int axis = 0;
    find_normal(xyz, corners, normal);
    for (int a = 1; a < 3; a++)
        axis = fabs(normal[a]) > fabs(normal[axis]) ? a : axis;
    const bool turned = normal[axis] < 0;
    const int u = (axis + (turned ? 2 : 1)) % 3, v = (axis + (turned ? 1 : 2)) % 3;
    f->corners = corners;
    for (size_t i = 0; i < corners; i++) {
        f->at[i][0] = xyz[i][u] - xyz[0][u];
        f->at[i][1] = xyz[i][v] - xyz[0][v];
        f->next[i] = (uint16_t)(i + 1 < corners ? i + 1 : 0);
        f->previous[i] = (uint16_t)(i ? i - 1 : corners - 1);
    }
}

/* Returns twice the area of a triangle; positive: it turns to the left. */
static double turn(const flat *f, size_t a, size_t b, size_t c) {
    const double *p = f->at[a], *q = f->at[b], *r = f->at[c];
    return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
}

static double turn_at(const flat *f, size_t i) {
    return turn(f, f->previous[i], i, f->next[i]);
}

static bool is_convex(const flat *f) {
    for (size_t i = 0; i < f->corners; i++)
        if (turn_at(f, i) < 0)
            return false;
    return true;
}

static bool same_place(const flat *f, size_t a, size_t b) {
    return f->at[a][0] == f->at[b][0] && f->at[a][1] == f->at[b][1];
}

/* Whether no other corner lies in the triangle at corner i, or on its edges. */
static bool is_ear(const flat *f, size_t i) {
    const size_t a = f->previous[i], c = f->next[i];
    if (!(turn(f, a, i, c) > 0))
        return false;
    for (size_t p = f->next[c]; p != a; p = f->next[p])
        if (turn(f, a, i, p) >= 0 && turn(f, i, c, p) >= 0 && turn(f, c, a, p) >= 0 &&
            !same_place(f, p, a) && !same_place(f, p, i) && !same_place(f, p, c))
            return false;
    return true;
}

/* A polygon that crosses itself may have no ear: then the rest is cut corner by corner. */
static void cut_ears(flat *f, uint32_t (*cut)[3]) {
    size_t at = 0, count = 0;
    bool ears = true;
    for (size_t left = f->corners; left >= 3; left--) {
        size_t tried = 0;
        for (; ears && left > 3 && tried < left && !is_ear(f, at); tried++)
            at = f->next[at];
        ears = tried < left;
        const size_t a = f->previous[at], c = f->next[at];
        cut[count][0] = (uint32_t)a;
        cut[count][1] = (uint32_t)at;
        cut[count++][2] = (uint32_t)c;
        f->next[a] = (uint16_t)c;
        f->previous[c] = (uint16_t)a;
        at = c;
    }
}

bool mesh_polygon_cut(mesh_polygon_room *r, size_t corners, bool known) {
    flat f;
    cut_fan(r, corners);
    if (corners == 3)
        return true;
    if (!known || corners > MESH_POLYGON_EARS)
        return false;
    flatten((const double(*)[3])r->xyz, corners, &f);
    if (!is_convex(&f))
        cut_ears(&f, r->cut);
    return true;
}
