#include "stream/hex_resident.h"

#include "formats/leaf/leaf_between.h"

enum { VALUES = 1, MOVED = 2 }; /* parts: behind the first; MOVED: of kinds that list corners */

static const hex_blocks *blocks_of(const resident_store *s) {
    return resident_kind_of(s->file)->hexes;
}

static int parts_of(const leaf_file *f, uint32_t set, uint32_t t, uint32_t p[LEAF_PARTS_MAX]) {
    return f->geometry->parts(&f->layout, set, t, p);
}

bool hex_resident_shares(const leaf_file *f) {
    return f->geometry->noded->listed || !leaf_layout_moves(&f->layout);
}

const treelet_bounds *hex_resident_boxes(const leaf_file *f, uint32_t set) {
    const treelet_bounds *all = f->geometry->section(f, LEAF_SECTION_BOUNDS);
    return all + leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

/* ---- sizes ---- */

size_t hex_resident_scratch(const resident_store *s) {
    (void)s;
    return 0;
}

static size_t part_bytes(const resident_store *s, uint32_t p) {
    return leaf_layout_payload_bytes(&s->file->layout, p) + source_overhead_bytes(s->source);
}

/* Without what is shared. A treelet has most parts in the last set. The slack is what blocks of
 * memory are rounded up by. */
static size_t own_bytes(const resident_store *s, uint32_t t) {
    const leaf_file *f = s->file;
    const int first = hex_resident_shares(f);
    uint32_t p[LEAF_PARTS_MAX];
    size_t bytes = blocks_of(s)->size + blocks_of(s)->bytes(f, t) + 1024;
    for (int i = parts_of(f, f->layout.sets - 1, t, p); i-- > first;)
        bytes += part_bytes(s, p[i]);
    return bytes;
}

size_t hex_resident_shared_bytes(const resident_store *s, uint32_t t) {
    return hex_resident_shares(s->file) ? part_bytes(s, t) : 0;
}

size_t hex_resident_bytes(const resident_store *s, uint32_t t) {
    return own_bytes(s, t) + hex_resident_shared_bytes(s, t);
}

/* Payloads of the file that stores them. */
uint32_t hex_resident_ahead(const resident_store *s, uint32_t set, uint32_t t,
                            uint32_t payloads[RESIDENT_PAYLOADS]) {
    const leaf_file *f = s->file;
    uint32_t p[LEAF_PARTS_MAX], count = 0;
    const int parts = parts_of(f, set, t, p);
    for (int i = 0; i < parts; i++) {
        const leaf_blend needs =
            f->below ? leaf_between_needs(f, p[i]) : (leaf_blend){{p[i], LEAF_NO_TREELET}, 0.0};
        for (int k = 0; k < LEAF_BETWEEN_PARTS; k++)
            if (needs.of[k] != LEAF_NO_TREELET)
                payloads[count++] = needs.of[k];
    }
    return count;
}

uint64_t hex_resident_stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    const leaf_file *f = leaf_file_stores(s->file);
    uint32_t payloads[RESIDENT_PAYLOADS];
    uint64_t bytes = 0;
    (void)family;
    for (uint32_t i = hex_resident_ahead(s, set, t, payloads); i-- > 0;)
        bytes += f->sizes[payloads[i]];
    return bytes;
}

/* ---- one treelet ---- */

/* Where its nodes and corners are. */
static hex_treelet hexes_of(const resident_store *s, const resident_hexes *tr) {
    hex_treelet h = hex_treelet_of(s->file, tr->head.id);
    h.topology = tr->part[0];
    h.places = tr->parts > MOVED ? tr->part[MOVED] : tr->part[0];
    return h;
}

void hex_resident_destroy(const resident_store *s, treelet *head) {
    resident_hexes *tr = (resident_hexes *)head;
    const int first = hex_resident_shares(s->file);
    uint32_t p[LEAF_PARTS_MAX];
    blocks_of(s)->release(tr);
    for (int i = parts_of(s->file, head->set, head->id, p); i-- > first;)
        if (tr->part[i])
            source_evict(s->source, p[i], tr->part[i]);
    mem_free(s->m, tr);
}

void hex_resident_strip(const resident_store *s, treelet *tr) {
    (void)s, (void)tr;
}

/* ---- reading ---- */

/* Whether payload p of the store's file is made of those of two steps. */
static bool is_made(const leaf_file *f, uint32_t p) {
    return f->below && leaf_between_is_made_of(f, p);
}

/* Check what payload p is to be made of: nodes in the boxes of their steps, values in their ranges.
 * So are their blends. */
static status check_made_of(const resident_store *s, const resident_hexes *tr, uint32_t p,
                            const void *payload) {
    const leaf_file *below = s->file->below;
    const leaf_blend needs = leaf_between_needs(s->file, p);
    status st = ST_OK;
    for (int k = 0; k < LEAF_BETWEEN_PARTS && st == ST_OK; k++) {
        uint32_t index;
        if (needs.of[k] == LEAF_NO_TREELET)
            continue;
        const float *part = leaf_between_part_of(s->file, p, payload, k);
        hex_treelet h = hex_treelet_of(below, tr->head.id);
        if (leaf_layout_block_of(&below->layout, needs.of[k], &index) == LEAF_BLOCK_VALUES) {
            st = hex_treelet_check_values(&h, index, part);
        } else {
            h.places = part;
            st = hex_treelet_check_places(&h, index);
        }
    }
    return st;
}

static status check(const resident_store *s, const resident_hexes *tr, const uint32_t *p) {
    hex_treelet h = hexes_of(s, tr);
    if (!s->file->below)
        return hex_treelet_check(&h, tr->head.set, tr->part[VALUES]);
    status st = s->file->geometry->noded->listed ? hex_treelet_check_corners(&h) : ST_OK;
    for (int i = 0; i < tr->parts && st == ST_OK; i++)
        if (is_made(s->file, p[i])) {
            st = check_made_of(s, tr, p[i], tr->part[i]);
        } else { /* those of step 0 */
            h.places = tr->part[i];
            st = hex_treelet_check_places(&h, 0);
        }
    return st;
}

static status read_parts(const resident_store *s, resident_hexes *tr, const resident_hexes *earlier,
                         const uint32_t *p, resident_scratch *scratch, uint64_t *read) {
    status st = ST_OK;
    for (int i = 0; i < tr->parts && st == ST_OK; i++) {
        if (tr->part[i]) /* shared */
            continue;
        st = earlier && is_made(s->file, p[i])
                 ? source_load_after(s->source, p[i], scratch->unpacker, p[i], earlier->part[i],
                                     &tr->part[i])
                 : source_load(s->source, p[i], scratch->unpacker, &tr->part[i]);
        if (st == ST_OK)
            *read += s->file->sizes[p[i]] + leaf_unpacker_take(scratch->unpacker);
    }
    tr->head.payload = tr->part[0];
    return st;
}

/* What follows from nodes and values. */
static void follow(const resident_store *s, resident_hexes *tr) {
    blocks_of(s)->move(tr);
    blocks_of(s)->fill(tr, tr->part[VALUES]);
}

static status fill(const resident_store *s, resident_hexes *tr, const resident_hexes *earlier,
                   resident_scratch *scratch, uint64_t *read) {
    uint32_t p[LEAF_PARTS_MAX];
    tr->parts = parts_of(s->file, tr->head.set, tr->head.id, p);
    status st = read_parts(s, tr, earlier, p, scratch, read);
    if (st == ST_OK)
        st = check(s, tr, p);
    const hex_treelet h = hexes_of(s, tr);
    if (st == ST_OK)
        st = blocks_of(s)->make(tr, s->m, &h);
    if (st == ST_OK && !s->file->below)
        follow(s, tr);
    return st;
}

status hex_resident_load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                         const treelet *earlier, resident_scratch *scratch, treelet **out,
                         uint64_t *read) {
    resident_hexes *tr = mem_zalloc(s->m, blocks_of(s)->size);
    if (!tr)
        return ST_NOMEM;
    *out = &tr->head;
    tr->head.id = t;
    tr->head.set = set;
    tr->head.bytes = own_bytes(s, t);
    tr->part[0] = shared;
    return fill(s, tr, (const resident_hexes *)earlier, scratch, read);
}

/* ---- other sets ---- */

/* Whether all parts are those of another set. */
bool hex_resident_same(const resident_store *s, const treelet *head, uint32_t set) {
    const resident_hexes *tr = (const resident_hexes *)head;
    const leaf_file *f = s->file;
    uint32_t p[LEAF_PARTS_MAX], q[LEAF_PARTS_MAX];
    const int parts = parts_of(f, head->set, head->id, p);
    bool same = parts_of(f, set, head->id, q) == parts;
    for (int i = 0; i < parts && same; i++)
        same = is_made(f, q[i]) ? leaf_between_is_made(f, q[i], tr->part[i])
                                : leaf_file_same(f, p[i], q[i]);
    return same;
}

void hex_resident_adopt(const resident_store *s, treelet *tr, uint32_t set) {
    (void)s;
    tr->set = set;
}

bool hex_resident_helps(const resident_store *s, const treelet *head, uint32_t set) {
    const resident_hexes *tr = (const resident_hexes *)head;
    const leaf_file *f = s->file;
    uint32_t p[LEAF_PARTS_MAX];
    bool any = false;
    if (!f->below)
        return false;
    for (int i = parts_of(f, set, head->id, p); i-- > 0;)
        any |= is_made(f, p[i]) && leaf_between_helps(f, p[i], tr->part[i]);
    return any;
}

/* Another moment between the same two steps needs no reading: masks are made anew, and before them
 * what they follow from. */
bool hex_resident_keep(const resident_store *s, treelet *head) {
    const resident_hexes *tr = (const resident_hexes *)head;
    uint32_t p[LEAF_PARTS_MAX];
    for (int i = parts_of(s->file, head->set, head->id, p); i-- > 0;)
        for (int k = 0; k < LEAF_BETWEEN_PARTS && is_made(s->file, p[i]); k++)
            if (leaf_between_lacks(s->file, p[i], tr->part[i], k))
                return false;
    atomic_store_explicit(&head->masked, 0, memory_order_relaxed);
    return true;
}

/* Nobody looks at nodes and values before the masks are there. */
static void make_between(const resident_store *s, resident_hexes *tr) {
    uint32_t p[LEAF_PARTS_MAX];
    const int parts = parts_of(s->file, tr->head.set, tr->head.id, p);
    for (int i = 0; i < parts; i++)
        if (is_made(s->file, p[i]))
            leaf_between_make(s->file, p[i], tr->part[0], (void *)(uintptr_t)tr->part[i]);
    follow(s, tr);
}

void hex_resident_mask(const resident_store *s, treelet *head, const interest *in) {
    resident_hexes *tr = (resident_hexes *)head;
    if (s->file->below)
        make_between(s, tr);
    blocks_of(s)->select(tr, in);
}
