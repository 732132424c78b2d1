#include "prep/export/cell_source.h"

#include <assert.h>

#include "prep/export/surface_units.h"

typedef struct cell_source {
    mem *m;
    const cell_source_kind *kind;
    const double *isovalues; /* NULL: cells */
    surface_units units;
    int threads, created;
    char *benches;
} cell_source;

static void *bench_of(const cell_source *s, int worker) {
    return s->benches + (size_t)worker * s->kind->bench;
}

static status make(void *ctx, uint32_t index, int worker, piece *p) {
    cell_source *s = ctx;
    void *bench = bench_of(s, worker);
    if (!s->isovalues) {
        piece_begin(p, !s->kind->flat, 0);
        return s->kind->make(bench, index, p);
    }
    const surface_unit *u = &s->units.list[index];
    piece_begin(p, false, s->isovalues[u->isovalue]);
    const status st = s->kind->make(bench, u->treelet, p);
    if (st == ST_OK)
        piece_unit_normals(p);
    return st;
}

static void destroy(void *ctx) {
    cell_source *s = ctx;
    for (int i = 0; i < s->created; i++)
        s->kind->release(bench_of(s, i));
    mem_free(s->m, s->benches);
    surface_units_release(&s->units);
    mem_free(s->m, s);
}

static status create_benches(cell_source *s, const cell_choice *choice) {
    s->benches = mem_array(s->m, (size_t)s->threads, s->kind->bench);
    status st = s->benches ? ST_OK : ST_NOMEM;
    while (st == ST_OK && s->created < s->threads)
        st = s->kind->create(s->m, choice, bench_of(s, s->created++));
    return st;
}

status cell_source_create(mem *m, const cell_source_kind *kind, const cell_choice *choice,
                          const double *isovalues, uint32_t count, int threads, piece_source *out) {
    const leaf_layout *l = &choice->f->layout;
    cell_source *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (cell_source){.m = m,
                       .kind = kind,
                       .isovalues = count ? isovalues : NULL,
                       .units = {.m = m},
                       .threads = threads};
    status st =
        surface_units_find(&s->units, choice->f,
                           leaf_layout_set(l, choice->fields[0], choice->step), isovalues, count);
    if (st == ST_OK)
        st = create_benches(s, choice);
    if (st != ST_OK) {
        destroy(s);
        return st;
    }
    assert(s->units.count <= UINT32_MAX);
    *out = (piece_source){.ctx = s,
                          .pieces = count ? (uint32_t)s->units.count : l->treelets,
                          .values = count ? 0 : choice->count,
                          .make = make,
                          .destroy = destroy};
    return ST_OK;
}
