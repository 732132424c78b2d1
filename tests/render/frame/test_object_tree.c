/* Trees of objects, of groups in groups, against all boxes asked one after the other in long
 * double: no object is missed, few are named in vain, in the order of entering; by number, and
 * anew from any object. At any size, far from the origin, for rays along axes and from afar. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "render/frame/object_tree.h"
#include "tests/support/fields.h"
#include "tests/support/watched.h"

typedef long double real;

enum {
    SINGLES = 7,
    PLACES = 90,
    INNER = 6, /* places of a group within the first kind of what stands at PLACES */
    SMALL = 3, /* boxes of that */
    FIRST = 5, /* boxes of the first kind, */
    LONE = 1,  /* and of the second one */
    OBJECTS_ROOM = SINGLES + PLACES * (FIRST + INNER * SMALL),
    RAYS = WATCHED ? 400 : 4000
};

/* An object, as the truth has it. */
typedef struct object {
    real place[3][4]; /* of the world that its box is in, */
    real own[3][4];   /* and of its own */
    double box[2][3];
    uint32_t volume;
} object;

typedef struct wood {
    double single[SINGLES][2][3], first[FIRST][2][3], lone[LONE][2][3], small[SMALL][2][3];
    double inner[INNER][12], outer[PLACES][12], own[12]; /* where places are; that of lone boxes */
    uint16_t which[PLACES];
    uint32_t starts[PLACES + 1];
    placement inner_place[INNER], outer_place[PLACES], lone_place[LONE];
    box_tree inner_tree, outer_tree;
    object_tree small_tree, members[2], top;
    object_group inner_group, outer_group;
    object object[OBJECTS_ROOM];
    uint32_t objects;
    double size, more; /* boxes may be taken for so much larger, by rays from nearby */
} wood;

/* ---- Making ---- */

/* A box of about `edge` somewhere in a cube; flat now and then, and where another one is, too. */
static void draw_box(field_random *r, double cube, double edge, double box[2][3]) {
    for (int a = 0; a < 3; a++) {
        const double at = field_random_below(r, 8) ? field_random_in(r, -cube, cube) : 0.0;
        box[0][a] = at;
        box[1][a] = field_random_below(r, 10) ? at + edge * field_random_unit(r) : at;
    }
}

static void draw_place(field_random *r, double cube, double place[12]) {
    const double turn = field_random_in(r, 0.0, 6.3), size = field_random_in(r, 0.5, 2.0);
    const double c = size * cos(turn), s = size * sin(turn);
    const double turned[12] = {c, -s, 0.0, 0.0, s, c, 0.3 * size, 0.0, 0.0, 0.0, size, 0.0};
    memcpy(place, turned, sizeof turned);
    for (int a = 0; a < 3; a++)
        place[4 * a + 3] = field_random_in(r, -cube, cube);
}

static void follow(const real outer[3][4], const double place[12], real out[3][4]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++) {
            out[i][j] = j == 3 ? outer[i][3] : 0.0L;
            for (int k = 0; k < 3; k++)
                out[i][j] += outer[i][k] * (real)place[4 * k + j];
        }
}

static void list_boxes(wood *w, const real place[3][4], const double (*boxes)[2][3], int count,
                       const double own[12], uint32_t volume) {
    for (int i = 0; i < count; i++) {
        object *o = &w->object[w->objects++];
        memcpy(o->place, place, sizeof o->place);
        memcpy(o->own, place, sizeof o->own);
        if (own)
            follow(place, own, o->own);
        memcpy(o->box, boxes[i], sizeof o->box);
        o->volume = volume + (uint32_t)i;
    }
}

/* All objects, by their numbers. */
static void list_objects(wood *w) {
    const real own[3][4] = {
        {1.0L, 0.0L, 0.0L, 0.0L}, {0.0L, 1.0L, 0.0L, 0.0L}, {0.0L, 0.0L, 1.0L, 0.0L}};
    list_boxes(w, own, (const double(*)[2][3])w->single, SINGLES, NULL, 0);
    for (int p = 0; p < PLACES; p++) {
        real at[3][4], in[3][4];
        follow(own, w->outer[p], at);
        if (w->which[p]) {
            list_boxes(w, (const real(*)[4])at, (const double(*)[2][3])w->lone, LONE, w->own, 40);
            continue;
        }
        list_boxes(w, (const real(*)[4])at, (const double(*)[2][3])w->first, FIRST, NULL, 20);
        for (int i = 0; i < INNER; i++) {
            follow((const real(*)[4])at, w->inner[i], in);
            list_boxes(w, (const real(*)[4])in, (const double(*)[2][3])w->small, SMALL, NULL, 30);
        }
    }
}

static void make_tree(object_tree *t, mem *m, const double (*singles)[2][3], uint32_t count,
                      object_group *group, uint32_t volume) {
    double boxes[SINGLES + FIRST + 1][2][3];
    memcpy(boxes, singles, count * sizeof *boxes);
    if (group)
        memcpy(boxes[count], group->places->box, sizeof *boxes);
    assert_int_equal(object_tree_make(t, m, (const double(*)[2][3])boxes, count + !!group), ST_OK);
    t->singles = count;
    t->groups = group;
    t->volume = volume;
    assert_true(object_tree_count(t, group));
}

static void make_places(box_tree *t, mem *m, const placement *place, const uint16_t *which,
                        const object_tree *members, uint32_t count) {
    double boxes[PLACES][2][3];
    for (uint32_t i = 0; i < count; i++)
        placement_box(&place[i], members[which ? which[i] : 0].of.box, boxes[i]);
    assert_int_equal(box_tree_make(t, m, (const double(*)[2][3])boxes, count), ST_OK);
}

/* Move what lies at the outer places by `away` on each axis of its own world, and these places so
 * that they bring it back. */
static void move_far(wood *w, double away) {
    double back[3];
    for (int i = 1; i < PLACES; i++)
        for (int k = 0; k < 12; k++)
            w->outer[i][k] = k % 4 == 3 ? w->outer[i][k] : w->outer[0][k];
    for (int a = 0; a < 3; a++)
        back[a] = away * (w->outer[0][4 * a] + w->outer[0][4 * a + 1] + w->outer[0][4 * a + 2]);
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < PLACES; i++)
            w->outer[i][4 * a + 3] -= back[a];
        for (int i = 0; i < INNER; i++)
            w->inner[i][4 * a + 3] += away;
        for (int i = 0; i < 2 * FIRST; i++)
            w->first[i / 2][i % 2][a] += away;
        w->own[4 * a + 3] += away;
    }
}

/* size: of the whole; middle: of it, on each axis; away: how far it is moved and brought back. */
static void make_wood(wood *w, mem *m, uint64_t seed, double size, double middle, double away) {
    field_random r = {seed};
    memset(w, 0, sizeof *w);
    w->size = size;
    w->more = 1e-4 * size + 0x1p-21 * (fabs(middle) + 4.0 * fabs(away));
    for (int i = 0; i < FIRST; i++)
        draw_box(&r, 0.05 * size, 0.03 * size, w->first[i]);
    for (int i = 0; i < LONE; i++)
        draw_box(&r, 0.02 * size, 0.1 * size, w->lone[i]);
    for (int i = 0; i < SMALL; i++)
        draw_box(&r, 0.01 * size, 0.01 * size, w->small[i]);
    for (int i = 0; i < SINGLES; i++) /* some are small beside the tree */
        draw_box(&r, i % 2 ? 1e-4 * size : size, i % 2 ? 1e-3 * size : 0.3 * size, w->single[i]);
    draw_place(&r, 0.03 * size, w->own);
    for (int i = 0; i < INNER; i++)
        draw_place(&r, 0.05 * size, w->inner[i]);
    for (int i = 0; i < PLACES; i++) {
        draw_place(&r, size, w->outer[i]);
        for (int a = 0; a < 3; a++)
            w->outer[i][4 * a + 3] += middle;
        w->which[i] = (uint16_t)field_random_below(&r, 2);
    }
    if (away != 0.0)
        move_far(w, away);
    for (int i = 0; i < INNER; i++)
        w->inner_place[i] = placement_of(w->inner[i]);
    for (int i = 0; i < PLACES; i++)
        w->outer_place[i] = placement_of(w->outer[i]);
    for (int i = 0; i < LONE; i++) {
        double own[2][3];
        memcpy(own, w->lone[i], sizeof own);
        w->lone_place[i] = placement_of(w->own);
        placement_box(&w->lone_place[i], (const double(*)[3])own, w->lone[i]);
    }
    for (int i = 0; i < SINGLES; i++)
        for (int k = 0; k < 6; k++)
            w->single[i][k / 3][k % 3] += middle;
    make_tree(&w->small_tree, m, (const double(*)[2][3])w->small, SMALL, NULL, 30);
    make_places(&w->inner_tree, m, w->inner_place, NULL, &w->small_tree, INNER);
    w->inner_group = (object_group){
        .places = &w->inner_tree, .place = w->inner_place, .members = &w->small_tree};
    make_tree(&w->members[0], m, (const double(*)[2][3])w->first, FIRST, &w->inner_group, 20);
    make_tree(&w->members[1], m, (const double(*)[2][3])w->lone, LONE, NULL, 40);
    w->members[1].place = w->lone_place;
    for (int i = 0; i < PLACES; i++)
        w->starts[i + 1] = w->starts[i] + w->members[w->which[i]].objects;
    make_places(&w->outer_tree, m, w->outer_place, w->which, w->members, PLACES);
    w->outer_group = (object_group){.places = &w->outer_tree,
                                    .place = w->outer_place,
                                    .which = w->which,
                                    .starts = w->starts,
                                    .members = w->members};
    make_tree(&w->top, m, (const double(*)[2][3])w->single, SINGLES, &w->outer_group, 0);
    list_objects(w);
    assert_int_equal(w->top.objects, w->objects);
}

static void release_wood(wood *w, mem *m) {
    object_tree_release(&w->top, m);
    object_tree_release(&w->members[0], m);
    object_tree_release(&w->members[1], m);
    object_tree_release(&w->small_tree, m);
    box_tree_release(&w->outer_tree, m);
    box_tree_release(&w->inner_tree, m);
}

/* ---- Truth ---- */

/* A ray in an object's own world. */
static void to_own(const object *o, const double origin[3], const double direction[3], real from[3],
                   real along[3]) {
    real cofactor[3][3], d[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] =
                o->place[i1][j1] * o->place[i2][j2] - o->place[i1][j2] * o->place[i2][j1];
        }
    const real det = o->place[0][0] * cofactor[0][0] + o->place[0][1] * cofactor[0][1] +
                     o->place[0][2] * cofactor[0][2];
    for (int i = 0; i < 3; i++)
        d[i] = (real)origin[i] - o->place[i][3];
    for (int i = 0; i < 3; i++) {
        from[i] = along[i] = 0.0L;
        for (int j = 0; j < 3; j++) {
            from[i] += cofactor[j][i] / det * d[j];
            along[i] += cofactor[j][i] / det * (real)direction[j];
        }
    }
}

/* Whether a ray meets an object's box, made larger by `more`; sets *t to where it enters. */
static bool truly_meets(const object *o, const object_ray *r, double more, real *t) {
    real from[3], along[3], in = (real)r->t0, out = (real)r->t1;
    to_own(o, r->origin, r->direction, from, along);
    for (int a = 0; a < 3; a++) {
        const real lo = (real)o->box[0][a] - (real)more - from[a],
                   hi = (real)o->box[1][a] + (real)more - from[a];
        if (along[a] == 0.0L) {
            if (lo > 0.0L || hi < 0.0L)
                return false;
            continue;
        }
        in = fmaxl(in, (along[a] > 0.0L ? lo : hi) / along[a]);
        out = fminl(out, (along[a] > 0.0L ? hi : lo) / along[a]);
    }
    *t = in;
    return in <= out;
}

/* ---- Rays ---- */

typedef struct line {
    double origin[3], direction[3];
    double more; /* boxes may be taken for so much larger */
    object_ray ray;
} line;

/* To a point of an object's box, or to a corner of it: from somewhere, from afar, along an axis, or
 * nearly so. */
static void draw_line_to(const wood *w, field_random *r, const object *o, line *l) {
    const bool corner = field_random_below(r, 2) == 0;
    const long sort = field_random_below(r, 5);
    const double away =
        sort == 1 ? (field_random_below(r, 2) ? 1e7 : 1e11) * w->size : 2.0 * w->size;
    double at[3];
    for (int a = 0; a < 3; a++) {
        real x = o->place[a][3];
        for (int k = 0; k < 3; k++) {
            const double u = corner ? (double)field_random_below(r, 2) : field_random_unit(r);
            x += o->place[a][k] * (real)(o->box[0][k] + u * (o->box[1][k] - o->box[0][k]));
        }
        at[a] = (double)x;
        l->direction[a] = field_random_in(r, -1.0, 1.0);
    }
    if (sort >= 2)
        for (int a = 0; a < 3; a++)
            if (a != (int)field_random_below(r, 3))
                l->direction[a] *= sort == 2                  ? 0.0
                                   : sort == 3                ? 1e-40
                                   : field_random_below(r, 2) ? 1e-9
                                                              : 1e-312;
    if (fmax(fmax(fabs(l->direction[0]), fabs(l->direction[1])), fabs(l->direction[2])) < 1e-50)
        l->direction[1] = -1.0;
    l->more = w->more + 0x1p-40 * away;
    for (int a = 0; a < 3; a++) {
        l->origin[a] = at[a] - away * l->direction[a];
        l->direction[a] *= w->size;
    }
    l->ray = (object_ray){l->origin, l->direction, 0.0, INFINITY};
    if (field_random_below(r, 4) == 0)
        l->ray.t0 = field_random_in(r, 0.0, 3.0);
    if (field_random_below(r, 4) == 0)
        l->ray.t1 = l->ray.t0 + field_random_in(r, 0.0, 3.0);
}

/* To one of the objects; half of them are single. */
static void draw_line(const wood *w, field_random *r, line *l) {
    const bool single = field_random_below(r, 2) == 0;
    draw_line_to(w, r, &w->object[field_random_below(r, single ? SINGLES : (long)w->objects)], l);
}

/* ---- Tests ---- */

typedef struct tally {
    uint32_t met, vain, missed, wide, late;
} tally;

static int by_number(const void *a, const void *b) {
    const uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* What a ray is told: all objects in order. The list is still that of the ray before it; anew:
 * there is none. */
static uint32_t told_of(const wood *w, const line *l, bool anew, uint32_t told[OBJECTS_ROOM]) {
    static object_list list;
    uint32_t count = 0;
    for (uint32_t at = object_tree_next(&w->top, &l->ray, object_none, &list); at != object_none;
         at = object_tree_next(&w->top, &l->ray, at, &list)) {
        assert_true(count < w->objects);
        told[count++] = at;
        list.count = anew ? 0 : list.count;
    }
    return count;
}

/* Whether a ray that is cut where it enters an object is still told of it. */
static bool is_told_until(const wood *w, const line *l, uint32_t which, real t) {
    static uint32_t told[OBJECTS_ROOM];
    line until = *l;
    until.ray = (object_ray){until.origin, until.direction, l->ray.t0, (double)t};
    until.ray.t1 += (real)until.ray.t1 < t ? DBL_EPSILON * fabs(until.ray.t1) : 0.0;
    bool found = false;
    for (uint32_t i = told_of(w, &until, false, told); i > 0; i--)
        found = found || told[i - 1] == which;
    return found;
}

static void judge(const wood *w, const line *l, tally *sum) {
    static uint32_t told[OBJECTS_ROOM], other[OBJECTS_ROOM];
    static bool named[OBJECTS_ROOM];
    const uint32_t count = told_of(w, l, false, told);
    memset(named, 0, sizeof named);
    for (uint32_t i = 0; i < count; i++) {
        real t;
        assert_false(named[told[i]]); /* no object twice */
        named[told[i]] = true;
        if (!truly_meets(&w->object[told[i]], &l->ray, 0.0, &t)) {
            sum->vain++;
            sum->wide += !truly_meets(&w->object[told[i]], &l->ray, l->more, &t);
            continue;
        }
        sum->met++;
        sum->late += !is_told_until(w, l, told[i], t);
    }
    for (uint32_t i = 0; i < w->objects; i++) {
        real t;
        sum->missed += !named[i] && truly_meets(&w->object[i], &l->ray, 0.0, &t);
    }
    assert_int_equal(told_of(w, l, true, other), count);
    assert_memory_equal(told, other, count * sizeof *told);
    qsort(told, count, sizeof *told, by_number);
    uint32_t numbered = 0;
    for (uint32_t at = object_tree_from(&w->top, &l->ray, 0); at < w->objects;
         at = object_tree_from(&w->top, &l->ray, at + 1)) {
        assert_true(numbered < count);
        assert_int_equal(at, told[numbered++]);
    }
    assert_int_equal(numbered, count);
}

static void test_all_that_is_met(void **state) {
    static const struct {
        double size, at, away;
        int rays;
    } shape[] = {{1.0, 0.0, 0.0, RAYS},      {1e-60, 0.0, 0.0, RAYS}, {1e60, 0.0, 0.0, RAYS},
                 {1.0, 1e4, 0.0, RAYS},      {1.0, -1e6, 0.0, RAYS},  {1.0, 0.0, 1e6, RAYS / 2},
                 {1.0, 0.0, 1e10, RAYS / 20}};
    static wood w;
    (void)state;
    for (size_t i = 0; i < sizeof shape / sizeof *shape; i++) {
        mem m;
        tally sum = {0};
        mem_init(&m, 0);
        make_wood(&w, &m, i + 1, shape[i].size, shape[i].at * shape[i].size, shape[i].away);
        field_random r = {77};
        for (int k = 0; k < shape[i].rays; k++) {
            line l;
            draw_line(&w, &r, &l);
            judge(&w, &l, &sum);
        }
        print_message("# size %g, at %g, moved by %g: %u met, %u in vain, of these %u by far; %u "
                      "missed, %u too late\n",
                      shape[i].size, shape[i].at, shape[i].away, sum.met, sum.vain, sum.wide,
                      sum.missed, sum.late);
        assert_int_equal(sum.missed, 0);
        assert_int_equal(sum.late, 0);
        assert_int_equal(sum.wide, 0);
        assert_true(sum.met > (uint32_t)shape[i].rays / 3);
        release_wood(&w, &m);
        assert_int_equal(mem_used(&m), 0);
    }
}

/* A found surface cuts the ray: what lies behind is not named, whatever the list holds. */
static void test_cut(void **state) {
    static wood w;
    static uint32_t told[OBJECTS_ROOM], cut[OBJECTS_ROOM];
    (void)state;
    mem m;
    mem_init(&m, 0);
    make_wood(&w, &m, 9, 1.0, 0.0, 0.0);
    field_random r = {5};
    uint32_t fewer = 0;
    for (int k = 0; k < RAYS / 4; k++) {
        line l;
        object_list list = {.count = 0};
        draw_line(&w, &r, &l);
        const uint32_t all = told_of(&w, &l, false, told);
        const uint32_t first = object_tree_next(&w.top, &l.ray, object_none, &list);
        if (first == object_none)
            continue;
        l.ray.t1 = fmin(l.ray.t1, l.ray.t0 + field_random_in(&r, 0.5, 2.5));
        uint32_t count = 1;
        cut[0] = first;
        for (uint32_t at = object_tree_next(&w.top, &l.ray, first, &list); at != object_none;
             at = object_tree_next(&w.top, &l.ray, at, &list))
            cut[count++] = at;
        assert_true(count <= all);
        assert_memory_equal(cut, told, count * sizeof *cut);
        list.count = 0;
        uint32_t again = 1;
        for (uint32_t at = object_tree_next(&w.top, &l.ray, first, &list); at != object_none;
             at = object_tree_next(&w.top, &l.ray, at, &list))
            assert_int_equal(at, cut[again++]);
        assert_int_equal(again, count);
        fewer += count < all;
    }
    assert_true(fewer > RAYS / 40);
    release_wood(&w, &m);
}

/* Rays that have a list together are each told what they are told alone: from the same point, the
 * same way, and both, but not as far. */
static void test_list_of_two(void **state) {
    static wood w;
    static uint32_t told[2][OBJECTS_ROOM];
    (void)state;
    mem m;
    mem_init(&m, 0);
    make_wood(&w, &m, 4, 1.0, 0.0, 0.0);
    field_random r = {6};
    uint32_t both = 0;
    for (int k = 0; k < RAYS / 4; k++) {
        line l[2];
        object_list list = {.count = 0};
        uint32_t at[2] = {object_none, object_none}, count[2];
        draw_line(&w, &r, &l[0]);
        l[1] = l[0];
        for (int a = 0; a < 3; a++)
            (k % 3 ? l[1].origin : l[1].direction)[a] +=
                k % 3 == 1 ? 0.0 : field_random_in(&r, -1e-3, 1e-3);
        for (int i = 0; i < 2; i++)
            l[i].ray = (object_ray){l[i].origin, l[i].direction, 0.0, INFINITY};
        if (k % 3 == 1)
            l[1].ray.t1 = field_random_in(&r, 0.0, 3.0);
        for (int i = 0; i < 2; i++)
            count[i] = told_of(&w, &l[i], true, told[i]);
        for (uint32_t n = 0; n <= count[0] || n <= count[1]; n++)
            for (int i = 0; i < 2; i++)
                if (n <= count[i]) {
                    at[i] = object_tree_next(&w.top, &l[i].ray, at[i], &list);
                    assert_int_equal(at[i], n < count[i] ? told[i][n] : object_none);
                }
        both += count[0] > 1 && count[1] > 1 && told[0][0] == told[1][0];
    }
    assert_true(both > RAYS / 100);
    release_wood(&w, &m);
}

/* Where an object is, and whose volume it shows. */
static void test_places(void **state) {
    static wood w;
    (void)state;
    mem m;
    mem_init(&m, 0);
    make_wood(&w, &m, 3, 1.0, 2.0, 0.0);
    for (uint32_t i = SINGLES; i < w.objects; i++) {
        placement p;
        assert_true(object_tree_grouped(&w.top, i));
        assert_int_equal(object_tree_place(&w.top, i, &p), w.object[i].volume);
        for (int a = 0; a < 12; a++)
            assert_true(fabsl((real)p.space.to_world[a / 4][a % 4] -
                              w.object[i].own[a / 4][a % 4]) < 1e-12L);
    }
    assert_false(object_tree_grouped(&w.top, SINGLES - 1));
    release_wood(&w, &m);
}

/* Trees of any number of entries have all of them, and few nodes. */
static void test_counts(void **state) {
    (void)state;
    enum { MOST = WATCHED ? 200 : 1100 };
    static double boxes[MOST][2][3];
    field_random r = {11};
    for (int i = 0; i < MOST; i++)
        draw_box(&r, 1.0, 0.01, boxes[i]);
    for (uint32_t count = 1; count <= MOST; count += 1 + count / 40) {
        mem m;
        object_tree t;
        mem_init(&m, 0);
        assert_int_equal(object_tree_make(&t, &m, (const double(*)[2][3])boxes, count), ST_OK);
        for (uint32_t i = 0; i < count; i++) {
            const double o[3] = {boxes[i][0][0], boxes[i][0][1], -5.0}, d[3] = {0.0, 0.0, 1.0};
            const object_ray ray = {o, d, 0.0, INFINITY};
            object_list list = {.count = 0};
            uint32_t at = object_tree_next(&t, &ray, object_none, &list);
            while (at != i && at != object_none)
                at = object_tree_next(&t, &ray, at, &list);
            assert_int_equal(at, i);
        }
        assert_true(mem_used(&m) <= 4096 + 84 * (size_t)count);
        object_tree_release(&t, &m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_all_that_is_met), cmocka_unit_test(test_cut),
        cmocka_unit_test(test_list_of_two),     cmocka_unit_test(test_places),
        cmocka_unit_test(test_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
