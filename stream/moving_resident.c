#include "stream/moving_resident.h"

#include "stream/moving_surface.h"
#include "stream/triangle_resident.h"

/* What a field's treelet is at a step. Masks do not know positions: they stay. */
static void look_at(const moving_surface *s, treelet *tr, uint32_t set) {
    const leaf_layout *l = &s->file->layout;
    const moving_treelet *t = &s->treelets[tr->id];
    const uint32_t shown = set / l->steps;
    const triangle_blocks *masks = &t->at[shown];
    triangle_blocks *b = &((resident_triangles *)tr)->blocks;
    *b = t->at[leaf_layout_step(l, set)];
    b->values = s->values[shown] + t->first;
    b->active = masks->active;
    for (uint32_t level = 0; level < b->tree.levels; level++)
        b->tree.active[level] = masks->tree.active[level];
    tr->set = set;
}

static size_t nothing(const resident_store *s) {
    (void)s;
    return 0;
}

/* What the surface itself takes is counted with its volume. */
static size_t bytes(const resident_store *s, uint32_t t) {
    (void)s, (void)t;
    return sizeof(resident_triangles) + 128;
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s, (void)t;
    return 0;
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    (void)s, (void)set, (void)t, (void)family;
    return 0;
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    (void)s, (void)set, (void)t, (void)payloads;
    return 0;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    resident_triangles *tr = mem_zalloc(s->m, sizeof *tr);
    (void)shared, (void)earlier, (void)scratch, (void)read;
    if (!tr)
        return ST_NOMEM;
    *out = &tr->hexes.head;
    (*out)->id = t;
    (*out)->bytes = bytes(s, t);
    look_at(s->file->moving, *out, set);
    return ST_OK;
}

static bool same(const resident_store *s, const treelet *tr, uint32_t set) {
    return tr->set / s->file->layout.steps == set / s->file->layout.steps;
}

static void adopt(const resident_store *s, treelet *tr, uint32_t set) {
    look_at(s->file->moving, tr, set);
}

/* What changed of its set is where it points to, but for what was copied. */
static bool keep(const resident_store *s, treelet *tr) {
    look_at(s->file->moving, tr, tr->set);
    return true;
}

static void strip(const resident_store *s, treelet *tr) {
    (void)s, (void)tr;
}

static void destroy(const resident_store *s, treelet *tr) {
    mem_free(s->m, tr);
}

static void mask(const resident_store *s, treelet *tr, const interest *in) {
    (void)s;
    triangle_blocks_select(&((resident_triangles *)tr)->blocks, in);
}

const resident_kind moving_resident = {.boxes = hex_resident_boxes,
                                       .scratch = nothing,
                                       .bytes = bytes,
                                       .shared_bytes = shared_bytes,
                                       .stored = stored,
                                       .ahead = ahead,
                                       .load = load,
                                       .same = same,
                                       .adopt = adopt,
                                       .keep = keep,
                                       .strip = strip,
                                       .destroy = destroy,
                                       .mask = mask};
