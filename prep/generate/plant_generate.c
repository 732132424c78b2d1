#include "prep/generate/plant_generate.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/out_stream.h"
#include "formats/base/portable_math.h"
#include "formats/base/vec3.h"

/* ---- Shapes ---- */

enum { LEVELS_MAX = 4 };

/* What grows on a stem of a level. Lengths are shares of the stem's; angles are turns. */
typedef struct growth {
    int rings, sides;     /* of a stem */
    int children;         /* stems of the next level, or with none leaves */
    double from, to;      /* where along it they grow */
    double length, angle; /* of a child, and how far it leans from its stem */
    double taper;         /* shorter towards the tip, by this share */
    double bend;          /* how much it bends, upwards above 0 */
} growth;

typedef struct shape_row {
    const char *name;
    double height, thick; /* metres */
    int stems;            /* out of the ground */
    double lean;          /* of these, turns */
    int levels;
    growth level[LEVELS_MAX];
    double leaf[2]; /* length and width of leaves, metres */
    uint8_t bark[3], green[3];
} shape_row;

static const shape_row shapes[] = {
    [PLANT_CONIFER] = {"conifer",
                       14.0,
                       0.22,
                       1,
                       0.0,
                       3,
                       {{12, 9, 180, 0.12, 0.98, 0.26, 0.27, 0.82, 0.0},
                        {3, 4, 7, 0.15, 0.97, 0.4, 0.12, 0.5, -0.03},
                        {1, 3, 16, 0.05, 1.0, 0.0, 0.0, 0.0, 0.0}},
                       {0.34, 0.05},
                       {92, 68, 48},
                       {38, 84, 44}},
    [PLANT_BROADLEAF] = {"broadleaf",
                         10.0,
                         0.26,
                         1,
                         0.0,
                         4,
                         {{8, 9, 16, 0.35, 1.0, 0.5, 0.13, 0.35, 0.0},
                          {5, 6, 9, 0.3, 1.0, 0.45, 0.12, 0.3, 0.05},
                          {3, 4, 6, 0.3, 1.0, 0.5, 0.12, 0.3, 0.03},
                          {2, 3, 12, 0.2, 1.0, 0.0, 0.0, 0.0, 0.0}},
                         {0.22, 0.14},
                         {104, 84, 62},
                         {74, 118, 46}},
    [PLANT_BUSH] = {"bush",
                    1.4,
                    0.03,
                    9,
                    0.11,
                    3,
                    {{4, 5, 8, 0.25, 1.0, 0.5, 0.1, 0.3, 0.06},
                     {2, 4, 5, 0.3, 1.0, 0.5, 0.12, 0.3, 0.03},
                     {1, 3, 9, 0.2, 1.0, 0.0, 0.0, 0.0, 0.0}},
                    {0.07, 0.045},
                    {110, 86, 60},
                    {96, 130, 58}},
    [PLANT_GRASS] = {"grass",
                     0.5,
                     0.0,
                     160,
                     0.07,
                     1,
                     {{5, 1, 0, 0.0, 1.0, 0.0, 0.0, 0.0, -0.14}},
                     {0.0, 0.012},
                     {120, 144, 64},
                     {120, 144, 64}},
};
enum { SHAPES = sizeof shapes / sizeof *shapes };

bool plant_shape_find(const char *name, plant_shape *shape) {
    for (int i = 0; i < SHAPES; i++)
        if (strcmp(shapes[i].name, name) == 0) {
            *shape = (plant_shape)i;
            return true;
        }
    return false;
}

const char *plant_shape_names(void) {
    return "conifer, broadleaf, bush, grass";
}

/* ---- Triangles ---- */

typedef struct growing {
    mem *m;
    const shape_row *shape;
    uint64_t state; /* of the random numbers */
    plant *of;
    size_t vertex_room, colour_room, triangle_room;
    status st;
} growing;

/* Returns an even number in [0, 1). */
static double chance(growing *g) {
    uint64_t h = g->state += UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ h >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    h = (h ^ h >> 27) * UINT64_C(0x94d049bb133111eb);
    return (double)((h ^ h >> 31) >> 11) * 0x1p-53;
}

static double around(growing *g, double value, double share) {
    return value * (1.0 + share * (2.0 * chance(g) - 1.0));
}

static uint32_t add_vertex(growing *g, const double at[3], const uint8_t rgb[3], double light) {
    plant *p = g->of;
    const uint32_t i = p->vertex_count;
    if (g->st == ST_OK)
        g->st = mem_grow(g->m, &p->vertices, sizeof *p->vertices, i, 1024, &g->vertex_room);
    if (g->st == ST_OK)
        g->st = mem_grow(g->m, &p->rgb, sizeof *p->rgb, i, 1024, &g->colour_room);
    if (g->st != ST_OK)
        return 0;
    for (int a = 0; a < 3; a++) {
        p->vertices[i][a] = (float)at[a];
        p->rgb[i][a] = (uint8_t)fmin(255.0, rgb[a] * light);
    }
    return p->vertex_count++;
}

static void add_triangle(growing *g, uint32_t a, uint32_t b, uint32_t c) {
    plant *p = g->of;
    if (g->st == ST_OK)
        g->st = mem_grow(g->m, &p->triangles, sizeof *p->triangles, p->triangle_count, 1024,
                         &g->triangle_room);
    if (g->st != ST_OK)
        return;
    uint32_t *t = p->triangles[p->triangle_count++];
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* ---- Growing ---- */

/* Where a stem is, and which way it goes: unit vectors, at right angles. */
typedef struct pose {
    double at[3], along[3], across[3];
} pose;

static void turn(double a[3], double b[3], double turns) {
    double sine, cosine;
    portable_sincos(turns, &sine, &cosine);
    for (int k = 0; k < 3; k++) {
        const double x = a[k], y = b[k];
        a[k] = cosine * x + sine * y;
        b[k] = cosine * y - sine * x;
    }
}

static void third_of(const pose *p, double third[3]) {
    for (int k = 0; k < 3; k++) {
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        third[k] = p->along[i] * p->across[j] - p->along[j] * p->across[i];
    }
}

/* Turn about the way it goes. */
static void spin(pose *p, double turns) {
    double third[3];
    third_of(p, third);
    turn(p->across, third, turns);
}

static void move(pose *p, double by) {
    for (int k = 0; k < 3; k++)
        p->at[k] += by * p->along[k];
}

/* Let the way lean upwards, or with less than 0 down. */
static void bend(pose *p, double turns) {
    double up[3], length = 0.0;
    for (int k = 0; k < 3; k++)
        up[k] = (k == 2) - p->along[2] * p->along[k];
    for (int k = 0; k < 3; k++)
        length += up[k] * up[k];
    if (!(length > 1e-6))
        return;
    for (int k = 0; k < 3; k++)
        up[k] /= sqrt(length);
    turn(p->along, up, turns);
    double along = 0.0;
    for (int k = 0; k < 3; k++)
        along += p->across[k] * p->along[k];
    for (int k = 0; k < 3; k++)
        p->across[k] -= along * p->along[k];
    double unit[3];
    if (vec3_unit(p->across, unit))
        memcpy(p->across, unit, sizeof unit);
}

/* Add a ring around a stem. Returns its first vertex; the others follow. */
static uint32_t add_ring(growing *g, const pose *p, int sides, double radius, double light) {
    uint32_t first = 0;
    for (int i = 0; i < sides; i++) {
        pose q = *p;
        double at[3];
        spin(&q, (double)i / sides);
        for (int k = 0; k < 3; k++)
            at[k] = p->at[k] + radius * q.across[k];
        const uint32_t v = add_vertex(g, at, g->shape->bark, light);
        first = i == 0 ? v : first;
    }
    return first;
}

static void join_rings(growing *g, uint32_t below, uint32_t above, int sides) {
    for (uint32_t i = 0; i < (uint32_t)sides; i++) {
        const uint32_t next = (i + 1) % (uint32_t)sides;
        add_triangle(g, below + i, below + next, above + i);
        add_triangle(g, below + next, above + next, above + i);
    }
}

/* A leaf of two triangles along its middle, or a needle of one. */
static void add_leaf(growing *g, const pose *p) {
    const shape_row *s = g->shape;
    const double light = 0.75 + 0.5 * chance(g), length = around(g, s->leaf[0], 0.25);
    double third[3], end[3], side[2][3];
    third_of(p, third);
    for (int k = 0; k < 3; k++) {
        end[k] = p->at[k] + length * p->along[k];
        for (int i = 0; i < 2; i++)
            side[i][k] = p->at[k] + 0.45 * length * p->along[k] +
                         0.5 * s->leaf[1] * ((i ? -1.0 : 1.0) * third[k] + 0.3 * p->across[k]);
    }
    const uint32_t a = add_vertex(g, p->at, s->green, 0.8 * light),
                   b = add_vertex(g, side[0], s->green, light);
    if (s->leaf[1] < 0.2 * s->leaf[0]) {
        add_triangle(g, a, b, add_vertex(g, end, s->green, light));
        return;
    }
    const uint32_t c = add_vertex(g, end, s->green, 1.1 * light),
                   d = add_vertex(g, side[1], s->green, light);
    add_triangle(g, a, b, c);
    add_triangle(g, a, c, d);
}

/* A blade is a ribbon that ends in a point. */
static void grow_blade(growing *g, pose p, double length) {
    const growth *w = &g->shape->level[0];
    const double light = 0.7 + 0.6 * chance(g);
    uint32_t below[2] = {0, 0};
    for (int i = 0; i <= w->rings; i++) {
        const double share = (double)i / w->rings, half = 0.5 * g->shape->leaf[1] * (1.0 - share);
        double at[2][3];
        for (int k = 0; k < 3; k++) {
            at[0][k] = p.at[k] - half * p.across[k];
            at[1][k] = p.at[k] + half * p.across[k];
        }
        const bool tip = i == w->rings;
        const uint32_t a = add_vertex(g, tip ? p.at : at[0], g->shape->green,
                                      light * (0.7 + share / 2)),
                       b = tip ? a
                               : add_vertex(g, at[1], g->shape->green, light * (0.7 + share / 2));
        if (i > 0)
            add_triangle(g, below[0], below[1], a);
        if (i > 0 && !tip)
            add_triangle(g, below[1], b, a);
        below[0] = a;
        below[1] = b;
        move(&p, length / w->rings);
        bend(&p, w->bend * share);
    }
}

static void grow_stem(growing *g, pose p, int level, double length, double radius);

/* Let children grow out of a stem that is this far along, up to `to`. */
static void grow_children(growing *g, const pose *p, int level, double from, double to,
                          double length, double radius, int *grown) {
    const growth *w = &g->shape->level[level];
    while (*grown < w->children) {
        const double at = w->from + (w->to - w->from) * (*grown + 0.5) / w->children;
        if (at >= to)
            return;
        pose q = *p;
        move(&q, (at - from) * length);
        spin(&q, 0.381966 * *grown + 0.03 * chance(g));
        const double left = 1.0 - w->taper * (at - w->from) / (1.0 - w->from);
        const bool leaves = level + 1 == g->shape->levels;
        turn(q.along, q.across, leaves ? around(g, 0.14, 0.4) : around(g, w->angle, 0.25));
        if (leaves)
            add_leaf(g, &q);
        else
            grow_stem(g, q, level + 1, around(g, w->length * length * left, 0.2),
                      0.55 * radius * (1.0 - 0.8 * at));
        ++*grown;
    }
}

static void grow_stem(growing *g, pose p, int level, double length, double radius) {
    const growth *w = &g->shape->level[level];
    const double light = 0.8 + 0.4 * chance(g);
    int grown = 0;
    uint32_t below = add_ring(g, &p, w->sides, radius, light);
    for (int i = 0; i < w->rings; i++) {
        const double from = (double)i / w->rings, to = (i + 1.0) / w->rings;
        grow_children(g, &p, level, from, i + 1 == w->rings ? 2.0 : to, length, radius, &grown);
        move(&p, length / w->rings);
        const uint32_t above = add_ring(g, &p, w->sides, radius * (1.0 - 0.85 * to), light);
        join_rings(g, below, above, w->sides);
        below = above;
        bend(&p, w->bend);
    }
}

static void grow_all(growing *g) {
    const shape_row *s = g->shape;
    const double root = s->thick > 0.0 ? 0.04 * s->height : 0.02 * s->height;
    for (int i = 0; i < s->stems; i++) {
        pose p = {{0.0, 0.0, -root}, {0.0, 0.0, 1.0}, {1.0, 0.0, 0.0}};
        const double far = s->stems > 1 ? 0.3 * s->height * sqrt(chance(g)) : 0.0;
        spin(&p, chance(g));
        for (int k = 0; k < 2; k++)
            p.at[k] = far * p.across[k];
        turn(p.along, p.across, s->lean * chance(g));
        const double length = around(g, s->height + root, s->stems > 1 ? 0.3 : 0.1);
        if (s->thick > 0.0)
            grow_stem(g, p, 0, length, around(g, s->thick, 0.15));
        else
            grow_blade(g, p, length);
    }
}

status plant_grow(mem *m, plant_shape shape, uint64_t seed, plant *out) {
    growing g = {.m = m, .shape = &shapes[shape], .state = seed, .of = out, .st = ST_OK};
    *out = (plant){.vertices = NULL};
    grow_all(&g);
    if (g.st != ST_OK)
        plant_release(m, out);
    return g.st;
}

void plant_release(mem *m, plant *p) {
    mem_free(m, p->triangles);
    mem_free(m, p->rgb);
    mem_free(m, p->vertices);
    *p = (plant){.vertices = NULL};
}

/* ---- Writing ---- */

static void put_little(unsigned char to[4], uint32_t word) {
    for (int i = 0; i < 4; i++)
        to[i] = (unsigned char)(word >> 8 * i);
}

static status write_vertex(out_stream *out, const plant *p, uint32_t i) {
    unsigned char bytes[15];
    for (int a = 0; a < 3; a++) {
        uint32_t word;
        memcpy(&word, &p->vertices[i][a], sizeof word);
        put_little(bytes + 4 * a, word);
    }
    memcpy(bytes + 12, p->rgb[i], 3);
    return out_stream_write(out, bytes, sizeof bytes);
}

static status write_triangle(out_stream *out, const uint32_t t[3]) {
    unsigned char bytes[13] = {3};
    for (int a = 0; a < 3; a++)
        put_little(bytes + 1 + 4 * a, t[a]);
    return out_stream_write(out, bytes, sizeof bytes);
}

static status write_all(const plant *p, const char *name, out_stream *out) {
    char head[512];
    snprintf(head, sizeof head,
             "ply\nformat binary_little_endian 1.0\ncomment a %s of leafcast\n"
             "element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face %u\n"
             "property list uchar int vertex_indices\nend_header\n",
             name, p->vertex_count, p->triangle_count);
    status st = out_stream_text(out, head);
    for (uint32_t i = 0; i < p->vertex_count && st == ST_OK; i++)
        st = write_vertex(out, p, i);
    for (uint32_t i = 0; i < p->triangle_count && st == ST_OK; i++)
        st = write_triangle(out, p->triangles[i]);
    return st;
}

status plant_generate(mem *m, plant_shape shape, uint64_t seed, const char *output, bool force,
                      uint32_t *triangles) {
    plant p;
    out_stream *out = NULL;
    status st = plant_grow(m, shape, seed, &p);
    *triangles = p.triangle_count;
    if (st == ST_OK)
        st = out_stream_create(m, output, force, false, &out);
    if (st == ST_OK)
        st = write_all(&p, shapes[shape].name, out);
    if (st == ST_OK) {
        st = out_stream_commit(out);
        out = NULL;
    }
    out_stream_discard(out);
    plant_release(m, &p);
    return st;
}
