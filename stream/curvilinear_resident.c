#include "stream/curvilinear_resident.h"

#include "formats/leaf/curvilinear_geometry.h"
#include "formats/leaf/hex_treelet.h"

static const uint32_t *cells_of(const resident_store *s, uint32_t t) {
    return curvilinear_directory_of(s->file)->counts[t];
}

static uint32_t places_of(const resident_store *s, uint32_t set, uint32_t t) {
    const leaf_layout *l = &s->file->layout;
    return hex_treelet_places(l, leaf_layout_step(l, set), t);
}

static uint32_t values_of(const resident_store *s, uint32_t set, uint32_t t) {
    return leaf_layout_values(&s->file->layout, set, t);
}

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    return (const treelet_bounds *)curvilinear_directory_of(f)->bounds +
           leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

static size_t scratch_bytes(const resident_store *s) {
    (void)s;
    return 0;
}

/* The slack is what blocks of memory are rounded up by. */
static size_t most_bytes(const resident_store *s, uint32_t t) {
    const uint32_t *cells = cells_of(s, t);
    return sizeof(resident_curvilinear) + curvilinear_lattice_bytes(cells) +
           curvilinear_place_bytes(cells) + curvilinear_value_bytes(cells) +
           2 * source_overhead_bytes(s->source) + 1024;
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s, (void)t;
    return 0;
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    (void)family;
    return s->file->sizes[places_of(s, set, t)] + s->file->sizes[values_of(s, set, t)];
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    payloads[0] = places_of(s, set, t);
    payloads[1] = values_of(s, set, t);
    return 2;
}

static void destroy(const resident_store *s, treelet *head) {
    resident_curvilinear *tr = (resident_curvilinear *)head;
    curvilinear_lattice_release(&tr->lattice);
    if (tr->values)
        source_evict(s->source, values_of(s, head->set, head->id), tr->values);
    if (head->payload)
        source_evict(s->source, places_of(s, head->set, head->id), head->payload);
    mem_free(s->m, tr);
}

static status read_payload(const resident_store *s, uint32_t p, resident_scratch *scratch,
                           const void **payload, uint64_t *read) {
    const status st = source_load(s->source, p, scratch->unpacker, payload);
    if (st == ST_OK)
        *read += s->file->sizes[p];
    return st;
}

static status fill(const resident_store *s, resident_curvilinear *tr, resident_scratch *scratch,
                   uint64_t *read) {
    const uint32_t t = tr->head.id, set = tr->head.set, *cells = cells_of(s, t);
    status st = read_payload(s, places_of(s, set, t), scratch, &tr->head.payload, read);
    if (st == ST_OK)
        st = read_payload(s, values_of(s, set, t), scratch, &tr->values, read);
    hex_treelet h = hex_treelet_of(s->file, t);
    h.places = tr->head.payload;
    if (st == ST_OK)
        st = hex_treelet_check(&h, set, tr->values);
    if (st != ST_OK)
        return st;
    const float *const p[3] = {hex_treelet_coordinates(&h, 0), hex_treelet_coordinates(&h, 1),
                               hex_treelet_coordinates(&h, 2)};
    st = curvilinear_lattice_init(&tr->lattice, s->m, cells, p,
                                  (const uint8_t *)(h.places + 3 * (size_t)h.nodes));
    if (st == ST_OK) {
        tr->lattice.first = curvilinear_directory_of(s->file)->first[t];
        curvilinear_lattice_fill(&tr->lattice, tr->values);
    }
    return st;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    (void)shared, (void)earlier;
    resident_curvilinear *tr = mem_zalloc(s->m, sizeof *tr);
    if (!tr)
        return ST_NOMEM;
    tr->lattice.m = s->m;
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
    curvilinear_lattice_select(&((resident_curvilinear *)head)->lattice, in);
}

const resident_kind curvilinear_resident = {.shares = false,
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
