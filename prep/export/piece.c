#include "prep/export/piece.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

enum { LEAST = 1024 };

enum { TRIANGLE = 3 };

void piece_begin(piece *p, bool solid, double isovalue) {
    p->solid = solid;
    p->isovalue = isovalue;
    p->vertices = p->cells = p->corners = p->shares = 0;
}

int piece_corners(const piece *p, uint32_t cell) {
    return p->solid ? cell_shape_vertices((cell_shape)p->shape[cell]) : TRIANGLE;
}

status piece_add_vertex(piece *p, const piece_vertex *v, uint32_t *index) {
    status st = mem_grow(p->m, &p->vertex, sizeof *p->vertex, p->vertices, LEAST, &p->vertex_room);
    if (st != ST_OK)
        return st;
    *index = p->vertices++;
    p->vertex[*index] = *v;
    return ST_OK;
}

status piece_add_share(piece *p, uint32_t vertex, hash_id key) {
    status st = mem_grow(p->m, &p->share, sizeof *p->share, p->shares, LEAST, &p->share_room);
    if (st == ST_OK)
        p->share[p->shares++] = (piece_share){key, vertex};
    return st;
}

static status add_cell(piece *p, const uint32_t corner[], int corners) {
    status st = ST_OK;
    for (int i = 0; i < corners && st == ST_OK; i++) {
        st = mem_grow(p->m, &p->corner, sizeof *p->corner, p->corners, LEAST, &p->corner_room);
        if (st == ST_OK)
            p->corner[p->corners++] = corner[i];
    }
    p->cells += st == ST_OK;
    return st;
}

status piece_add_triangle(piece *p, const uint32_t corner[3]) {
    return add_cell(p, corner, TRIANGLE);
}

status piece_add_solid(piece *p, cell_shape shape, const uint32_t corner[]) {
    status st = mem_grow(p->m, &p->shape, sizeof *p->shape, p->cells, LEAST, &p->shape_room);
    if (st != ST_OK)
        return st;
    p->shape[p->cells] = (uint8_t)shape;
    return add_cell(p, corner, cell_shape_vertices(shape));
}

hash_id piece_key(float *floats, size_t count) {
    for (size_t i = 0; i < count; i++)
        floats[i] += 0.0F;
    return hash_identity(floats, count * sizeof *floats);
}

static bool same_floats(const piece_vertex *a, const piece_vertex *b) {
    bool same = true;
    for (int i = 0; i < 3; i++)
        same &= (float)a->at[i] == (float)b->at[i];
    return same;
}

void piece_drop_flat(piece *p) {
    uint32_t kept = 0;
    for (uint32_t c = 0; c < p->cells; c++) {
        const uint32_t *corner = p->corner + TRIANGLE * (size_t)c;
        const piece_vertex *v[TRIANGLE];
        for (int i = 0; i < TRIANGLE; i++)
            v[i] = &p->vertex[corner[i]];
        if (same_floats(v[0], v[1]) || same_floats(v[1], v[2]) || same_floats(v[2], v[0]))
            continue;
        memmove(p->corner + TRIANGLE * (size_t)kept++, corner, TRIANGLE * sizeof *corner);
    }
    p->cells = kept;
    p->corners = TRIANGLE * kept;
}

void piece_unit_normals(piece *p) {
    for (uint32_t v = 0; v < p->vertices; v++) {
        double *n = p->vertex[v].normal;
        if (!vec3_unit(n, n) || !isfinite(n[0] + n[1] + n[2]))
            memset(n, 0, sizeof p->vertex[v].normal);
    }
}

void piece_release(piece *p) {
    mem_free(p->m, p->vertex);
    mem_free(p->m, p->corner);
    mem_free(p->m, p->shape);
    mem_free(p->m, p->share);
    *p = (piece){.m = p->m};
}

void piece_source_release(piece_source *s) {
    if (s->destroy)
        s->destroy(s->ctx);
    *s = (piece_source){.ctx = NULL};
}
