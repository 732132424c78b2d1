#include "render/bench/bench_dynamic_scenes.h"

#include <math.h>
#include <string.h>

#include "formats/base/portable_math.h"

static const double TURN = 6.28318530717958648;

static double sine(double angle) {
    return portable_sin(angle / TURN);
}

static double cosine(double angle) {
    return portable_cos(angle / TURN);
}

/* ---- Tubes ---- */

/* Two triangles for each piece of a tube of rings of `round` vertices, from vertex `first` on. */
static uint32_t (*tube_rows(uint32_t first, uint32_t rings, uint32_t round, uint32_t (*to)[3]))[3] {
    for (uint32_t i = 0; i + 1 < rings; i++)
        for (uint32_t k = 0; k < round; k++) {
            const uint32_t a = first + round * i + k, b = first + round * i + (k + 1) % round;
            const uint32_t two[2][3] = {{a, b, a + round}, {b, b + round, a + round}};
            memcpy(to, two, sizeof two);
            to += 2;
        }
    return to;
}

static status allocate(mem *m, dynamic_scene *s, uint32_t vertices, uint32_t triangles) {
    s->vertices = vertices;
    s->triangles = triangles;
    s->rows = mem_array(m, triangles, sizeof *s->rows);
    s->rest = mem_array(m, vertices, sizeof *s->rest);
    return s->rows && s->rest ? ST_OK : ST_NOMEM;
}

static void set(float to[3], double x, double y, double z) {
    to[0] = (float)x;
    to[1] = (float)y;
    to[2] = (float)z;
}

/* ---- The helix ---- */

/* rest: share of the length, turn around the coil, turn around the tube. */
static void bend(const dynamic_scene *s, double phase, float (*positions)[3]) {
    for (uint32_t i = 0; i < s->vertices; i++) {
        const double u = (double)s->rest[i][0], coil = (double)s->rest[i][1] * (1.0 + 0.2 * phase),
                     around = (double)s->rest[i][2];
        const double away = 1.0 + 0.22 * cosine(around), z = 5.0 * (u - 0.5) + 0.22 * sine(around),
                     lean = 1.2 * phase * z / 2.5;
        const double x = away * cosine(coil), y = away * sine(coil);
        set(positions[i], x * cosine(lean) + (z + 3.0) * sine(lean) * 0.5, y,
            z * cosine(lean) - x * sine(lean));
    }
}

static status make_helix(mem *m, dynamic_scene *s, uint32_t triangles) {
    enum { ROUND = 24, COILS = 9 };
    const uint32_t rings = triangles / (2 * ROUND) + 1;
    const status st = allocate(m, s, rings * ROUND, (rings - 1) * 2 * ROUND);
    if (st != ST_OK)
        return st;
    s->pose = bend;
    (void)tube_rows(0, rings, ROUND, s->rows);
    for (uint32_t i = 0; i < s->vertices; i++) {
        const double u = (double)(i / ROUND) / (rings - 1);
        set(s->rest[i], u, COILS * TURN * u, TURN * (i % ROUND) / ROUND);
    }
    return ST_OK;
}

/* ---- The figure ---- */

/* Where a limb hangs, how far down it goes, how thick it is, and how it swings. */
typedef struct limb {
    double at[3], length, thick, swing, bow;
} limb;

static const limb LIMBS[] = {{{0.0, 0.0, 1.0}, 1.1, 0.32, 0.0, 0.05},   /* the trunk */
                             {{0.0, 0.0, 1.5}, 0.42, 0.19, 0.05, 0.0},  /* the head */
                             {{0.0, 0.42, 0.9}, 1.0, 0.10, 0.6, 0.5},   /* arms */
                             {{0.0, -0.42, 0.9}, 1.0, 0.10, -0.6, 0.5}, /* */
                             {{0.0, 0.17, -0.1}, 1.3, 0.15, -0.5, 0.7}, /* legs */
                             {{0.0, -0.17, -0.1}, 1.3, 0.15, 0.5, 0.7}};
enum { LIMB_COUNT = sizeof LIMBS / sizeof *LIMBS };

/* Turn a point about the y axis through a joint. */
static void turn_about(double p[3], double z, double angle) {
    const double x = p[0], up = p[2] - z;
    p[0] = cosine(angle) * x + sine(angle) * up;
    p[2] = z + cosine(angle) * up - sine(angle) * x;
}

/* rest: beside the limb's joint. Both bones move a vertex; near the middle it goes by both. */
static void walk(const dynamic_scene *s, double phase, float (*positions)[3]) {
    const double beat = sine(2.25 * TURN * phase);
    for (uint32_t i = 0; i < s->vertices; i++) {
        const limb *l = &LIMBS[s->part[i]];
        const double share = -(double)s->rest[i][2] / l->length;
        const double w = fmin(fmax((share - 0.4) / 0.2, 0.0), 1.0);
        double upper[3], lower[3];
        for (int a = 0; a < 3; a++)
            upper[a] = lower[a] = (double)s->rest[i][a];
        turn_about(lower, -0.5 * l->length, l->bow * (1.0 + beat * (l->swing < 0.0 ? -1.0 : 1.0)));
        turn_about(lower, 0.0, l->swing * beat);
        turn_about(upper, 0.0, l->swing * beat);
        set(positions[i], l->at[0] + (1.0 - w) * upper[0] + w * lower[0] + 2.0 * phase,
            l->at[1] + (1.0 - w) * upper[1] + w * lower[1],
            l->at[2] + (1.0 - w) * upper[2] + w * lower[2]);
    }
}

static status make_walker(mem *m, dynamic_scene *s, uint32_t triangles) {
    enum { ROUND = 24 };
    const uint32_t rings = triangles / (LIMB_COUNT * 2 * ROUND) + 1;
    status st = allocate(m, s, LIMB_COUNT * rings * ROUND, LIMB_COUNT * (rings - 1) * 2 * ROUND);
    s->part = mem_array(m, LIMB_COUNT * rings * ROUND, sizeof *s->part);
    if (st != ST_OK || !s->part)
        return ST_NOMEM;
    uint32_t(*to)[3] = s->rows;
    s->pose = walk;
    for (uint32_t n = 0; n < LIMB_COUNT; n++) {
        const limb *l = &LIMBS[n];
        to = tube_rows(n * rings * ROUND, rings, ROUND, to);
        for (uint32_t i = 0; i < rings * ROUND; i++) {
            const double u = (double)(i / ROUND) / (rings - 1), v = TURN * (i % ROUND) / ROUND,
                         thick = l->thick * (0.02 + sqrt(fmax(4.0 * u * (1.0 - u), 0.0)));
            s->part[n * rings * ROUND + i] = (uint8_t)n;
            set(s->rest[n * rings * ROUND + i], thick * cosine(v), thick * sine(v), -l->length * u);
        }
    }
    return ST_OK;
}

/* ---- The ball that becomes others ---- */

static void morph(const dynamic_scene *s, double phase, float (*positions)[3]) {
    for (uint32_t i = 0; i < s->vertices; i++) {
        const double x = (double)s->rest[i][0], y = (double)s->rest[i][1],
                     z = (double)s->rest[i][2];
        const double cube = 0.8 / fmax(fmax(fabs(x), fabs(y)), fabs(z)),
                     star = 0.5 + 0.6 * fabs(sine(3.0 * x) * sine(3.0 * y) * sine(3.0 * z)) * 2.0;
        const double to_cube = fmax(1.0 - fabs(2.0 * phase - 0.7) / 0.7, 0.0),
                     to_star = fmax(2.0 * phase - 1.0, 0.0);
        const double r = (1.0 - to_cube - to_star) + to_cube * cube + to_star * star;
        set(positions[i], r * x, r * y, r * z);
    }
}

static void ball_points(dynamic_scene *s, uint32_t rings, uint32_t round) {
    for (uint32_t i = 0; i < rings * round; i++) {
        const double u = 0.5 * TURN * (i / round + 0.02) / (rings - 0.96),
                     v = TURN * (i % round) / round;
        set(s->rest[i], sine(u) * cosine(v), sine(u) * sine(v), cosine(u));
    }
}

static uint32_t rings_of(uint32_t triangles) {
    return (uint32_t)sqrt(triangles / 4.0) + 1;
}

static status make_morph(mem *m, dynamic_scene *s, uint32_t triangles) {
    const uint32_t rings = rings_of(triangles), round = 2 * rings;
    const status st = allocate(m, s, rings * round, (rings - 1) * 2 * round);
    if (st != ST_OK)
        return st;
    s->pose = morph;
    (void)tube_rows(0, rings, round, s->rows);
    ball_points(s, rings, round);
    return ST_OK;
}

/* ---- The explosion ---- */

static void fly(const dynamic_scene *s, double phase, float (*positions)[3]) {
    for (uint32_t i = 0; i < s->vertices; i++)
        for (int a = 0; a < 3; a++)
            positions[i][a] = (float)((double)s->rest[i][a] + phase * (double)s->aside[i / 3][a]);
}

/* From -1 to 1. */
static double at_random(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(*state >> 11) * 0x1p-52 - 1.0;
}

/* Triangles share no vertices, so that each may go its way: to a place that has nothing to do with
 * where it was. */
static status make_explosion(mem *m, dynamic_scene *s, uint32_t triangles) {
    dynamic_scene ball = {.name = NULL};
    uint64_t state = 1;
    status st = make_morph(m, &ball, triangles);
    if (st == ST_OK)
        st = allocate(m, s, 3 * ball.triangles, ball.triangles);
    s->aside = mem_array(m, ball.triangles ? ball.triangles : 1, sizeof *s->aside);
    s->pose = fly;
    for (uint32_t i = 0; st == ST_OK && s->aside && i < s->triangles; i++) {
        for (uint32_t k = 0; k < 3; k++) {
            s->rows[i][k] = 3 * i + k;
            memcpy(s->rest[3 * i + k], ball.rest[ball.rows[i][k]], sizeof *s->rest);
        }
        for (int a = 0; a < 3; a++)
            s->aside[i][a] = (float)(2.0 * at_random(&state)) - s->rest[3 * i][a];
    }
    dynamic_scene_release(m, &ball);
    return st == ST_OK && !s->aside ? ST_NOMEM : st;
}

/* ---- All ---- */

status dynamic_scene_make(mem *m, int i, bool brief, dynamic_scene *out) {
    static const struct {
        const char *name;
        status (*make)(mem *m, dynamic_scene *s, uint32_t triangles);
        uint32_t triangles, few;
    } rows[] = {{"helix", make_helix, 78000, 9600},
                {"walker", make_walker, 16000, 3000},
                {"morph", make_morph, 4300, 4300},
                {"explosion", make_explosion, 18000, 3000},
                {"helix 1M", make_helix, 1000000, 0}};
    *out = (dynamic_scene){.name = NULL};
    if (i >= (int)(sizeof rows / sizeof *rows) || (brief && !rows[i].few))
        return ST_AGAIN;
    out->name = rows[i].name;
    const status st = rows[i].make(m, out, brief ? rows[i].few : rows[i].triangles);
    if (st != ST_OK)
        dynamic_scene_release(m, out);
    return st;
}

void dynamic_scene_release(mem *m, dynamic_scene *s) {
    mem_free(m, s->aside);
    mem_free(m, s->part);
    mem_free(m, s->rest);
    mem_free(m, s->rows);
    *s = (dynamic_scene){.name = NULL};
}
