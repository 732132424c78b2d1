#include "stream/cell_resident.h"

#include "formats/leaf/leaf_cells.h"

static uint32_t count_of(const resident_store *s, uint32_t t) {
    return leaf_cells_directory_of(s->file)->counts[t][0];
}

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    return (const treelet_bounds *)leaf_cells_directory_of(f)->bounds +
           leaf_layout_bounds(&f->layout, leaf_layout_step(&f->layout, set), 0);
}

static size_t scratch_bytes(const resident_store *s) {
    return s->file->layout.payload_max / leaf_cells_of(s->file)->bytes * sizeof(treelet_bounds);
}

static size_t most_bytes(const resident_store *s, uint32_t t) {
    const uint32_t count = count_of(s, t);
    return sizeof(resident_cells) + count * (sizeof(float[2]) + leaf_cells_of(s->file)->bytes) +
           treelet_tree_bytes(count) + source_overhead_bytes(s->source) + 256;
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s, (void)t;
    return 0;
}

static uint32_t payload_of(const resident_store *s, uint32_t set, uint32_t t) {
    return leaf_layout_samples(&s->file->layout, set, t);
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t, uint32_t *family) {
    (void)family;
    return s->file->sizes[payload_of(s, set, t)];
}

static uint32_t ahead(const resident_store *s, uint32_t set, uint32_t t,
                      uint32_t payloads[RESIDENT_PAYLOADS]) {
    payloads[0] = payload_of(s, set, t);
    return 1;
}

/* What the directory says of the treelet holds for a cell, or rays would pass it by. */
static bool is_inside(const resident_store *s, const treelet *tr, const float box[6],
                      const float range[2]) {
    const float *bounds = boxes(s->file, tr->set)[tr->id];
    const float *own = s->file->own[payload_of(s, tr->set, tr->id)];
    bool inside = range[0] >= own[0] && range[1] <= own[1];
    for (int a = 0; a < 3; a++)
        inside = inside && box[a] >= bounds[a] && box[a + 3] <= bounds[a + 3];
    return inside;
}

/* Measure all cells. */
static status measure(const resident_store *s, resident_cells *tr, treelet_bounds measured[]) {
    const leaf_cells *cells = leaf_cells_of(s->file);
    for (uint32_t i = 0; i < tr->count; i++) {
        const char *record = (const char *)tr->head.payload + (size_t)i * cells->bytes;
        const char *fault = cells->measure(record, measured[i], tr->ranges[i]);
        if (!fault && !is_inside(s, &tr->head, measured[i], tr->ranges[i]))
            fault = "not inside of it";
        if (fault)
            return status_describe(ST_CORRUPT, "%s: treelet %u's %s %u is %s",
                                   file_path(s->file->source), tr->head.id, cells->name, i, fault);
    }
    return ST_OK;
}

static void destroy(const resident_store *s, treelet *head) {
    resident_cells *tr = (resident_cells *)head;
    if (head->payload)
        source_evict(s->source, payload_of(s, head->set, head->id), head->payload);
    treelet_tree_release(&tr->tree);
    mem_free(s->m, tr);
}

static status fill(const resident_store *s, resident_cells *tr, resident_scratch *scratch,
                   uint64_t *read) {
    const uint32_t p = payload_of(s, tr->head.set, tr->head.id);
    treelet_bounds *measured = scratch->room;
    status st = source_load(s->source, p, scratch->unpacker, &tr->head.payload);
    if (st != ST_OK)
        return st;
    *read += s->file->sizes[p];
    st = measure(s, tr, measured);
    return st == ST_OK
               ? treelet_tree_init(&tr->tree, s->m, (const treelet_bounds *)measured, tr->count)
               : st;
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   const treelet *earlier, resident_scratch *scratch, treelet **out,
                   uint64_t *read) {
    (void)earlier;
    const uint32_t count = count_of(s, t);
    (void)shared;
    resident_cells *tr = mem_zalloc(s->m, sizeof *tr + count * sizeof *tr->ranges);
    if (!tr)
        return ST_NOMEM;
    tr->head.id = t;
    tr->head.set = set;
    tr->head.bytes = most_bytes(s, t);
    tr->count = count;
    tr->record_bytes = leaf_cells_of(s->file)->bytes;
    tr->first = leaf_cells_directory_of(s->file)->first[t];
    tr->ranges = (float(*)[2])(tr + 1);
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
    resident_cells *tr = (resident_cells *)head;
    (void)s;
    for (uint32_t i = 0; i < tr->count; i++)
        tr->tree.active[0][i] = interest_meets(in, tr->ranges[i][0], tr->ranges[i][1]);
    treelet_tree_select(&tr->tree, tr->tree.active[0]);
}

const resident_kind cell_resident = {.boxes = boxes,
                                     .scratch = scratch_bytes,
                                     .bytes = most_bytes,
                                     .shared_bytes = shared_bytes,
                                     .stored = stored,
                                     .ahead = ahead,
                                     .load = load,
                                     .strip = strip,
                                     .destroy = destroy,
                                     .mask = mask};
