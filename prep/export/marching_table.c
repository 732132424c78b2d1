#include "prep/export/marching_table.h"

#include <assert.h>
#include <stdbool.h>
#include <string.h>

enum { NO_EDGE = 255 };

/* ---- the cube ---- */

static void number_edges(marching_table *t) {
    int count = 0;
    for (int a = 0; a < 3; a++)
        for (int corner = 0; corner < 8; corner++)
            if (!(corner >> a & 1)) {
                t->edge[count][0] = (uint8_t)corner;
                t->edge[count++][1] = (uint8_t)(corner | 1 << a);
            }
}

/* Corners around a face, clockwise as seen from outside. */
static void number_faces(marching_table *t) {
    for (int f = 0; f < 6; f++) {
        const int a = f / 2, base = (f & 1) << a, u = 1 << (a + 1) % 3, v = 1 << (a + 2) % 3;
        const int around[4] = {base, base | u, base | u | v, base | v};
        for (int i = 0; i < 4; i++)
            t->face[f][i] = (uint8_t)around[f & 1 ? 3 - i : i];
    }
}

/* The edge between corners i and i + 1 of a face. */
static int edge_of_face(const marching_table *t, int face, int i) {
    const int a = t->face[face][i % 4], b = t->face[face][(i + 1) % 4];
    for (int e = 0; e < MARCHING_EDGES; e++)
        if ((t->edge[e][0] == a && t->edge[e][1] == b) ||
            (t->edge[e][0] == b && t->edge[e][1] == a))
            return e;
    assert(false); /* neighbours have an edge between them */
    return 0;
}

static bool share_a_face(const marching_table *t, int e, int other) {
    for (int a = 0; a < 3; a++) {
        bool same = true;
        for (int i = 1; i < 4; i++) {
            const int corner = i < 2 ? t->edge[e][1] : t->edge[other][i - 2];
            same &= (corner >> a & 1) == (t->edge[e][0] >> a & 1);
        }
        if (same)
            return true;
    }
    return false;
}

/* ---- segments of faces, loops of segments ---- */

static bool is_inside(const marching_table *t, int mask, int face, int i) {
    return mask >> t->face[face][i % 4] & 1;
}

/* For each edge where a walk around the face leaves the inside, store where the surface continues.
 * That is the next crossed edge, or the previous one if the inside is not joined. */
static void join_face(const marching_table *t, int mask, int face, bool joined,
                      uint8_t next[MARCHING_EDGES]) {
    for (int i = 0; i < 4; i++) {
        if (!is_inside(t, mask, face, i) || is_inside(t, mask, face, i + 1))
            continue;
        int to = i + (joined ? 1 : 3);
        while (is_inside(t, mask, face, to) == is_inside(t, mask, face, to + 1))
            to += joined ? 1 : 3;
        next[edge_of_face(t, face, i)] = (uint8_t)edge_of_face(t, face, to);
    }
}

/* Remove the loop that starts at an edge. Returns the number of its edges. */
static int take_loop(uint8_t next[MARCHING_EDGES], int edge, uint8_t loop[MARCHING_EDGES]) {
    int count = 0;
    while (next[edge] != NO_EDGE) {
        const int to = next[edge];
        next[edge] = NO_EDGE;
        loop[count++] = (uint8_t)edge;
        edge = to;
    }
    return count;
}

/* ---- triangles of a loop ---- */

static void add(marching_case *c, int x, int y, int z) {
    const uint8_t corner[3] = {(uint8_t)x, (uint8_t)y, (uint8_t)z};
    memcpy(c->corner[c->triangles++], corner, sizeof corner);
}

static bool may_join(const marching_table *t, const uint8_t *loop, int n, int i, int k) {
    return k - i == 1 || k - i == n - 1 || !share_a_face(t, loop[i], loop[k]);
}

/* Triangulate the part of a loop between the joined edges i and k. Returns false if that is
 * impossible. */
static bool cut(const marching_table *t, const uint8_t *loop, int n, int i, int k,
                marching_case *c) {
    if (k - i < 2)
        return true;
    const int before = c->triangles;
    for (int middle = i + 1; middle < k; middle++) {
        if (!may_join(t, loop, n, i, middle) || !may_join(t, loop, n, middle, k))
            continue;
        add(c, loop[i], loop[middle], loop[k]);
        if (cut(t, loop, n, i, middle, c) && cut(t, loop, n, middle, k, c))
            return true;
        c->triangles = (uint8_t)before;
    }
    return false;
}

static void fill_loop(const marching_table *t, const uint8_t *loop, int n, marching_case *c) {
    if (cut(t, loop, n, 0, n - 1, c))
        return;
    const int centre = MARCHING_EDGES + c->centres++;
    for (int i = 0; i < n; i++)
        add(c, loop[i], loop[(i + 1) % n], centre);
}

static void fill_case(const marching_table *t, int mask, uint32_t joined, marching_case *c) {
    uint8_t next[MARCHING_EDGES], loop[MARCHING_EDGES];
    memset(next, NO_EDGE, sizeof next);
    for (int face = 0; face < 6; face++) {
        const bool asked = t->undecided[mask] >> face & 1;
        join_face(t, mask, face, !asked || (joined & 1), next);
        joined >>= asked;
    }
    for (int edge = 0; edge < MARCHING_EDGES; edge++) {
        const int n = take_loop(next, edge, loop);
        if (n > 0)
            fill_loop(t, loop, n, c);
    }
}

void marching_table_init(marching_table *t) {
    memset(t, 0, sizeof *t);
    number_edges(t);
    number_faces(t);
    int count = 0;
    for (int mask = 0; mask < 256; mask++) {
        for (int face = 0; face < 6; face++)
            if (is_inside(t, mask, face, 0) == is_inside(t, mask, face, 2) &&
                is_inside(t, mask, face, 1) == is_inside(t, mask, face, 3) &&
                is_inside(t, mask, face, 0) != is_inside(t, mask, face, 1))
                t->undecided[mask] |= (uint8_t)(1 << face);
        t->first[mask] = (uint16_t)count;
        const uint32_t ways = 1u << __builtin_popcount(t->undecided[mask]);
        for (uint32_t joined = 0; joined < ways; joined++)
            fill_case(t, mask, joined, &t->cases[count++]);
    }
    assert(count == MARCHING_CASES);
}
