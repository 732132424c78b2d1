#include "prep/export/tet_pieces.h"

#include <string.h>

struct tet_pieces {
    mem *m;
    const tet_choice *choice;
    int threads;
    tet_bench *benches;
    char *names; /* bytes that a vertex's key is made from, one buffer per thread */
    size_t name;
};

status tet_pieces_create(mem *m, const tet_choice *choice, int threads, tet_pieces **out) {
    tet_pieces *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (tet_pieces){.m = m,
                      .choice = choice,
                      .threads = threads,
                      .name = (3 + (size_t)choice->count) * sizeof(float)};
    s->benches = mem_array(m, (size_t)threads, sizeof *s->benches);
    s->names = mem_alloc(m, (size_t)threads * s->name);
    status st = s->benches && s->names ? ST_OK : ST_NOMEM;
    for (int i = 0; st == ST_OK && i < threads; i++)
        st = tet_bench_create(m, choice, &s->benches[i]);
    if (st != ST_OK) {
        tet_pieces_destroy(s);
        return st;
    }
    *out = s;
    return ST_OK;
}

void tet_pieces_destroy(tet_pieces *s) {
    if (!s)
        return;
    for (int i = 0; s->benches && i < s->threads; i++)
        if (s->benches[i].m)
            tet_bench_release(&s->benches[i]);
    mem_free(s->m, s->benches);
    mem_free(s->m, s->names);
    mem_free(s->m, s);
}

static hash_id key_of(const tet_pieces *s, const tet_bench *b, uint32_t vertex, char *name) {
    memcpy(name, b->at[vertex], sizeof b->at[vertex]);
    for (uint32_t i = 0; i < s->choice->count; i++)
        memcpy(name + (3 + (size_t)i) * sizeof(float), &b->value[i][vertex], sizeof(float));
    return hash_identity(name, s->name);
}

static status add_vertices(const tet_pieces *s, const tet_bench *b, char *name, piece *p) {
    status st = ST_OK;
    for (uint32_t v = 0; st == ST_OK && v < b->shape.vertices; v++) {
        piece_vertex vertex = {.at = {0}};
        uint32_t index;
        for (int a = 0; a < 3; a++)
            vertex.at[a] = (double)b->at[v][a];
        st = piece_add_vertex(p, &vertex, &index);
        if (st == ST_OK)
            st = piece_add_share(p, index, key_of(s, b, v, name));
    }
    return st;
}

static status add_tets(const tet_bench *b, piece *p) {
    status st = ST_OK;
    for (uint32_t t = 0; st == ST_OK && t < b->shape.tets; t++) {
        const uint16_t *v = b->tets[t];
        const bool turned = tet_bench_sign(b, t) < 0;
        st = piece_add_cell(p, (uint32_t[4]){v[0], v[1], v[turned ? 3 : 2], v[turned ? 2 : 3]});
    }
    return st;
}

static status make(void *ctx, uint32_t index, int worker, piece *p) {
    tet_pieces *s = ctx;
    tet_bench *b = &s->benches[worker];
    piece_begin(p, 4, 0);
    status st = tet_bench_load(b, index);
    if (st == ST_OK)
        st = add_vertices(s, b, s->names + (size_t)worker * s->name, p);
    p->values = b->value;
    return st == ST_OK ? add_tets(b, p) : st;
}

piece_source tet_pieces_source(tet_pieces *s) {
    return (piece_source){.ctx = s,
                          .pieces = s->choice->f->layout.treelets,
                          .corners = 4,
                          .values = s->choice->count,
                          .make = make};
}
