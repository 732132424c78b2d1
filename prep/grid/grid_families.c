#include "prep/grid/grid_families.h"

#include "formats/leaf/leaf_histogram.h"

typedef struct cutting {
    const grid_conversion *c;
    const slab_box *box;
    uint32_t level;
} cutting;

/* Record a treelet of which all samples are the quiet value. */
static void imply_treelet(const grid_conversion *c, leaf_family *f, uint32_t t) {
    const float value = sample_get(c->layout->type, c->quiet, 0);
    const leaf_entry entry = {.own = {value, value}};
    if (c->cells && c->layout->level_of[t] == 0)
        leaf_histogram_take_one(c->layout, &c->draw, &c->space, t, c->quiet, c->cells);
    leaf_writer_put_implied(c->writer, f, t, &entry);
}

static status make_treelet(const grid_conversion *c, const grid_bench *b, const sample_box *box,
                           uint32_t t) {
    grid_summary summary;
    if (treelet_build_quiet(c->layout, t, box)) {
        imply_treelet(c, b->family, t);
        return ST_OK;
    }
    void *payload = b->payload ? b->payload : leaf_family_room(b->family);
    treelet_build(c->layout, t, box, b->scratch, payload, &summary);
    leaf_entry entry = {.own = {summary.own[0], summary.own[1]}, .flags = summary.flags};
    if (c->cells && c->layout->level_of[t] == 0)
        leaf_histogram_take(c->layout, &c->draw, &c->space, t, payload, c->cells);
    return leaf_writer_put(c->writer, b->family, b->packer, t, &entry, payload);
}

/* Make the treelets below treelet p, and put what they share, if any of them has bytes. */
static status make_siblings(const grid_conversion *c, const grid_bench *b, const sample_box *box,
                            uint32_t p) {
    const leaf_layout *l = c->layout;
    const int siblings = __builtin_popcount(leaf_layout_children(l, p));
    status st = ST_OK;
    for (int i = 0; i < siblings && st == ST_OK; i++)
        st = make_treelet(c, b, box, l->first_child[p] + (uint32_t)i);
    if (!l->shells || st != ST_OK)
        return st;
    const bool needed = siblings > 1 && !leaf_family_is_implied(b->family);
    if (needed)
        treelet_build_shell(l, p, box, b->shell);
    return leaf_writer_put_shell(c->writer, b->family, b->packer, p, needed ? b->shell : NULL);
}

static status make_family(void *ctx, size_t index, int worker) {
    const cutting *job = ctx;
    const grid_conversion *c = job->c;
    grid_bench *b = &c->benches[worker];
    const slab_box *box = job->box;
    const uint32_t x = box->first[0] + (uint32_t)index % box->count[0];
    const uint32_t y = box->first[1] + (uint32_t)index / box->count[0];
    const leaf_slab of = {.level = job->level, .z = box->first[2]};
    const uint32_t in_slab = y * slab_families(c->layout, job->level, 0) + x;
    leaf_family_begin(b->family, c->set, &of, in_slab);
    const uint32_t parent = leaf_slab_parent(c->layout, &of, in_slab);
    status st = parent == LEAF_NO_TREELET ? make_treelet(c, b, &box->samples, 0)
                                          : make_siblings(c, b, &box->samples, parent);
    if (st == ST_OK)
        st = leaf_writer_end_family(c->writer, &b->family);
    if (st != ST_OK)
        leaf_writer_give_up(c->writer);
    return st;
}

/* Put the families of a box, some at once, as nothing can be stopped meanwhile. */
static status make_families(const grid_conversion *c, const slab_box *box, uint32_t level) {
    enum { BYTES_AT_ONCE = 64 << 20, CHILDREN = 8 };
    cutting job = {.c = c, .box = box, .level = level};
    const size_t count = (size_t)box->count[0] * box->count[1];
    const size_t most = BYTES_AT_ONCE / CHILDREN / leaf_layout_payload_max(c->layout);
    const size_t some = most > 0 ? most : 1;
    status st = ST_OK;
    for (size_t at = 0; at < count && st == ST_OK; at += some) {
        const size_t end = count - at < some ? count : at + some;
        st = progress_ask(c->p, "convert");
        if (st == ST_OK)
            st = pool_run_range(c->workers, at, end, make_family, &job);
    }
    return st;
}

status grid_families_take(grid_conversion *c, uint32_t level) {
    slab *s = c->stages[level].slab;
    for (uint32_t i = 0; i < slab_boxes(s); i++) {
        status st = progress_step(c->p, "convert", grid_conversion_share(c));
        slab_box box;
        if (st == ST_OK)
            st = slab_take(s, i, &box);
        if (st != ST_OK)
            return st;
        st = make_families(c, &box, level);
        if (st != ST_OK)
            return st;
    }
    slab_next(s);
    return ST_OK;
}
