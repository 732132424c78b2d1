#include "prep/export/tet_solids.h"

#include "prep/export/cell_source.h"

typedef struct bench {
    tet_bench tets;
    float *name; /* what a vertex's key is made from */
} bench;

static size_t name_of(const cell_choice *c) {
    return 3 + (size_t)c->count;
}

uint64_t tet_solids_worker(const cell_choice *c) {
    return tet_bench_bytes(c) + name_of(c) * sizeof(float) + 128;
}

static status add_vertices(bench *b, piece *p) {
    const tet_bench *t = &b->tets;
    status st = ST_OK;
    for (uint32_t v = 0; st == ST_OK && v < t->shape.vertices; v++) {
        piece_vertex vertex = {.at = {0}};
        uint32_t index;
        for (int a = 0; a < 3; a++) {
            b->name[a] = t->at[v][a];
            vertex.at[a] = (double)t->at[v][a];
        }
        for (uint32_t i = 0; i < t->choice->count; i++)
            b->name[3 + i] = t->value[i][v];
        st = piece_add_vertex(p, &vertex, &index);
        if (st == ST_OK)
            st = piece_add_share(p, index, piece_key(b->name, name_of(t->choice)));
    }
    return st;
}

static status add_tets(const tet_bench *b, piece *p) {
    status st = ST_OK;
    for (uint32_t t = 0; st == ST_OK && t < b->shape.tets; t++) {
        const uint16_t *v = b->tets[t];
        const bool turned = tet_bench_sign(b, t) < 0;
        st = piece_add_solid(p, CELL_TET,
                             (uint32_t[4]){v[0], v[1], v[turned ? 3 : 2], v[turned ? 2 : 3]});
    }
    return st;
}

static status make(void *bench_of, uint32_t treelet, piece *p) {
    bench *b = bench_of;
    status st = tet_bench_load(&b->tets, treelet);
    if (st == ST_OK)
        st = add_vertices(b, p);
    p->values = b->tets.value;
    return st == ST_OK ? add_tets(&b->tets, p) : st;
}

/* ---- all of it ---- */

static status create(mem *m, const cell_choice *choice, void *bench_of) {
    bench *b = bench_of;
    const status st = tet_bench_create(m, choice, &b->tets);
    b->name = mem_array(m, name_of(choice), sizeof *b->name);
    return st == ST_OK && !b->name ? ST_NOMEM : st;
}

static void release(void *bench_of) {
    bench *b = bench_of;
    tet_bench_release(&b->tets);
    mem_free(b->tets.m, b->name);
}

status tet_solids_create(mem *m, const cell_choice *choice, int threads, piece_source *out) {
    static const cell_source_kind kind = {sizeof(bench), create, release, make, .flat = false};
    return cell_source_create(m, &kind, choice, NULL, 0, threads, out);
}
