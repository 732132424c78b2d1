#include "prep/export/piece.h"

#include <string.h>

enum { LEAST = 1024 };

void piece_begin(piece *p, int corners, double isovalue) {
    p->corners = corners;
    p->isovalue = isovalue;
    p->vertices = p->cells = p->shares = 0;
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

status piece_add_cell(piece *p, const uint32_t corner[]) {
    const size_t size = (size_t)p->corners * sizeof *p->corner;
    status st = mem_grow(p->m, &p->corner, size, p->cells, LEAST, &p->corner_room);
    if (st == ST_OK)
        memcpy(p->corner + (size_t)p->corners * p->cells++, corner, size);
    return st;
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
        const uint32_t *corner = p->corner + 3 * (size_t)c;
        const piece_vertex *v[3];
        for (int i = 0; i < 3; i++)
            v[i] = &p->vertex[corner[i]];
        if (same_floats(v[0], v[1]) || same_floats(v[1], v[2]) || same_floats(v[2], v[0]))
            continue;
        memmove(p->corner + 3 * (size_t)kept++, corner, 3 * sizeof *corner);
    }
    p->cells = kept;
}

void piece_release(piece *p) {
    mem_free(p->m, p->vertex);
    mem_free(p->m, p->corner);
    mem_free(p->m, p->share);
    *p = (piece){.m = p->m};
}
