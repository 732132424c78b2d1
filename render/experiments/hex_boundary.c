#include "render/experiments/hex_boundary.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { PLANES = 16, DEPTH = 20, FEW = 4, LEAF_AXIS = 3 };

/* Costs of a step and of a triangle, by the surface area heuristic. */
static const double STEP = 1.0, TRIANGLE = 4.0;

typedef struct hex_boundary_node {
    double plane;
    uint32_t axis;         /* LEAF_AXIS: a leaf */
    uint32_t first, count; /* a leaf's triangles; else the children: the next node, and `first` */
} hex_boundary_node;

/* ---- faces ---- */

static status add_face(hex_boundary *b, uint32_t zone, const uint32_t at[3], int face) {
    const hex_zone *z = &b->lattice->zone[zone];
    const status st = mem_grow(b->m, &b->face, sizeof *b->face, b->faces, 1024, &b->faces_room);
    if (st != ST_OK)
        return st;
    hex_boundary_face *f = &b->face[b->faces++];
    *f = (hex_boundary_face){.zone = zone, .at = {at[0], at[1], at[2]}, .face = face};
    int corner[4];
    uint32_t stride[3];
    hex_lattice_strides(z, stride);
    (void)hexahedron_face(face, corner);
    for (int i = 0; i < 4; i++)
        f->node[i] = hex_lattice_corner(stride, hex_lattice_node(z, at), corner[i]);
    return ST_OK;
}

static status add_cell(hex_boundary *b, uint32_t zone, const uint32_t at[3]) {
    const hex_zone *z = &b->lattice->zone[zone];
    status st = ST_OK;
    if (!b->lattice->there[hex_lattice_cell(z, at)])
        return ST_OK;
    for (int face = 0; face < HEX_FACES && st == ST_OK; face++) {
        uint32_t beyond[3] = {at[0], at[1], at[2]};
        if (!hex_lattice_beyond(b->lattice, z, beyond, face))
            st = add_face(b, zone, at, face);
    }
    return st;
}

static status add_zone(hex_boundary *b, uint32_t zone) {
    const hex_zone *z = &b->lattice->zone[zone];
    status st = ST_OK;
    uint32_t at[3];
    for (at[2] = 0; at[2] + 1 < z->nodes[2] && st == ST_OK; at[2]++)
        for (at[1] = 0; at[1] + 1 < z->nodes[1] && st == ST_OK; at[1]++)
            for (at[0] = 0; at[0] + 1 < z->nodes[0] && st == ST_OK; at[0]++)
                st = add_cell(b, zone, at);
    return st;
}

/* The corners of triangle i among its face's, the shared edge's first and last (hex_exit.h). */
static const int TRIANGLE_CORNERS[2][3] = {{0, 1, 3}, {0, 2, 3}};

static void extent_of(const hex_boundary *b, uint32_t i, double box[2][3]) {
    const hex_boundary_face *f = &b->face[i / 2];
    for (int a = 0; a < 3; a++) {
        box[0][a] = INFINITY;
        box[1][a] = -INFINITY;
        for (int c = 0; c < 3; c++) {
            const double x = b->lattice->node[f->node[TRIANGLE_CORNERS[i % 2][c]]][a];
            box[0][a] = real_min(box[0][a], x);
            box[1][a] = real_max(box[1][a], x);
        }
    }
}

/* ---- the tree ---- */

typedef struct cut {
    int axis;
    double plane, cost;
} cut;

static double area_of(double box[2][3]) {
    double e[3];
    vec3_sub(box[1], box[0], e);
    return e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
}

/* Whether a triangle is below a plane, whether above it: at least one of them. */
static void sides_of(double box[2][3], int axis, double plane, bool side[2]) {
    side[1] = box[1][axis] > plane;
    side[0] = box[0][axis] < plane || !side[1];
}

/* The plane of an axis that costs least, by the triangles that begin and end between planes. */
static void try_axis(const hex_boundary *b, const uint32_t *ids, uint32_t count, double box[2][3],
                     int axis, cut *best) {
    const double width = (box[1][axis] - box[0][axis]) / PLANES, whole = area_of(box);
    uint32_t begins[PLANES] = {0}, ends[PLANES] = {0}, below = 0, above = count;
    for (uint32_t i = 0; i < count && width > 0.0; i++) {
        double own[2][3];
        extent_of(b, ids[i], own);
        const double lo = (own[0][axis] - box[0][axis]) / width,
                     hi = (own[1][axis] - box[0][axis]) / width;
        begins[(int)real_min(real_max(lo, 0.0), PLANES - 1)]++;
        ends[(int)real_min(real_max(hi, 0.0), PLANES - 1)]++;
    }
    for (int k = 1; k < PLANES && width > 0.0; k++) {
        double part[2][2][3];
        memcpy(part[0], box, sizeof part[0]);
        memcpy(part[1], box, sizeof part[1]);
        below += begins[k - 1];
        above -= ends[k - 1];
        part[0][1][axis] = part[1][0][axis] = box[0][axis] + k * width;
        const double cost =
            STEP + TRIANGLE * (area_of(part[0]) * below + area_of(part[1]) * above) / whole;
        if (cost < best->cost)
            *best = (cut){axis, part[0][1][axis], cost};
    }
}

static status add_leaf(hex_boundary *b, hex_boundary_node *node, const uint32_t *ids,
                       uint32_t count) {
    *node = (hex_boundary_node){.axis = LEAF_AXIS, .first = (uint32_t)b->triangles, .count = count};
    for (uint32_t i = 0; i < count; i++) {
        const status st = mem_grow(b->m, &b->triangle, sizeof *b->triangle, b->triangles, 1024,
                                   &b->triangles_room);
        if (st != ST_OK)
            return st;
        b->triangle[b->triangles++] = ids[i];
    }
    return ST_OK;
}

static status build(hex_boundary *b, const uint32_t *ids, uint32_t count, double box[2][3],
                    int depth);

/* The triangles on a side of the cut, as a tree of their own. */
static status build_side(hex_boundary *b, const uint32_t *ids, uint32_t count, double box[2][3],
                         const cut *at, int which, int depth) {
    uint32_t *own = mem_array(b->m, (size_t)count + 1, sizeof *own), kept = 0;
    double part[2][3];
    if (!own)
        return ST_NOMEM;
    memcpy(part, box, sizeof part);
    part[1 - which][at->axis] = at->plane;
    for (uint32_t i = 0; i < count; i++) {
        double extent[2][3];
        bool side[2];
        extent_of(b, ids[i], extent);
        sides_of(extent, at->axis, at->plane, side);
        if (side[which])
            own[kept++] = ids[i];
    }
    const status st = build(b, own, kept, part, depth + 1);
    mem_free(b->m, own);
    return st;
}

static status build(hex_boundary *b, const uint32_t *ids, uint32_t count, double box[2][3],
                    int depth) {
    cut best = {.axis = LEAF_AXIS, .cost = TRIANGLE * count};
    status st = mem_grow(b->m, &b->node, sizeof *b->node, b->nodes, 1024, &b->nodes_room);
    if (st != ST_OK)
        return st;
    const size_t own = b->nodes++;
    for (int a = 0; a < 3 && count > FEW && depth < DEPTH; a++)
        try_axis(b, ids, count, box, a, &best);
    if (best.axis == LEAF_AXIS)
        return add_leaf(b, &b->node[own], ids, count);
    b->node[own] = (hex_boundary_node){.plane = best.plane, .axis = (uint32_t)best.axis};
    st = build_side(b, ids, count, box, &best, 0, depth);
    b->node[own].first = (uint32_t)b->nodes;
    return st == ST_OK ? build_side(b, ids, count, box, &best, 1, depth) : st;
}

static status build_all(hex_boundary *b) {
    const uint32_t count = 2 * (uint32_t)b->faces;
    uint32_t *ids = mem_array(b->m, (size_t)count + 1, sizeof *ids);
    if (!ids)
        return ST_NOMEM;
    double box[2][3] = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
    for (uint32_t i = 0; i < count; i++) {
        double own[2][3];
        extent_of(b, i, own);
        for (int a = 0; a < 3; a++) {
            box[0][a] = real_min(box[0][a], own[0][a]);
            box[1][a] = real_max(box[1][a], own[1][a]);
        }
        ids[i] = i;
    }
    memcpy(b->box, box, sizeof box);
    const status st = build(b, ids, count, box, 0);
    mem_free(b->m, ids);
    return st;
}

status hex_boundary_make(hex_boundary *b, mem *m, const hex_lattice *l) {
    *b = (hex_boundary){.m = m, .lattice = l};
    status st = ST_OK;
    for (uint32_t z = 0; z < l->zones && st == ST_OK; z++)
        st = add_zone(b, z);
    if (st == ST_OK && b->faces > UINT32_MAX / 4)
        st = status_describe(ST_UNSUPPORTED, "a boundary of too many faces");
    return st == ST_OK ? build_all(b) : st;
}

void hex_boundary_free(hex_boundary *b) {
    mem_free(b->m, b->face);
    mem_free(b->m, b->node);
    mem_free(b->m, b->triangle);
}

/* ---- rays ---- */

typedef struct search {
    const hex_boundary *b;
    const sheared_ray *r;
    double after;
    hex_entry *best;
} search;

/* A triangle that the ray enters by turns around it the other way than one that it leaves by. */
static void try_triangle(const search *s, uint32_t i) {
    const hex_boundary_face *f = &s->b->face[i / 2];
    const int *corner = TRIANGLE_CORNERS[i % 2];
    double q[3][3], turn[3], sum = 0.0, t = 0.0;
    int unused[4];
    const int sense = s->b->lattice->zone[f->zone].sense * s->r->sense *
                      hexahedron_face(f->face, unused) * (i % 2 ? 1 : -1);
    for (int c = 0; c < 3; c++) {
        const float *x = s->b->lattice->node[f->node[corner[c]]];
        sheared_ray_place(s->r, (double[3]){x[0], x[1], x[2]}, q[c]);
    }
    for (int c = 0; c < 3; c++) {
        const double *p = q[(c + 1) % 3], *n = q[(c + 2) % 3];
        turn[c] = sense * (p[0] * n[1] - p[1] * n[0]);
        if (turn[c] < 0.0)
            return;
        sum += turn[c];
        t += turn[c] * q[c][2];
    }
    t /= sum;
    if (!(t > s->after && t < s->best->point.t))
        return;
    *s->best = (hex_entry){.face = f, .point.t = t};
    for (int c = 0; c < 3; c++)
        s->best->point.weight[corner[c]] = turn[c] / sum;
}

typedef struct stretch {
    uint32_t node;
    double from, to;
} stretch;

typedef struct line {
    double o[3], inverse[3]; /* of the direction; INFINITY across an axis */
    bool down[3];
} line;

static line line_of(const double o[3], const double d[3]) {
    line l;
    for (int a = 0; a < 3; a++) {
        l.o[a] = o[a];
        l.inverse[a] = d[a] == 0.0 ? INFINITY : 1.0 / d[a];
        l.down[a] = d[a] < 0.0;
    }
    return l;
}

/* The part of the line in the box, a little longer for rounding. */
static bool clip(const hex_boundary *b, const line *l, stretch *s) {
    *s = (stretch){0, -INFINITY, INFINITY};
    for (int a = 0; a < 3; a++) {
        const double lo = b->box[0][a] - l->o[a], hi = b->box[1][a] - l->o[a];
        if (l->inverse[a] == INFINITY && (lo > 0.0 || hi < 0.0))
            return false;
        if (l->inverse[a] == INFINITY)
            continue;
        const double x = lo * l->inverse[a], y = hi * l->inverse[a];
        s->from = real_max(s->from, real_min(x, y));
        s->to = real_min(s->to, real_max(x, y));
    }
    const double slack = 1e-9 * (fabs(s->from) + fabs(s->to));
    s->from -= slack;
    s->to += slack;
    return s->from <= s->to;
}

/* Go into the child that comes first, and keep the other one for later where the ray comes there.
 */
static void descend(const hex_boundary_node *n, const line *l, stretch *now, stretch *later,
                    int *count) {
    const double way = n->plane - l->o[n->axis];
    const uint32_t child[2] = {now->node + 1, n->first};
    const bool along = l->inverse[n->axis] == INFINITY;
    const int first = along ? way <= 0.0 : l->down[n->axis];
    const double t = along ? INFINITY : way * l->inverse[n->axis],
                 slack = 1e-9 * (fabs(now->from) + fabs(now->to));
    now->node = child[t < now->from - slack ? !first : first];
    if (t >= now->from - slack && t <= now->to + slack) {
        later[(*count)++] = (stretch){child[!first], real_max(t - slack, now->from), now->to};
        now->to = real_min(t + slack, now->to);
    }
}

bool hex_boundary_next(const hex_boundary *b, const sheared_ray *r, const double o[3],
                       const double d[3], double t, hex_entry *out) {
    stretch later[DEPTH + 1], now;
    const line l = line_of(o, d);
    *out = (hex_entry){.point.t = INFINITY};
    const search s = {b, r, t, out};
    if (b->faces == 0 || !clip(b, &l, &later[0]))
        return false;
    later[0].from = real_max(later[0].from, t - 1e-9 * fabs(t));
    for (int count = 1; count > 0;) {
        now = later[--count];
        if (now.from > now.to || now.from > out->point.t)
            continue;
        const hex_boundary_node *n = &b->node[now.node];
        for (; n->axis != LEAF_AXIS; n = &b->node[now.node])
            descend(n, &l, &now, later, &count);
        for (uint32_t i = 0; i < n->count; i++)
            try_triangle(&s, b->triangle[n->first + i]);
    }
    return out->face != NULL;
}
