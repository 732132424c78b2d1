#include "render/frame/object_tree.h"

#include <math.h>
#include <string.h>

/* ---- Making ---- */

status object_tree_make(object_tree *t, mem *m, const double (*boxes)[2][3], uint32_t entries) {
    *t = (object_tree){.singles = entries, .objects = entries};
    return box_tree_make(&t->of, m, boxes, entries);
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
    for (uint32_t i = 0; i < t->of.entries - t->singles && count <= OBJECTS_MOST; i++) {
        groups[i].first = (uint32_t)count;
        count += objects_before(&groups[i], groups[i].places->entries);
    }
    t->objects = count <= OBJECTS_MOST ? (uint32_t)count : 0;
    return t->objects > 0;
}

void object_tree_release(object_tree *t, mem *m) {
    box_tree_release(&t->of, m);
    *t = (object_tree){.objects = 0};
}

/* ---- Levels ---- */

/* A tree, or the places of a group: both have boxes, and objects behind them. */
typedef struct level {
    const box_tree *boxes;
    const object_tree *tree;    /* whose entries they are; NULL: they are */
    const object_group *places; /* those of this group */
    uint32_t first;             /* number of its first object in the whole */
} level;

static level level_of(const object_tree *t, uint32_t first) {
    return (level){&t->of, t, NULL, first};
}

/* The number of the first object of an entry; of the one behind the last entry: of all behind. */
static uint32_t first_of(const level *l, uint32_t entry) {
    const object_tree *t = l->tree;
    if (!t)
        return l->first + (uint32_t)objects_before(l->places, entry);
    if (entry < t->singles)
        return l->first + entry;
    return l->first + (entry < t->of.entries ? t->groups[entry - t->singles].first : t->objects);
}

static bool is_object(const level *l, uint32_t entry) {
    return l->tree && entry < l->tree->singles;
}

/* What is behind an entry that is no object. */
static level level_behind(const level *l, uint32_t entry) {
    const uint32_t first = first_of(l, entry);
    if (!l->tree)
        return level_of(members_at(l->places, entry), first);
    const object_group *g = &l->tree->groups[entry - l->tree->singles];
    return (level){g->places, NULL, g, first};
}

/* Sets off[] to how far a way, taken to where a place has it, may pass from where a tracer has it,
 * which takes the ray there by all places at once. Wherever the tree is met, the ray has come about
 * as far as its origin is from there: so the rounding of its direction is of that size, too. */
static void set_off(const placement *p, const box_way *w, double off[3]) {
    const double uneven = p->grow / p->shrink;
    double from[3];
    for (int i = 0; i < 3; i++)
        from[i] = 0x1p-49 * (fabs(w->origin[i]) + fabs(p->space.to_world[i][3])) + w->off[i];
    for (int a = 0; a < 3; a++) {
        double sum = 0.0;
        for (int i = 0; i < 3; i++)
            sum += fabs(p->space.to_grid[a][i]) * from[i];
        off[a] = uneven * sum;
    }
}

/* Go on behind an entry. *own: the way as that has it, if it differs; returns the one to go on
 * with. */
static const box_way *enter(const level *l, uint32_t entry, const box_way *w, level *next,
                            box_way *own) {
    double origin[3], direction[3];
    *next = level_behind(l, entry);
    if (l->tree)
        return w;
    const placement *p = &l->places->place[entry];
    *own = box_way_of(placement_point(p, w->origin, origin),
                      placement_vector(p, w->direction, direction));
    set_off(p, w, own->off);
    return own;
}

/* The entry of a level that has an object. */
static uint32_t entry_with(const level *l, uint32_t object) {
    uint32_t low = 0, high = l->boxes->entries;
    if (!l->tree && !l->places->which)
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

/* ---- The next objects ---- */

static bool is_before(const object_entry *a, const object_entry *b) {
    return a->t < b->t || (a->t == b->t && a->object < b->object);
}

/* The search for what follows an entry. */
typedef struct search {
    object_entry before;
    double t1;         /* up to there, or up to where the last one of a full list is entered */
    object_list *list; /* what was found so far, in order */
} search;

/* Put an object into its place in the list, unless that is full of nearer ones. */
static void take(search *s, double t, uint32_t object) {
    object_list *l = s->list;
    const bool full = l->count == OBJECT_LIST;
    const object_entry e = {t, object};
    if (!is_before(&s->before, &e) || (full && !is_before(&e, &l->of[OBJECT_LIST - 1])))
        return;
    unsigned at = full ? OBJECT_LIST - 1 : l->count++;
    for (; at > 0 && is_before(&e, &l->of[at - 1]); at--)
        l->of[at] = l->of[at - 1];
    l->of[at] = e;
    if (l->count == OBJECT_LIST)
        s->t1 = l->of[OBJECT_LIST - 1].t;
}

/* A child that the ray meets, between two s. */
typedef struct met_child {
    uint32_t child;
    bool inner;
    float s0, s1;
} met_child;

/* Put the children of a node that the ray meets onto a stack, the nearest one last. */
static unsigned push_children(const box_tree *t, const box_ray *r, uint32_t node, float least,
                              float most, met_child *stack, unsigned count) {
    const box_node *n = &t->nodes[node];
    const unsigned bottom = count;
    float s0[BOX_WIDTH], s1[BOX_WIDTH];
    for (unsigned bits = box_ray_meets(r, n, least, most, s0, s1); bits; bits &= bits - 1) {
        const unsigned k = (unsigned)__builtin_ctz(bits);
        unsigned at = count++;
        for (; at > bottom && stack[at - 1].s0 < s0[k]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (met_child){n->child[k], n->inner >> k & 1U, s0[k], s1[k]};
    }
    return count;
}

static void search_next(const level *l, const box_way *w, const box_span *within, search *s);

/* Take an entry that the ray meets, or what is behind it. */
static void take_entry(const level *l, uint32_t entry, const box_way *w, const box_span *at,
                       search *s) {
    if (is_object(l, entry)) {
        take(s, at->t0, first_of(l, entry));
        return;
    }
    level next;
    box_way own;
    const box_way *on = enter(l, entry, w, &next, &own);
    search_next(&next, on, at, s);
}

static void search_next(const level *l, const box_way *w, const box_span *within, search *s) {
    met_child stack[BOX_STACK];
    unsigned count = 0;
    box_span at;
    box_ray r;
    if (!box_tree_enter(l->boxes, w, within, &at, &r) || at.t1 < s->before.t || at.t0 > s->t1)
        return;
    if (!l->boxes->nodes) {
        take_entry(l, 0, w, &at, s);
        return;
    }
    const float least = box_ray_least(&r, s->before.t);
    count = push_children(l->boxes, &r, 0, least, box_ray_most(&r, s->t1), stack, count);
    while (count > 0) {
        const met_child c = stack[--count];
        const float most = box_ray_most(&r, s->t1);
        if (c.s0 > most)
            continue;
        if (c.inner) {
            count = push_children(l->boxes, &r, c.child, least, most, stack, count);
            continue;
        }
        at = box_ray_span(&r, c.s0, c.s1);
        if (at.t0 <= at.t1 && at.t1 >= s->before.t && at.t0 <= s->t1)
            take_entry(l, c.child, w, &at, s);
    }
}

/* Where a ray enters the box of an object that was found on it. */
static object_entry entry_of(const object_tree *t, const object_ray *r, uint32_t object) {
    box_way own[2] = {box_way_of(r->origin, r->direction)};
    const box_way *w = &own[0];
    level l = level_of(t, 0);
    box_span at = {r->t0, INFINITY};
    for (;;) {
        const uint32_t entry = entry_with(&l, object);
        const box_span within = at;
        box_ray ray;
        (void)box_tree_enter(l.boxes, w, &within, &at, &ray);
        if (l.boxes->nodes) {
            const uint32_t leaf = l.boxes->leaf[entry], k = leaf % BOX_WIDTH;
            float s0[BOX_WIDTH], s1[BOX_WIDTH];
            (void)box_ray_meets(&ray, &l.boxes->nodes[leaf / BOX_WIDTH], -INFINITY, INFINITY, s0,
                                s1);
            at = box_ray_span(&ray, s0[k], s1[k]);
        }
        if (is_object(&l, entry))
            return (object_entry){at.t0, object};
        level next;
        w = enter(&l, entry, w, &next, w == &own[0] ? &own[1] : &own[0]);
        l = next;
    }
}

/* Whether a list is of a ray, from the same t0, and as far as that goes. */
static bool is_list_of(const object_list *list, const object_ray *r) {
    return list->count > 0 && list->t0 == r->t0 && list->t1 >= r->t1 &&
           memcmp(list->origin, r->origin, sizeof list->origin) == 0 &&
           memcmp(list->direction, r->direction, sizeof list->direction) == 0;
}

/* Find the objects behind an entry. */
static void fill_list(const object_tree *t, const object_ray *r, const object_entry *before,
                      object_list *list) {
    const box_way w = box_way_of(r->origin, r->direction);
    const level l = level_of(t, 0);
    search s = {*before, r->t1, list};
    list->count = 0;
    list->t0 = r->t0;
    list->t1 = r->t1;
    memcpy(list->origin, r->origin, sizeof list->origin);
    memcpy(list->direction, r->direction, sizeof list->direction);
    search_next(&l, &w, &(box_span){r->t0, r->t1}, &s);
}

uint32_t object_tree_next(const object_tree *t, const object_ray *r, uint32_t before,
                          object_list *list) {
    object_entry last = {-INFINITY, 0};
    unsigned at = 0;
    bool found = false;
    if (before != object_none && is_list_of(list, r))
        while (at < list->count && !found)
            found = list->of[at++].object == before;
    if (found && at == list->count && list->count < OBJECT_LIST)
        return object_none;
    if (found)
        last = list->of[at - 1];
    if (!found || at == list->count) {
        if (before != object_none && !found)
            last = entry_of(t, r, before);
        fill_list(t, r, &last, list);
        at = 0;
    }
    return at < list->count && list->of[at].t <= r->t1 ? list->of[at].object : object_none;
}

/* ---- The next number ---- */

/* Returns the least number from `from` on, below `best`, or `best`. */
static uint32_t search_from(const level *l, const box_way *w, const box_span *within, uint32_t from,
                            uint32_t best);

/* The same of an entry that the ray meets, and of what is behind it. */
static uint32_t entry_from(const level *l, uint32_t entry, const box_way *w, const box_span *at,
                           uint32_t from, uint32_t best) {
    const uint32_t first = first_of(l, entry);
    if (first_of(l, entry + 1) <= from || first >= best)
        return best;
    if (is_object(l, entry))
        return first;
    level next;
    box_way own;
    const box_way *on = enter(l, entry, w, &next, &own);
    return search_from(&next, on, at, from, best);
}

static uint32_t search_from(const level *l, const box_way *w, const box_span *within, uint32_t from,
                            uint32_t best) {
    uint32_t stack[BOX_STACK];
    unsigned count = 0;
    box_span at;
    box_ray r;
    if (first_of(l, l->boxes->entries) <= from || first_of(l, 0) >= best ||
        !box_tree_enter(l->boxes, w, within, &at, &r))
        return best;
    if (!l->boxes->nodes)
        return entry_from(l, 0, w, &at, from, best);
    const float most = box_ray_most(&r, within->t1);
    stack[count++] = 0;
    while (count > 0) {
        const box_node *n = &l->boxes->nodes[stack[--count]];
        float s0[BOX_WIDTH], s1[BOX_WIDTH];
        if (first_of(l, n->most + 1) <= from || first_of(l, n->least) >= best)
            continue;
        for (unsigned bits = box_ray_meets(&r, n, -INFINITY, most, s0, s1); bits;
             bits &= bits - 1) {
            const unsigned k = (unsigned)__builtin_ctz(bits);
            if (n->inner >> k & 1U) {
                stack[count++] = n->child[k];
                continue;
            }
            at = box_ray_span(&r, s0[k], s1[k]);
            if (at.t0 <= at.t1)
                best = entry_from(l, n->child[k], w, &at, from, best);
        }
    }
    return best;
}

uint32_t object_tree_from(const object_tree *t, const object_ray *r, uint32_t from) {
    const box_way w = box_way_of(r->origin, r->direction);
    const level l = level_of(t, 0);
    return search_from(&l, &w, &(box_span){r->t0, r->t1}, from, t->objects);
}

/* ---- Objects ---- */

/* The places on the way from the tree at the top to an object. */
typedef struct chain {
    const placement *of[OBJECT_DEPTH + 1];
    int count;
    uint32_t volume;
} chain;

static chain chain_to(const object_tree *t, uint32_t object) {
    level l = level_of(t, 0);
    chain c = {.count = 0};
    for (;;) {
        const uint32_t entry = entry_with(&l, object);
        if (is_object(&l, entry)) {
            if (l.tree->place && l.tree->place[entry].moved)
                c.of[c.count++] = &l.tree->place[entry];
            c.volume = l.tree->volume + entry;
            return c;
        }
        if (!l.tree)
            c.of[c.count++] = &l.places->place[entry];
        l = level_behind(&l, entry);
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
