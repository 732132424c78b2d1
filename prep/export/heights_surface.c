#include "prep/export/heights_surface.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "formats/leaf/leaf_unpacker.h"

#define NO_VERTEX UINT32_MAX

/* A thread's buffers for its treelet. */
typedef struct bench {
    char *payload;
    leaf_unpacker *unpacker;
    uint32_t *vertex;    /* of the treelet's nodes, row by row */
    float *samples;      /* of each set at the nodes, then at the vertices */
    const float **value; /* of each set */
} bench;

typedef struct heights_surface {
    mem *m;
    leaf_file *f;
    const grid_part *part;
    const uint32_t *sets;
    uint32_t count;
    bool mirrored; /* seen from above, the second axis lies to the right of the first */
    int threads;
    bench *benches;
} heights_surface;

/* The nodes of a treelet, those in the part, and the cells between them: [0] and [1], along axes 0
 * and 2. */
typedef struct plan {
    leaf_payload shape;
    uint32_t node[2];           /* the first node, in the level */
    uint32_t first[2], last[2]; /* cells in the part */
    uint32_t row;               /* nodes */
} plan;

static uint32_t nodes_most(const leaf_file *f) {
    const uint32_t side = (1u << f->layout.cells_log2) + 1;
    return side * side;
}

static uint64_t payload_of(const leaf_file *f) {
    return leaf_layout_aligned(leaf_layout_payload_max(&f->layout), LEAF_ALIGN_LOG2);
}

uint64_t heights_surface_worker(const leaf_file *f, uint32_t count) {
    return payload_of(f) + leaf_unpacker_memory(f) +
           nodes_most(f) * (sizeof(uint32_t) + count * sizeof(float)) + 4096;
}

static plan plan_of(const heights_surface *s, uint32_t t) {
    const leaf_layout *l = &s->f->layout;
    plan p = {.shape = leaf_layout_payload(l, t)};
    for (int k = 0; k < 2; k++) {
        const int a = 2 * k;
        const uint32_t cells = p.shape.cells[a], from = l->place[t][a] << l->cells_log2;
        const uint32_t lo = s->part->lo[a], last = s->part->end[a] - 1;
        p.node[k] = from;
        p.first[k] = lo > from ? lo - from : 0;
        p.last[k] = last > from ? last - from : 0;
        p.first[k] = p.first[k] < cells ? p.first[k] : cells;
        p.last[k] = p.last[k] < cells ? p.last[k] : cells;
    }
    p.row = p.shape.cells[0] + 1;
    return p;
}

/* Load a set's samples at all nodes. */
static status load_set(const heights_surface *s, bench *b, const plan *p, uint32_t t, uint32_t k) {
    const leaf_layout *l = &s->f->layout;
    const uint32_t h = l->halo, *samples = p->shape.samples;
    const status st =
        leaf_file_load(s->f, leaf_layout_samples(l, s->sets[k], t), b->unpacker, b->payload);
    if (st != ST_OK)
        return st;
    float *to = b->samples + (size_t)k * nodes_most(s->f);
    for (uint32_t j = 0; j <= p->shape.cells[2]; j++)
        for (uint32_t i = 0; i < p->row; i++)
            *to++ = sample_get(l->type, b->payload + p->shape.samples_at,
                               ((size_t)(j + h) * samples[1] + h) * samples[0] + i + h);
    return ST_OK;
}

static bool is_whole(const bench *b, const plan *p, uint32_t i, uint32_t j) {
    const float *h = b->samples + (size_t)j * p->row + i;
    return isfinite(h[0]) && isfinite(h[1]) && isfinite(h[p->row]) && isfinite(h[p->row + 1]);
}

/* Mark the nodes of cells that have a surface. */
static void mark_nodes(bench *b, const plan *p) {
    for (uint32_t j = p->first[1]; j < p->last[1]; j++)
        for (uint32_t i = p->first[0]; i < p->last[0]; i++) {
            uint32_t *v = b->vertex + (size_t)j * p->row + i;
            if (is_whole(b, p, i, j))
                v[0] = v[1] = v[p->row] = v[p->row + 1] = 0;
        }
}

static status add_vertex(const heights_surface *s, const plan *p, uint32_t i, uint32_t j, float h,
                         piece *out, uint32_t *index) {
    const uint32_t node[2] = {p->node[0] + i, p->node[1] + j};
    const double *map = s->f->header.to_world;
    const double at[3] = {grid_part_at(s->f, s->part->level, 0, node[0]), (double)h,
                          grid_part_at(s->f, s->part->level, 2, node[1])};
    const bool border = i == 0 || j == 0 || i == p->shape.cells[0] || j == p->shape.cells[2];
    float name[4];
    piece_vertex v = {.normal = {0.0}};
    for (int row = 0; row < 3; row++)
        v.at[row] = vec3_dot(map + 4 * row, at) + map[4 * row + 3];
    for (int k = 0; k < 2; k++) {
        name[2 * k] = (float)(node[k] & 0xffff);
        name[2 * k + 1] = (float)(node[k] >> 16);
    }
    const status st = piece_add_vertex(out, &v, index);
    return st == ST_OK && border ? piece_add_share(out, *index, piece_key(name, 4)) : st;
}

/* Add the marked nodes as vertices, and keep their values alone. */
static status add_vertices(const heights_surface *s, bench *b, const plan *p, piece *out) {
    const uint32_t nodes = p->row * (p->shape.cells[2] + 1), most = nodes_most(s->f);
    for (uint32_t n = 0; n < nodes; n++) {
        if (b->vertex[n] == NO_VERTEX)
            continue;
        const status st =
            add_vertex(s, p, n % p->row, n / p->row, b->samples[n], out, &b->vertex[n]);
        if (st != ST_OK)
            return st;
    }
    for (uint32_t k = 0; k < s->count; k++) {
        float *of = b->samples + (size_t)k * most;
        for (uint32_t n = 0; n < nodes; n++)
            if (b->vertex[n] != NO_VERTEX)
                of[b->vertex[n]] = of[n];
    }
    return ST_OK;
}

static status add_cell(const heights_surface *s, const uint32_t *v, uint32_t row, piece *out) {
    const uint32_t corner[2][3] = {{v[0], v[1], v[row + 1]}, {v[0], v[row + 1], v[row]}};
    for (int k = 0; k < 2; k++) {
        const uint32_t *c = corner[k], turned[3] = {c[0], c[2], c[1]};
        const status st = piece_add_triangle(out, s->mirrored ? turned : c);
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}

static status make(void *ctx, uint32_t index, int worker, piece *out) {
    const heights_surface *s = ctx;
    bench *b = &s->benches[worker];
    const uint32_t t = s->f->layout.level[s->part->level].first + index;
    const plan p = plan_of(s, t);
    status st = ST_OK;
    piece_begin(out, false, 0);
    out->values = b->value;
    if (p.first[0] == p.last[0] || p.first[1] == p.last[1])
        return ST_OK;
    for (uint32_t k = 0; k < s->count && st == ST_OK; k++)
        st = load_set(s, b, &p, t, k);
    if (st != ST_OK)
        return st;
    memset(b->vertex, 0xff, nodes_most(s->f) * sizeof *b->vertex);
    mark_nodes(b, &p);
    st = add_vertices(s, b, &p, out);
    for (uint32_t j = p.first[1]; j < p.last[1] && st == ST_OK; j++)
        for (uint32_t i = p.first[0]; i < p.last[0] && st == ST_OK; i++) {
            const uint32_t *v = b->vertex + (size_t)j * p.row + i;
            if (v[0] != NO_VERTEX && v[1] != NO_VERTEX && v[p.row] != NO_VERTEX &&
                v[p.row + 1] != NO_VERTEX)
                st = add_cell(s, v, p.row, out);
        }
    return st;
}

/* ---- all of it ---- */

static void destroy(void *ctx) {
    heights_surface *s = ctx;
    for (int i = 0; s->benches && i < s->threads; i++) {
        bench *b = &s->benches[i];
        mem_free(s->m, b->payload);
        leaf_unpacker_destroy(b->unpacker);
        mem_free(s->m, b->vertex);
        mem_free(s->m, b->samples);
        mem_free(s->m, (void *)b->value);
    }
    mem_free(s->m, s->benches);
    mem_free(s->m, s);
}

static status make_bench(heights_surface *s, bench *b) {
    const size_t nodes = nodes_most(s->f);
    b->payload = mem_alloc(s->m, payload_of(s->f));
    b->vertex = mem_array(s->m, nodes, sizeof *b->vertex);
    b->samples = mem_array(s->m, s->count * nodes, sizeof *b->samples);
    b->value = mem_array(s->m, s->count, sizeof *b->value);
    if (!b->payload || !b->vertex || !b->samples || !b->value)
        return ST_NOMEM;
    for (uint32_t k = 0; k < s->count; k++)
        b->value[k] = b->samples + k * nodes;
    return leaf_unpacker_create(s->m, s->f, &b->unpacker);
}

static bool is_mirrored(const double to_world[12]) {
    double axis[3][3];
    for (int a = 0; a < 3; a++)
        for (int row = 0; row < 3; row++)
            axis[a][row] = to_world[4 * row + a];
    return vec3_det(axis[0], axis[2], axis[1]) < 0;
}

status heights_surface_create(mem *m, leaf_file *f, const grid_part *part, const uint32_t *sets,
                              uint32_t count, int threads, piece_source *out) {
    heights_surface *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (heights_surface){.m = m,
                           .f = f,
                           .part = part,
                           .sets = sets,
                           .count = count,
                           .mirrored = is_mirrored(f->header.to_world),
                           .threads = threads,
                           .benches = mem_array(m, (size_t)threads, sizeof *s->benches)};
    status st = s->benches ? ST_OK : ST_NOMEM;
    for (int i = 0; st == ST_OK && i < threads; i++)
        st = make_bench(s, &s->benches[i]);
    if (st != ST_OK) {
        destroy(s);
        return st;
    }
    *out = (piece_source){.ctx = s,
                          .pieces = f->layout.level[part->level].count,
                          .values = count,
                          .make = make,
                          .destroy = destroy};
    return ST_OK;
}
