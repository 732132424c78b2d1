#include "formats/mesh/mesh_arrays.h"

#include <stdio.h>

enum { CHUNK = 4096 };

typedef struct arrays_state {
    mem *m;
    mesh_arrays a;
} arrays_state;

status mesh_arrays_state(mem *m, const mesh_arrays *a, void **state) {
    arrays_state *s = mem_alloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (arrays_state){m, *a};
    *state = s;
    return ST_OK;
}

static size_t chunk_of(uint64_t left) {
    return left < CHUNK ? (size_t)left : CHUNK;
}

static status read_points(const mesh_arrays *a, mesh_feed *feed) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < a->points; i += CHUNK)
        st = mesh_feed_points(feed, a->xyz + i, chunk_of(a->points - i));
    for (uint64_t i = 0; a->values && st == ST_OK && i < a->points; i += CHUNK)
        st = mesh_feed_values(feed, 0, a->values + i, chunk_of(a->points - i));
    return st == ST_OK && !a->values ? mesh_feed_zeros(feed) : st;
}

static status arrays_read(void *state, mesh_feed *feed) {
    const mesh_arrays *a = &((const arrays_state *)state)->a;
    if (a->values && a->field)
        snprintf(feed->report->field, sizeof feed->report->field, "%s", a->field);
    status st = mesh_feed_expect(feed, a->points);
    mesh_feed_expect_cells(feed, a->tets);
    if (st == ST_OK)
        st = read_points(a, feed);
    for (uint64_t i = 0; st == ST_OK && i < a->tets; i += CHUNK)
        st = mesh_feed_tets(feed, a->ids + i, chunk_of(a->tets - i));
    return st;
}

static void arrays_close(void *state) {
    arrays_state *s = state;
    if (s)
        mem_free(s->m, s);
}

static void arrays_fields(const void *state, mesh_field_taker *take, void *ctx) {
    const mesh_arrays *a = &((const arrays_state *)state)->a;
    if (a->values && a->field)
        take(ctx, a->field, 1);
}

const mesh_reader mesh_arrays_reader = {
    .format = "arrays", .read = arrays_read, .close = arrays_close, .fields = arrays_fields};
