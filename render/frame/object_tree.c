#include "render/frame/object_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/box3.h"

/* Relative: what places of LEAFCAST_SCALE_UNEVEN make of a rounding, 2^20 * 2^-53 times a few, is
 * less than a hundredth of it. */
static const double slack = 0x1p-24;

/* ---- Making ---- */

/* An entry while the tree is made. */
typedef struct member {
    double box[2][3], middle[3];
    uint32_t entry;
} member;

static int order(const member *a, const member *b, int axis) {
    if (a->middle[axis] != b->middle[axis])
        return a->middle[axis] < b->middle[axis] ? -1 : 1;
    return a->entry < b->entry ? -1 : 1;
}

static int order_x(const void *a, const void *b) {
    return order(a, b, 0);
}
static int order_y(const void *a, const void *b) {
    return order(a, b, 1);
}
static int order_z(const void *a, const void *b) {
    return order(a, b, 2);
}

/* Make the node of these entries, and all below it, from node `at` on. Halves them by their
 * middles, along the axis on which these lie furthest apart. */
static void make_node(object_tree *t, uint32_t at, member *of, uint32_t count) {
    static int (*const orders[3])(const void *, const void *) = {order_x, order_y, order_z};
    object_node *n = &t->nodes[at];
    double spread[2][3];
    int axis = 0;
    *n = (object_node){.least = UINT32_MAX};
    box3_begin(n->box);
    box3_begin(spread);
    for (uint32_t i = 0; i < count; i++) {
        box3_widen(n->box, of[i].box[0], of[i].box[1]);
        box3_widen(spread, of[i].middle, of[i].middle);
        n->least = of[i].entry < n->least ? of[i].entry : n->least;
        n->most = of[i].entry > n->most ? of[i].entry : n->most;
    }
    if (count == 1) {
        t->leaf[n->least] = at;
        return;
    }
    for (int a = 1; a < 3; a++)
        if (spread[1][a] - spread[0][a] > spread[1][axis] - spread[0][axis])
            axis = a;
    qsort(of, count, sizeof *of, orders[axis]);
    const uint32_t half = count / 2;
    n->second = at + 2 * half;
    make_node(t, at + 1, of, half);
    make_node(t, at + 2 * half, of + half, count - half);
}

/* Widen a box by much more than rounding. */
static void begin_member(member *m, const double box[2][3], uint32_t entry) {
    double far = 0.0;
    m->entry = entry;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fmax(fabs(box[0][a]), fabs(box[1][a])));
    for (int a = 0; a < 3; a++) {
        m->box[0][a] = box[0][a] - slack * far;
        m->box[1][a] = box[1][a] + slack * far;
        m->middle[a] = 0.5 * box[0][a] + 0.5 * box[1][a];
    }
}

status object_tree_make(object_tree *t, mem *m, const double (*boxes)[2][3], uint32_t entries) {
    member *members = mem_array(m, entries, sizeof *members);
    *t = (object_tree){.entries = entries, .singles = entries, .objects = entries};
    t->nodes = members ? mem_array(m, 2 * (size_t)entries - 1, sizeof *t->nodes) : NULL;
    t->leaf = t->nodes ? mem_array(m, entries, sizeof *t->leaf) : NULL;
    for (uint32_t i = 0; i < entries && t->leaf; i++)
        begin_member(&members[i], boxes[i], i);
    if (t->leaf)
        make_node(t, 0, members, entries);
    mem_free(m, members);
    return t->leaf ? ST_OK : ST_NOMEM;
}

/* How many objects a group has at its places before this one. */
static uint64_t objects_before(const object_group *g, uint32_t place) {
    return g->which ? g->starts[place] : (uint64_t)place * g->members->objects;
}

/* What is at a place of a group. */
static const object_tree *members_at(const object_group *g, uint32_t place) {
    return &g->members[g->which ? g->which[place] : 0];
}

bool object_tree_count(object_tree *t, object_group *groups) {
    uint64_t count = t->singles;
    for (uint32_t i = 0; i < t->entries - t->singles && count <= OBJECTS_MOST; i++) {
        groups[i].first = (uint32_t)count;
        count += objects_before(&groups[i], groups[i].places->entries);
    }
    t->objects = count <= OBJECTS_MOST ? (uint32_t)count : 0;
    return t->objects > 0;
}

void object_tree_release(object_tree *t, mem *m) {
    mem_free(m, t->leaf);
    mem_free(m, t->nodes);
    *t = (object_tree){0};
}

/* ---- Asking ---- */

/* As fmin() and fmax(), of numbers that are none of them a NaN, without a call. */
static inline double lesser(double a, double b) {
    return a < b ? a : b;
}
static inline double greater(double a, double b) {
    return a > b ? a : b;
}

/* A ray in the world of a tree. */
typedef struct way {
    double origin[3], direction[3];
    double inverse[3]; /* of the direction, but for 0 */
} way;

/* The part of it that is of interest. */
typedef struct span {
    double t0, t1;
} span;

static way way_of(const double origin[3], const double direction[3]) {
    way w;
    for (int a = 0; a < 3; a++) {
        w.origin[a] = origin[a];
        w.direction[a] = direction[a];
        w.inverse[a] = direction[a] == 0.0 ? 0.0 : 1.0 / direction[a];
    }
    return w;
}

/* A ray as the world of a group has it, at one of its places. */
static way way_at(const way *w, const placement *p) {
    double origin[3], direction[3];
    return way_of(placement_point(p, w->origin, origin),
                  placement_vector(p, w->direction, direction));
}

/* Whether the ray meets a box: sets *at to where, within `within`. Its ends keep their order from a
 * box to one inside it. */
static bool meets(const way *w, const span *within, const double box[2][3], span *at) {
    double t0 = -INFINITY, t1 = INFINITY;
    for (int a = 0; a < 3; a++) {
        const double o = w->origin[a], d = w->direction[a];
        if (d == 0.0) {
            if (o < box[0][a] || o > box[1][a])
                return false;
            continue;
        }
        const bool up = d > 0.0;
        t0 = greater(t0, (box[!up][a] - o) * w->inverse[a]);
        t1 = lesser(t1, (box[up][a] - o) * w->inverse[a]);
    }
    t0 -= slack * fabs(t0);
    t1 += slack * fabs(t1);
    at->t0 = greater(t0, within->t0);
    at->t1 = lesser(t1, within->t1);
    return at->t0 <= at->t1;
}

/* Whether the first child of a node is likely to be entered first: a guess, for speed alone. */
static bool begins_with_first(const object_tree *t, uint32_t i, const double direction[3]) {
    const object_node *a = &t->nodes[i + 1], *b = &t->nodes[t->nodes[i].second];
    double along = 0.0;
    for (int k = 0; k < 3; k++)
        along += direction[k] * (b->box[0][k] - a->box[0][k] + b->box[1][k] - a->box[1][k]);
    return along > 0.0;
}

enum { DEPTH = 32 }; /* of a tree that halves up to 2^31 entries */

/* A tree, or the places of a group: both have boxes, and objects behind them. */
typedef struct level {
    const object_tree *boxes;
    const object_group *places; /* boxes are its places; NULL: a tree's own entries */
    uint32_t first;             /* number of its first object in the whole */
} level;

/* The number of the first object of an entry; of the one behind the last entry: of all behind. */
static uint32_t first_of(const level *l, uint32_t entry) {
    const object_tree *t = l->boxes;
    if (l->places)
        return l->first + (uint32_t)objects_before(l->places, entry);
    if (entry < t->singles)
        return l->first + entry;
    return l->first + (entry < t->entries ? t->groups[entry - t->singles].first : t->objects);
}

/* What is behind an entry that is no object. *own: the ray as that has it, if it differs; returns
 * the ray to go on with. */
static const way *enter(const level *l, uint32_t entry, const way *w, level *next, way *own) {
    const uint32_t first = first_of(l, entry);
    if (!l->places) {
        const object_group *g = &l->boxes->groups[entry - l->boxes->singles];
        *next = (level){g->places, g, first};
        return w;
    }
    *next = (level){members_at(l->places, entry), NULL, first};
    *own = way_at(w, &l->places->place[entry]);
    return own;
}

static bool is_object(const level *l, uint32_t entry) {
    return !l->places && entry < l->boxes->singles;
}

/* The search for the next entry behind another. */
typedef struct search {
    object_entry before, best;
} search;

static void take_after(search *s, double t, uint32_t object) {
    const object_entry *before = &s->before, *best = &s->best;
    const bool after = t > before->t || (t == before->t && object > before->object);
    if (after && (t < best->t || (t == best->t && object < best->object)))
        s->best = (object_entry){t, object};
}

static void search_after(const level *l, const way *w, const span *within, search *s) {
    const object_tree *t = l->boxes;
    uint32_t stack[DEPTH + 1], count = 1;
    stack[0] = 0;
    while (count > 0) {
        const uint32_t i = stack[--count];
        const object_node *n = &t->nodes[i];
        span at;
        if (!meets(w, within, n->box, &at) || at.t1 < s->before.t || at.t0 > s->best.t)
            continue;
        if (n->second) {
            const bool first = begins_with_first(t, i, w->direction);
            stack[count++] = first ? n->second : i + 1;
            stack[count++] = first ? i + 1 : n->second;
        } else if (is_object(l, n->least)) {
            take_after(s, at.t0, first_of(l, n->least));
        } else {
            level next;
            way own;
            const way *on = enter(l, n->least, w, &next, &own);
            search_after(&next, on, &at, s);
        }
    }
}

bool object_tree_after(const object_tree *t, const object_ray *r, object_entry *at) {
    const way w = way_of(r->origin, r->direction);
    search s = {*at, {INFINITY, UINT32_MAX}};
    search_after(&(level){t, NULL, 0}, &w, &(span){r->t0, r->t1}, &s);
    if (s.best.object != UINT32_MAX)
        *at = s.best;
    return s.best.object != UINT32_MAX;
}

/* The entry of a level that has an object. */
static uint32_t entry_with(const level *l, uint32_t object) {
    uint32_t low = 0, high = l->boxes->entries;
    if (l->places && !l->places->which)
        return (object - l->first) / l->places->members->objects;
    if (is_object(l, object - l->first))
        return object - l->first;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if (first_of(l, middle) <= object)
            low = middle;
        else
            high = middle;
    }
    return low;
}

object_entry object_tree_entry(const object_tree *t, const object_ray *r, uint32_t object) {
    way own[2] = {way_of(r->origin, r->direction)};
    const way *w = &own[0];
    level l = {t, NULL, 0};
    span at = {r->t0, r->t1};
    for (;;) {
        const uint32_t entry = entry_with(&l, object);
        const span within = at;
        level next;
        (void)meets(w, &within, l.boxes->nodes[l.boxes->leaf[entry]].box, &at);
        if (is_object(&l, entry))
            return (object_entry){at.t0, object};
        w = enter(&l, entry, w, &next, w == &own[0] ? &own[1] : &own[0]);
        l = next;
    }
}

/* Returns the least number from `from` on, below `best`, or `best`. */
static uint32_t search_from(const level *l, const way *w, const span *within, uint32_t from,
                            uint32_t best) {
    const object_tree *t = l->boxes;
    uint32_t stack[DEPTH + 1], count = 1;
    stack[0] = 0;
    while (count > 0) {
        const uint32_t i = stack[--count];
        const object_node *n = &t->nodes[i];
        span at;
        if (first_of(l, n->most + 1) <= from || first_of(l, n->least) >= best ||
            !meets(w, within, n->box, &at))
            continue;
        if (n->second) {
            stack[count++] = n->second;
            stack[count++] = i + 1;
        } else if (is_object(l, n->least)) {
            best = first_of(l, n->least);
        } else {
            level next;
            way own;
            const way *on = enter(l, n->least, w, &next, &own);
            best = search_from(&next, on, &at, from, best);
        }
    }
    return best;
}

uint32_t object_tree_from(const object_tree *t, const object_ray *r, uint32_t from) {
    const way w = way_of(r->origin, r->direction);
    return search_from(&(level){t, NULL, 0}, &w, &(span){r->t0, r->t1}, from, t->objects);
}

/* ---- Objects ---- */

/* The places on the way from the tree at the top to an object. */
typedef struct chain {
    const placement *of[OBJECT_DEPTH + 1];
    int count;
    uint32_t volume;
} chain;

static chain chain_to(const object_tree *t, uint32_t object) {
    level l = {t, NULL, 0};
    chain c = {.count = 0};
    for (;;) {
        const uint32_t entry = entry_with(&l, object), first = first_of(&l, entry);
        if (is_object(&l, entry)) {
            if (l.boxes->place && l.boxes->place[entry].moved)
                c.of[c.count++] = &l.boxes->place[entry];
            c.volume = l.boxes->volume + entry;
            return c;
        }
        if (l.places) {
            c.of[c.count++] = &l.places->place[entry];
            l = (level){members_at(l.places, entry), NULL, first};
        } else {
            const object_group *g = &l.boxes->groups[entry - l.boxes->singles];
            l = (level){g->places, g, first};
        }
    }
}

uint32_t object_tree_place(const object_tree *t, uint32_t object, placement *place) {
    const chain c = chain_to(t, object);
    double of[12];
    memcpy(of, c.of[c.count - 1]->space.to_world, sizeof of);
    for (int i = c.count - 2; i >= 0; i--)
        placement_follow(of, (const double *)c.of[i]->space.to_world);
    *place = placement_of(of);
    return c.volume;
}
