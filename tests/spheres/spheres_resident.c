#include "tests/spheres/spheres_resident.h"

#include <math.h>

static const treelet_bounds *boxes(const leaf_file *f, uint32_t set) {
    (void)set;
    return (const treelet_bounds *)spheres_directory_of(f)->bounds;
}

static size_t scratch_bytes(const resident_store *s) {
    (void)s;
    return 0;
}

static uint32_t count_of(const resident_store *s, uint32_t t) {
    return spheres_directory_of(s->file)->counts[t][0];
}

static size_t block_bytes(const resident_store *s, uint32_t t) {
    return sizeof(spheres_treelet) + count_of(s, t);
}

static size_t most_bytes(const resident_store *s, uint32_t t) {
    return block_bytes(s, t) + count_of(s, t) * sizeof(sphere) + source_overhead_bytes(s->source) +
           128;
}

static size_t shared_bytes(const resident_store *s, uint32_t t) {
    (void)s;
    (void)t;
    return 0;
}

static uint64_t stored(const resident_store *s, uint32_t set, uint32_t t) {
    (void)set;
    return s->file->sizes[t];
}

/* What the directory says of the treelet holds, or rays would pass it by. */
static bool fits(const resident_store *s, uint32_t t, const sphere *x) {
    const float *bounds = spheres_directory_of(s->file)->bounds[t];
    bool inside = x->radius > 0.0 && x->peak > 0.0 && x->peak <= (double)s->file->own[t][1];
    for (int a = 0; a < 3; a++)
        inside = inside && x->centre[a] - x->radius >= (double)bounds[a] &&
                 x->centre[a] + x->radius <= (double)bounds[a + 3];
    return inside;
}

static status check(const resident_store *s, const spheres_treelet *tr) {
    for (uint32_t i = 0; i < tr->count; i++)
        if (!fits(s, tr->head.id, &tr->spheres[i]))
            return status_describe(ST_CORRUPT, "%s: treelet %u's sphere %u is not inside of it",
                                   file_path(s->file->source), tr->head.id, i);
    return ST_OK;
}

static void destroy(const resident_store *s, treelet *tr) {
    if (tr->payload)
        source_evict(s->source, tr->id, tr->payload);
    mem_free(s->m, tr);
}

static status load(const resident_store *s, uint32_t t, uint32_t set, const void *shared,
                   resident_scratch *scratch, treelet **out, uint64_t *read) {
    (void)shared;
    spheres_treelet *tr = mem_zalloc(s->m, block_bytes(s, t));
    if (!tr)
        return ST_NOMEM;
    tr->head.id = t;
    tr->head.set = set;
    tr->head.bytes = most_bytes(s, t);
    tr->count = count_of(s, t);
    tr->first = spheres_directory_of(s->file)->first[t];
    status st = source_load(s->source, t, &scratch->source, &tr->head.payload);
    if (st == ST_OK) {
        tr->spheres = tr->head.payload;
        *read += s->file->sizes[t];
        st = check(s, tr);
    }
    if (st != ST_OK) {
        destroy(s, &tr->head);
        return st;
    }
    *out = &tr->head;
    return ST_OK;
}

static void strip(const resident_store *s, treelet *tr) {
    (void)s;
    (void)tr;
}

/* From the rim's 0 to the peak; rounded up, as the kernel decides. */
static void mask(const resident_store *s, treelet *head, const interest *in) {
    spheres_treelet *tr = (spheres_treelet *)head;
    (void)s;
    for (uint32_t i = 0; i < tr->count; i++)
        tr->active[i] = interest_meets(in, 0.0f, nextafterf((float)tr->spheres[i].peak, INFINITY));
}

const resident_kind spheres_resident = {.shares = false,
                                        .boxes = boxes,
                                        .scratch = scratch_bytes,
                                        .bytes = most_bytes,
                                        .shared_bytes = shared_bytes,
                                        .stored = stored,
                                        .load = load,
                                        .strip = strip,
                                        .destroy = destroy,
                                        .mask = mask};
