#include "stream/grid_resident.h"

#include <string.h>

#include "formats/leaf/deviation.h"

/* One block holds a treelet and its masks, which begin at HEAD. */
enum { HEAD = (sizeof(resident_grid) + 63) / 64 * 64 };

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    (void)f;
    (void)set;
    return NULL;
}

static size_t scratch_bytes(const resident_store *s) {
    (void)s;
    return 0;
}

static bool deviates(const leaf_file *f, uint32_t t) {
    return f->deviations && f->layout.level_of[t] > 0;
}

static size_t masks_bytes(const leaf_file *f, uint32_t t) {
    const size_t each = active_bytes(f->layout.cells_log2 - LEAF_BLOCK_LOG2);
    return deviates(f, t) ? 2 * each : each;
}

/* The result is the same for all treelets of a level. */
static size_t most_bytes(const resident_store *s, uint32_t t) {
    return leaf_layout_payload_max(&s->file->layout) + masks_bytes(s->file, t) +
           source_overhead_bytes(s->source) + HEAD + 256;
}

/* A treelet and its masks. */
static size_t head_bytes(const resident_store *s, uint32_t t) {
    return HEAD + masks_bytes(s->file, t);
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s;
    (void)t;
    return 0;
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    const leaf_layout *l = &s->file->layout;
    const uint32_t p = leaf_layout_samples(l, set, t);
    const uint64_t own = leaf_file_stored(s->file, p);
    if (leaf_file_is_outside(s->file, p))
        return leaf_file_bytes_outside(s->file, p);
    if (!l->shells || t == 0 || !own)
        return own;
    const uint32_t parent = leaf_layout_parent(l, t);
    const bool counted = *family == parent;
    *family = parent;
    return own + (counted ? 0 : leaf_file_stored(s->file, leaf_layout_shell(l, set, parent)));
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    const leaf_layout *l = &s->file->layout;
    const int own = leaf_file_chain(s->file, leaf_layout_samples(l, set, t), payloads);
    if (!l->shells || t == 0)
        return (uint32_t)own;
    const uint32_t shell = leaf_layout_shell(l, set, leaf_layout_parent(l, t));
    return (uint32_t)(own + leaf_file_chain(s->file, shell, payloads + own));
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    const leaf_layout *layout = &s->file->layout;
    const leaf_payload shape = leaf_layout_payload(layout, t);
    const uint32_t p = leaf_layout_samples(layout, set, t);
    const size_t block = head_bytes(s, t);
    (void)shared;
    resident_grid *tr = block_runs_alloc(s->heads, block);
    if (!tr)
        return ST_NOMEM;
    memset(tr, 0, block);
    tr->head.id = t;
    tr->head.set = set;
    tr->level = layout->level_of[t];
    for (int a = 0; a < 3; a++)
        tr->first_cell[a] = layout->place[t][a] << layout->cells_log2;
    tr->shape = shape;
    tr->masks = active_init((char *)tr + HEAD, shape.node_levels);
    if (deviates(s->file, t)) {
        tr->wide =
            active_init((char *)tr + HEAD + active_bytes(shape.node_levels), shape.node_levels);
        tr->deviations = s->file->deviations + deviation_at(layout, set, t);
    }
    tr->head.bytes = block + shape.bytes + source_overhead_bytes(s->source) + 128;
    status st = earlier ? source_load_after(s->source, p, scratch->unpacker,
                                            leaf_layout_samples(layout, earlier->set, t),
                                            earlier->payload, &tr->head.payload)
                        : source_load(s->source, p, scratch->unpacker, &tr->head.payload);
    if (st != ST_OK) {
        block_runs_free(s->heads, tr, block);
        return st;
    }
    *read += s->file->sizes[p] + leaf_unpacker_take(scratch->unpacker);
    tr->samples = (const char *)tr->head.payload + shape.samples_at;
    tr->stamp = s->file->checksums[p];
    *out = &tr->head;
    return ST_OK;
}

static uint32_t payload_of(const resident_store *s, const treelet *tr) {
    return leaf_layout_samples(&s->file->layout, tr->set, tr->id);
}

/* Whether what the siblings of treelet t share is the same in two sets. */
static bool same_shell(const leaf_file *f, uint32_t t, uint32_t a, uint32_t b) {
    const leaf_layout *l = &f->layout;
    if (!l->shells || t == 0)
        return true;
    const uint32_t parent = leaf_layout_parent(l, t);
    return leaf_file_home(f, leaf_layout_shell(l, a, parent)) ==
           leaf_file_home(f, leaf_layout_shell(l, b, parent));
}

static bool same_deviations(const leaf_file *f, uint32_t t, uint32_t a, uint32_t b) {
    const leaf_layout *l = &f->layout;
    return memcmp(f->deviations + deviation_at(l, a, t), f->deviations + deviation_at(l, b, t),
                  deviation_bricks(l) * sizeof *f->deviations) == 0;
}

/* Whether a treelet has the samples of payload p, of another set. */
static bool same_samples(const resident_store *s, const treelet *tr, uint32_t set, uint32_t p) {
    const leaf_file *f = s->file;
    if (f->live)
        return resident_grid_of(tr)->stamp == f->checksums[p];
    return leaf_file_has_bytes(f, p) &&
           leaf_file_home(f, p) == leaf_file_home(f, payload_of(s, tr)) &&
           same_shell(f, tr->id, tr->set, set);
}

static bool same(const resident_store *s, const treelet *tr, uint32_t set) {
    const leaf_file *f = s->file;
    const uint32_t t = tr->id;
    if (!same_samples(s, tr, set, leaf_layout_samples(&f->layout, set, t)))
        return false;
    return !deviates(f, t) || same_deviations(f, t, tr->set, set);
}

static void adopt(const resident_store *s, treelet *tr, uint32_t set) {
    const leaf_file *f = s->file;
    if (deviates(f, tr->id))
        ((resident_grid *)tr)->deviations = f->deviations + deviation_at(&f->layout, set, tr->id);
    tr->set = set;
}

static void renumber(const resident_store *s, treelet *tr, uint32_t set, const void *payload) {
    resident_grid *grid = (resident_grid *)tr;
    adopt(s, tr, set);
    tr->payload = payload;
    grid->samples = (const char *)payload + grid->shape.samples_at;
}

static bool is_stale(const resident_store *s, const treelet *tr) {
    return resident_grid_of(tr)->stamp != s->file->checksums[payload_of(s, tr)];
}

static bool helps(const resident_store *s, const treelet *tr, uint32_t set) {
    return leaf_file_helps(s->file, leaf_layout_samples(&s->file->layout, set, tr->id),
                           payload_of(s, tr));
}

/* A resident treelet of a grid has nothing but what is its set's. */
static void strip(const resident_store *s, treelet *tr) {
    (void)s;
    (void)tr;
}

static void destroy(const resident_store *s, treelet *tr) {
    source_evict(s->source, payload_of(s, tr), tr->payload);
    block_runs_free(s->heads, tr, head_bytes(s, tr->id));
}

static void mask(const resident_store *s, treelet *tr, const interest *in) {
    active_masks *masks = resident_grid_of(tr)->masks;
    s->compute(masks, s->file, payload_of(s, tr), tr->payload, in);
    if (resident_grid_of(tr)->wide)
        active_wide(resident_grid_of(tr)->wide, masks, s->file, payload_of(s, tr), tr->payload, in);
    active_whole(masks, s->file, payload_of(s, tr), tr->payload, &in->whole);
}

const resident_kind grid_resident = {.shares = false,
                                     .boxes = boxes,
                                     .scratch = scratch_bytes,
                                     .head = head_bytes,
                                     .bytes = most_bytes,
                                     .shared_bytes = shared_bytes,
                                     .stored = stored,
                                     .ahead = ahead,
                                     .helps = helps,
                                     .load = load,
                                     .same = same,
                                     .adopt = adopt,
                                     .renumber = renumber,
                                     .is_stale = is_stale,
                                     .strip = strip,
                                     .destroy = destroy,
                                     .mask = mask};
