#include "render/experiments/hex_march.h"

#include <math.h>

#include "formats/base/vec3.h"
#include "render/experiments/hex_exit.h"

enum {
    STEPS = 16
}; /* of a ray in a zone, times the nodes along its three axes: no march ends so */

static hex_exit *const EXITS[HEX_WAYS] = {hex_exit_pluecker, hex_exit_hybrid};

/* A ray in a cell. */
typedef struct place {
    const hex_marcher *m;
    const sheared_ray *r;
    const hex_zone *zone;
    uint32_t at[3];
    uint32_t node, corner[HEX_CORNERS]; /* corner 0 of the cell; the corners from there */
    hex_view view;
} place;

/* ---- crossings ---- */

static void see_corner(place *p, int corner) {
    const float *x = p->m->lattice->node[p->node + p->corner[corner]];
    sheared_ray_place(p->r, (double[3]){x[0], x[1], x[2]}, p->view.q[corner]);
}

/* What follows from the point on a face. */
static void cross(const place *p, int face, hex_crossing *c) {
    int corner[4];
    (void)hexahedron_face(face, corner);
    c->value = 0.0;
    for (int i = 0; i < 4; i++) {
        c->node[i] = p->node + p->corner[corner[i]];
        c->value += c->point.weight[i] * p->m->lattice->node[c->node[i]][3];
    }
}

/* ---- steps ---- */

/* Begin at a boundary face. Where the patch there is not crossed, its triangle has to do. */
static void enter(place *p, const hex_entry *e, hex_crossing *from) {
    uint32_t stride[3];
    int corner[4];
    const double *q[4];
    p->zone = &p->m->lattice->zone[e->face->zone];
    hex_lattice_strides(p->zone, stride);
    for (int a = 0; a < 3; a++)
        p->at[a] = e->face->at[a];
    p->node = hex_lattice_node(p->zone, p->at);
    p->view.sense = p->zone->sense * p->r->sense;
    p->view.entry = e->face->face;
    for (int c = 0; c < HEX_CORNERS; c++) {
        p->corner[c] = hex_lattice_corner(stride, 0, c);
        see_corner(p, c);
    }
    (void)hexahedron_face(e->face->face, corner);
    for (int i = 0; i < 4; i++)
        q[i] = p->view.q[corner[i]];
    if (p->m->way != HEX_HYBRID || hex_exit_patch(q, -INFINITY, &from->point) == HEX_OFF)
        from->point = e->point;
    cross(p, e->face->face, from);
    p->view.t = from->point.t;
}

/* Go over a face into the cell beyond: four corners are seen already. False: there is none. */
static bool step(place *p, int face, double t) {
    const int bit = 1 << face / 2;
    if (!hex_lattice_beyond(p->m->lattice, p->zone, p->at, face))
        return false;
    p->node = hex_lattice_node(p->zone, p->at);
    p->view.entry = face ^ 1;
    p->view.t = t;
    for (int c = 0; c < HEX_CORNERS; c++) {
        if (((c & bit) != 0) != (face % 2 != 0))
            continue; /* c was on the face, and is opposite of it now */
        for (int a = 0; a < 3; a++)
            p->view.q[c ^ bit][a] = p->view.q[c][a];
        see_corner(p, c);
    }
    return true;
}

typedef enum ending { LEFT, STOPPED, LOST } ending;

/* Behind which t the ray may enter again, where it left at t. Zones that touch share a face, but
 * the patch and the triangles on it differ: so it may be before t, by what the face is deep, and by
 * rounding. */
static double behind(const place *p, int face, double entered, double t) {
    int corner[4];
    double nearest = t;
    (void)hexahedron_face(face, corner);
    for (int i = 0; i < 4; i++)
        nearest = real_min(nearest, p->view.q[corner[i]][2]);
    return real_max(nearest - 1e-9 * fabs(t), 0.5 * (entered + t));
}

/* Where the ray leaves the grid it must be known where. */
static bool place_exit(place *p, hex_crossing *to) {
    p->view.placed = true;
    return EXITS[p->m->way](&p->view, &to->point) >= 0;
}

/* Through one zone, from where the ray enters it. *t: behind which it may enter again. */
static ending march(place *p, const hex_entry *e, hex_look *look, void *ctx, hex_tally *tally,
                    double *t) {
    hex_exit *const exit = EXITS[p->m->way];
    hex_crossing from, to = {0};
    enter(p, e, &from);
    const double entered = from.point.t;
    const uint32_t *n = p->zone->nodes;
    p->view.placed = look != NULL;
    for (uint64_t left = STEPS * ((uint64_t)n[0] + n[1] + n[2]); left > 0; left--) {
        const uint32_t cell = hex_lattice_cell(p->zone, p->at);
        const int face = exit(&p->view, &to.point);
        tally->cells++;
        if (face < 0)
            return LOST;
        if (look) {
            cross(p, face, &to);
            if (!look(ctx, cell, &from, &to))
                return STOPPED;
            from = to;
        }
        if (step(p, face, to.point.t))
            continue;
        if (!look && !place_exit(p, &to))
            return LOST;
        *t = behind(p, face, entered, to.point.t);
        return LEFT;
    }
    return LOST;
}

void hex_march(const hex_marcher *m, const double o[3], const double d[3], hex_look *look,
               void *ctx, hex_tally *tally) {
    const sheared_ray r = sheared_ray_of(o, d);
    place p = {.m = m, .r = &r};
    double t = 0.0;
    hex_entry e;
    ending end = LEFT;
    while (end == LEFT && hex_boundary_next(m->boundary, &r, o, d, t, &e)) {
        tally->entries++;
        end = march(&p, &e, look, ctx, tally, &t);
        t = real_max(t, e.point.t); /* so that there is an end */
    }
    tally->lost += end == LOST;
    tally->tests += p.view.tests;
    tally->patches += p.view.patches;
}

/* ---- what is drawn ---- */

static void normal_at(const hex_lattice *l, const hex_crossing *c, double share, double sum[3]) {
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            sum[a] += share * c->point.weight[i] * l->normal[c->node[i]][a];
}

bool hex_surface_look(void *surface, uint32_t cell, const hex_crossing *from,
                      const hex_crossing *to) {
    hex_surface *s = surface;
    const double before = from->value - s->isovalue, after = to->value - s->isovalue;
    if (before < 0.0 ? !(after >= 0.0) : !(before > 0.0 ? after <= 0.0 : before == 0.0))
        return true;
    const double share = before == 0.0 ? 0.0 : before / (before - after);
    double normal[3] = {0.0};
    s->found = true;
    s->cell = cell;
    s->t = from->point.t + share * (to->point.t - from->point.t);
    normal_at(s->lattice, from, 1.0 - share, normal);
    normal_at(s->lattice, to, share, normal);
    for (int a = 0; a < 3; a++)
        s->normal[a] = 0.0;
    (void)vec3_unit(normal, s->normal);
    return false;
}

bool hex_fog_look(void *fog, uint32_t cell, const hex_crossing *from, const hex_crossing *to) {
    (void)cell;
    (void)from;
    hex_fog *f = fog;
    const double colour = (to->value - f->low) * f->rise, left = 1.0 - f->alpha,
                 alpha = colour * f->opacity;
    f->colour += left * colour * alpha;
    f->alpha += left * alpha;
    return f->alpha < 0.999;
}

bool hex_maximum_look(void *maximum, uint32_t cell, const hex_crossing *from,
                      const hex_crossing *to) {
    (void)cell;
    hex_maximum *m = maximum;
    m->value = real_max(m->value, real_max(from->value, to->value));
    return true;
}
