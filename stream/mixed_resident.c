#include "stream/mixed_resident.h"

#include "formats/leaf/hex_treelet.h"
#include "formats/leaf/mixed_geometry.h"

static mixed_shape shape_of(const resident_store *s, uint32_t t) {
    return mixed_shape_of(mixed_directory_of(s->file)->counts[t]);
}

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    return (const treelet_bounds *)mixed_directory_of(f)->bounds +
           leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

static size_t scratch_bytes(const resident_store *s) {
    (void)s;
    return 0;
}

/* The slack is what blocks of memory are rounded up by. */
static size_t most_bytes(const resident_store *s, uint32_t t) {
    const mixed_shape shape = shape_of(s, t);
    return sizeof(resident_mixed) + mixed_blocks_bytes(&shape) + shape.topology_bytes +
           shape.value_bytes + (leaf_layout_moves(&s->file->layout) ? shape.place_bytes : 0) +
           3 * source_overhead_bytes(s->source) + 1024;
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s, (void)t;
    return 0;
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    return (uint32_t)s->file->geometry->parts(&s->file->layout, set, t, payloads);
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    uint32_t payloads[RESIDENT_PAYLOADS];
    uint64_t bytes = 0;
    (void)family;
    for (uint32_t i = ahead(s, set, t, payloads); i-- > 0;)
        bytes += s->file->sizes[payloads[i]];
    return bytes;
}

static void destroy(const resident_store *s, treelet *head) {
    resident_mixed *tr = (resident_mixed *)head;
    const leaf_layout *l = &s->file->layout;
    mixed_blocks_release(&tr->blocks);
    if (tr->values)
        source_evict(s->source, leaf_layout_values(l, head->set, head->id), tr->values);
    if (tr->moved)
        source_evict(s->source, leaf_layout_positions(l, leaf_layout_step(l, head->set), head->id),
                     tr->moved);
    if (head->payload)
        source_evict(s->source, head->id, head->payload);
    mem_free(s->m, tr);
}

static status read_payload(const resident_store *s, uint32_t p, resident_scratch *scratch,
                           const void **payload, uint64_t *read) {
    const status st = source_load(s->source, p, scratch->unpacker, payload);
    if (st == ST_OK)
        *read += s->file->sizes[p];
    return st;
}

static status fill(const resident_store *s, resident_mixed *tr, resident_scratch *scratch,
                   uint64_t *read) {
    const leaf_layout *l = &s->file->layout;
    const uint32_t t = tr->head.id, set = tr->head.set,
                   place = leaf_layout_place(l, leaf_layout_step(l, set));
    const mixed_shape shape = shape_of(s, t);
    status st = read_payload(s, t, scratch, &tr->head.payload, read);
    if (st == ST_OK && place > 0)
        st = read_payload(s, leaf_layout_positions(l, place, t), scratch, &tr->moved, read);
    if (st == ST_OK)
        st = read_payload(s, leaf_layout_values(l, set, t), scratch, &tr->values, read);
    if (st != ST_OK)
        return st;
    hex_treelet h = hex_treelet_of(s->file, t);
    h.topology = tr->head.payload;
    h.places = tr->moved ? tr->moved : tr->head.payload;
    st = hex_treelet_check(&h, set, tr->values);
    if (st == ST_OK)
        st = mixed_blocks_init(&tr->blocks, s->m, &shape, tr->head.payload, h.places);
    if (st == ST_OK) {
        tr->blocks.first = mixed_directory_of(s->file)->first[t];
        mixed_blocks_fill(&tr->blocks, tr->values);
    }
    return st;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    (void)shared, (void)earlier;
    resident_mixed *tr = mem_zalloc(s->m, sizeof *tr);
    if (!tr)
        return ST_NOMEM;
    tr->blocks.m = s->m;
    tr->head.id = t;
    tr->head.set = set;
    tr->head.bytes = most_bytes(s, t);
    const status st = fill(s, tr, scratch, read);
    if (st == ST_OK)
        *out = &tr->head;
    else
        destroy(s, &tr->head);
    return st;
}

static void strip(const resident_store *s, treelet *tr) {
    (void)s, (void)tr;
}

static void mask(const resident_store *s, treelet *head, const interest *in) {
    (void)s;
    mixed_blocks_select(&((resident_mixed *)head)->blocks, in);
}

const resident_kind mixed_resident = {.shares = false,
                                      .boxes = boxes,
                                      .scratch = scratch_bytes,
                                      .bytes = most_bytes,
                                      .shared_bytes = shared_bytes,
                                      .stored = stored,
                                      .ahead = ahead,
                                      .load = load,
                                      .strip = strip,
                                      .destroy = destroy,
                                      .mask = mask};
