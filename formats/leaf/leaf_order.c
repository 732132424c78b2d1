#include "formats/leaf/leaf_order.h"

/* ---- slabs ---- */

static uint32_t at_most(uint64_t a, uint32_t b) {
    return a < b ? (uint32_t)a : b;
}

/* Slabs of a level. */
static uint32_t slabs_of(const leaf_layout *l, uint32_t level) {
    return l->level[level].treelets[2] / 2 + l->level[level].treelets[2] % 2;
}

/* How many slices of level 0 complete slab z of a level. */
static uint32_t slices_of(const leaf_layout *l, uint32_t level, uint32_t z) {
    const uint64_t reach = (((uint64_t)z + 1) << (l->cells_log2 + 1)) + l->halo;
    uint32_t last = at_most(reach, l->level[level].dims[2] - 1);
    while (level-- > 0)
        last = at_most(2 * (uint64_t)last + 2, l->level[level].dims[2] - 1);
    return last + 1;
}

/* Find the first slab of those that have not been met. */
static bool find_next(leaf_slabs *s, const leaf_layout *l) {
    bool found = false;
    for (uint32_t level = 0; level < l->levels; level++) {
        if (s->next[level] == slabs_of(l, level))
            continue;
        const uint32_t slices = slices_of(l, level, s->next[level]);
        if (found && slices >= s->at.slices)
            continue;
        s->at = (leaf_slab){level, s->next[level], slices};
        found = true;
    }
    return found;
}

leaf_slabs leaf_slabs_begin(const leaf_layout *l) {
    leaf_slabs s = {0};
    (void)find_next(&s, l); /* every level has a slab */
    return s;
}

bool leaf_slabs_next(leaf_slabs *s, const leaf_layout *l) {
    s->next[s->at.level]++;
    return find_next(s, l);
}

/* Families of a slab along x. */
static uint32_t across(const leaf_layout *l, const leaf_slab *s) {
    return l->level[s->level + 1].treelets[0];
}

static bool is_root(const leaf_layout *l, const leaf_slab *s) {
    return s->level + 1 == l->levels;
}

uint32_t leaf_slab_families(const leaf_layout *l, const leaf_slab *s) {
    return is_root(l, s) ? 1 : across(l, s) * l->level[s->level + 1].treelets[1];
}

uint32_t leaf_slab_parent(const leaf_layout *l, const leaf_slab *s, uint32_t index) {
    if (is_root(l, s))
        return LEAF_NO_TREELET;
    const uint32_t place[3] = {index % across(l, s), index / across(l, s), s->z};
    return leaf_layout_find(l, s->level + 1, place);
}

/* ---- payloads ---- */

static bool has_slabs(const leaf_layout *l) {
    return l->cells_log2 > 0;
}

static void begin_family(leaf_order *o, const leaf_layout *l) {
    o->parent = leaf_slab_parent(l, &o->slabs.at, o->family);
    o->child = o->parent == LEAF_NO_TREELET ? 0 : l->first_child[o->parent];
    o->left = o->parent == LEAF_NO_TREELET
                  ? 0
                  : (uint32_t)__builtin_popcount(leaf_layout_children(l, o->parent)) - 1;
    o->p = leaf_layout_samples(l, o->set, o->child);
}

static bool is_shell(const leaf_order *o, const leaf_layout *l) {
    return o->p >= l->sets * l->treelets;
}

leaf_order leaf_order_begin(const leaf_layout *l) {
    leaf_order o = {0};
    if (!has_slabs(l))
        return o;
    o.slabs = leaf_slabs_begin(l);
    begin_family(&o, l);
    return o;
}

static void next_family(leaf_order *o, const leaf_layout *l) {
    if (++o->family == leaf_slab_families(l, &o->slabs.at)) {
        o->family = 0;
        if (!leaf_slabs_next(&o->slabs, l)) {
            o->slabs = leaf_slabs_begin(l);
            o->set++;
        }
    }
    if (o->set < l->sets)
        begin_family(o, l);
    else
        o->p = l->payloads;
}

void leaf_order_next(leaf_order *o, const leaf_layout *l) {
    if (!has_slabs(l)) {
        o->p++;
    } else if (o->left > 0) {
        o->left--;
        o->p = leaf_layout_samples(l, o->set, ++o->child);
    } else if (l->shells && o->parent != LEAF_NO_TREELET && !is_shell(o, l)) {
        o->p = leaf_layout_shell(l, o->set, o->parent);
    } else {
        next_family(o, l);
    }
}

uint32_t leaf_order_last(const leaf_layout *l) {
    return has_slabs(l) ? leaf_layout_samples(l, l->sets - 1, 0) : l->payloads - 1;
}
