#include "stream/grid_resident.h"

#include <string.h>

#include "formats/leaf/deviation.h"
#include "formats/leaf/leaf_between.h"
#include "formats/leaf/leaf_geometry.h"

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

/* The payloads of the file that stores them which make up treelet t of a set. Returns how many. */
static int stored_payloads(const leaf_file *f, uint32_t set, uint32_t t,
                           uint32_t of[LEAF_BETWEEN_PARTS]) {
    of[0] = leaf_layout_samples(&f->layout, set, t);
    if (!f->below)
        return 1;
    const leaf_blend needs = leaf_between_needs(f, of[0]);
    memcpy(of, needs.of, sizeof needs.of);
    return of[1] == LEAF_NO_TREELET ? 1 : 2;
}

/* The bytes of payload p, a treelet's. own_family: count those of what its siblings share, too. */
static uint64_t stored_bytes(const leaf_file *f, uint32_t p, bool own_family) {
    const leaf_layout *l = &f->layout;
    const uint32_t t = p % l->treelets;
    const uint64_t own = leaf_file_stored(f, p);
    if (leaf_file_is_outside(f, p))
        return leaf_file_bytes_outside(f, p);
    if (!l->shells || t == 0 || !own || !own_family)
        return own;
    return own +
           leaf_file_stored(f, leaf_layout_shell(l, p / l->treelets, leaf_layout_parent(l, t)));
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    const leaf_file *f = leaf_file_stores(s->file);
    uint32_t of[LEAF_BETWEEN_PARTS];
    const uint32_t parent =
        f->layout.shells && t > 0 ? leaf_layout_parent(&f->layout, t) : LEAF_NO_TREELET;
    uint64_t bytes = 0;
    for (int i = stored_payloads(s->file, set, t, of); i-- > 0;)
        bytes += stored_bytes(f, of[i], *family != parent);
    *family = bytes > 0 ? parent : *family;
    return bytes;
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    const leaf_file *f = leaf_file_stores(s->file);
    const leaf_layout *l = &f->layout;
    uint32_t of[LEAF_BETWEEN_PARTS], parts[LEAF_PARTS_MAX];
    int count = 0;
    for (int i = stored_payloads(s->file, set, t, of); i-- > 0;)
        for (int k = f->geometry->parts(l, of[i] / l->treelets, t, parts); k-- > 0;)
            count += leaf_file_chain(f, parts[k], payloads + count);
    return (uint32_t)count;
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

static bool is_stamped(const resident_store *s, const treelet *tr, uint32_t p) {
    return resident_grid_of(tr)->stamp == s->file->checksums[p];
}

static bool same_deviations(const leaf_file *f, uint32_t t, uint32_t a, uint32_t b) {
    const leaf_layout *l = &f->layout;
    return memcmp(f->deviations + deviation_at(l, a, t), f->deviations + deviation_at(l, b, t),
                  deviation_bricks(l) * sizeof *f->deviations) == 0;
}

/* Whether a treelet has the samples of payload p, of another set. */
static bool same_samples(const resident_store *s, const treelet *tr, uint32_t p) {
    const leaf_file *f = s->file;
    if (f->live)
        return is_stamped(s, tr, p);
    if (f->below)
        return leaf_between_is_made(f, p, tr->payload);
    return leaf_file_same(f, p, payload_of(s, tr));
}

static bool same(const resident_store *s, const treelet *tr, uint32_t set) {
    const leaf_file *f = s->file;
    const uint32_t t = tr->id;
    if (!same_samples(s, tr, leaf_layout_samples(&f->layout, set, t)))
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

/* Between steps, another moment between the same two needs no reading: masks are made anew, and
 * samples before them. */
static bool keep(const resident_store *s, treelet *tr) {
    const leaf_file *f = s->file;
    if (!f->below)
        return is_stamped(s, tr, payload_of(s, tr));
    const uint32_t p = payload_of(s, tr);
    if (leaf_between_lacks(f, p, tr->payload, 0) || leaf_between_lacks(f, p, tr->payload, 1))
        return false;
    atomic_store_explicit(&tr->masked, 0, memory_order_relaxed);
    return true;
}

static bool helps(const resident_store *s, const treelet *tr, uint32_t set) {
    const uint32_t p = leaf_layout_samples(&s->file->layout, set, tr->id);
    return s->file->below ? leaf_between_helps(s->file, p, tr->payload)
                          : leaf_file_helps(s->file, p, payload_of(s, tr));
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
    if (s->file->below) /* nobody looks at the payload before its masks are there */
        leaf_between_make(s->file, payload_of(s, tr), NULL, (void *)(uintptr_t)tr->payload);
    s->compute(masks, s->file, payload_of(s, tr), tr->payload, in);
    if (resident_grid_of(tr)->wide)
        active_wide(resident_grid_of(tr)->wide, masks, s->file, payload_of(s, tr), tr->payload, in);
    active_whole(masks, s->file, payload_of(s, tr), tr->payload, &in->whole);
}

const resident_kind grid_resident = {.boxes = boxes,
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
                                     .keep = keep,
                                     .strip = strip,
                                     .destroy = destroy,
                                     .mask = mask};
