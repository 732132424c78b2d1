#include "prep/mesh/mesh_sah.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Below this many levels mesh_tree.c splits in the middle, whatever the keys. */
enum { BINS = 16, LEVELS = 48 };

typedef struct sah_box {
    float lo[3], hi[3];
} sah_box;

struct mesh_sah {
    mem *m;
    uint32_t treelet_tets, leaf_tets;
    sah_box *boxes; /* of the tets, in the order given */
    uint32_t *order, *spare;
    mesh_record *records;
};

uint64_t mesh_sah_memory(uint32_t treelet_tets) {
    const size_t each = sizeof(sah_box) + 2 * sizeof(uint32_t) + sizeof(mesh_record);
    return sizeof(mesh_sah) + treelet_tets * (uint64_t)each + 1024;
}

status mesh_sah_create(mem *m, uint32_t treelet_tets, uint32_t leaf_tets, mesh_sah **out) {
    mesh_sah *s = mem_zalloc(m, sizeof *s);
    if (!s)
        return ST_NOMEM;
    *s = (mesh_sah){.m = m, .treelet_tets = treelet_tets, .leaf_tets = leaf_tets};
    s->boxes = mem_array(m, treelet_tets, sizeof *s->boxes);
    s->order = mem_array(m, treelet_tets, sizeof *s->order);
    s->spare = mem_array(m, treelet_tets, sizeof *s->spare);
    s->records = mem_array(m, treelet_tets, sizeof *s->records);
    if (!s->boxes || !s->order || !s->spare || !s->records) {
        mesh_sah_destroy(s);
        return ST_NOMEM;
    }
    *out = s;
    return ST_OK;
}

void mesh_sah_destroy(mesh_sah *s) {
    if (!s)
        return;
    mem_free(s->m, s->boxes);
    mem_free(s->m, s->order);
    mem_free(s->m, s->spare);
    mem_free(s->m, s->records);
    mem_free(s->m, s);
}

/* ---- boxes ---- */

static const sah_box EMPTY = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void widen(sah_box *b, const float lo[3], const float hi[3]) {
    for (int a = 0; a < 3; a++) {
        b->lo[a] = lo[a] < b->lo[a] ? lo[a] : b->lo[a];
        b->hi[a] = hi[a] > b->hi[a] ? hi[a] : b->hi[a];
    }
}

/* Half of the box's surface area. */
static double area(const sah_box *b) {
    double d[3];
    for (int a = 0; a < 3; a++)
        d[a] = (double)b->hi[a] - (double)b->lo[a];
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

/* Twice the centre along an axis. */
static double centre(const sah_box *b, int axis) {
    return (double)b->lo[axis] + (double)b->hi[axis];
}

static status make_boxes(mesh_sah *s, const mesh_record *records, size_t count,
                         mesh_pages *points) {
    for (size_t t = 0; t < count; t++) {
        s->boxes[t] = EMPTY;
        s->order[t] = (uint32_t)t;
        for (int c = 0; c < 4; c++) {
            const float *p = mesh_pages_at(points, records[t].id[c]);
            if (!p)
                return points->st;
            widen(&s->boxes[t], p, p);
        }
    }
    return ST_OK;
}

/* ---- where to cut ---- */

typedef struct sah_cut {
    int axis, bin; /* bins before this one go left */
    double lo, per_bin;
    double cost;
} sah_cut;

static int bin_of(const sah_cut *cut, const sah_box *b) {
    const double at = (centre(b, cut->axis) - cut->lo) * cut->per_bin;
    return at < BINS - 1 ? (int)at : BINS - 1;
}

/* Find the best cut along one axis, and store it if it is better than *best. */
static void try_axis(const mesh_sah *s, uint32_t first, uint32_t end, sah_cut along,
                     sah_cut *best) {
    sah_box box[BINS], right = EMPTY, left = EMPTY;
    uint32_t tets[BINS] = {0}, n = 0;
    double right_cost[BINS];
    for (int b = 0; b < BINS; b++)
        box[b] = EMPTY;
    for (uint32_t i = first; i < end; i++) {
        const sah_box *t = &s->boxes[s->order[i]];
        const int b = bin_of(&along, t);
        widen(&box[b], t->lo, t->hi);
        tets[b]++;
    }
    for (int b = BINS - 1; b > 0; b--) {
        n += tets[b];
        widen(&right, box[b].lo, box[b].hi);
        right_cost[b] = n > 0 ? area(&right) * n : -1;
    }
    n = 0;
    for (int b = 1; b < BINS; b++) {
        n += tets[b - 1];
        widen(&left, box[b - 1].lo, box[b - 1].hi);
        if (n == 0 || right_cost[b] < 0)
            continue;
        along.bin = b;
        along.cost = area(&left) * n + right_cost[b];
        if (along.cost < best->cost)
            *best = along;
    }
}

static sah_cut find_cut(const mesh_sah *s, uint32_t first, uint32_t end) {
    sah_cut best = {.cost = INFINITY};
    for (int a = 0; a < 3; a++) {
        double lo = INFINITY, hi = -INFINITY;
        for (uint32_t i = first; i < end; i++) {
            const double c = centre(&s->boxes[s->order[i]], a);
            lo = c < lo ? c : lo;
            hi = c > hi ? c : hi;
        }
        const double per_bin = BINS / (hi - lo);
        if (hi > lo && isfinite(per_bin))
            try_axis(s, first, end, (sah_cut){.axis = a, .lo = lo, .per_bin = per_bin}, &best);
    }
    return best;
}

/* Move left tets before right ones, keeping their order. Returns the index of the first right
 * one. */
static uint32_t part(mesh_sah *s, uint32_t first, uint32_t end, const sah_cut *cut) {
    uint32_t left = first, right = 0;
    for (uint32_t i = first; i < end; i++) {
        const uint32_t t = s->order[i];
        if (bin_of(cut, &s->boxes[t]) < cut->bin)
            s->order[left++] = t;
        else
            s->spare[right++] = t;
    }
    memcpy(s->order + left, s->spare, right * sizeof *s->spare);
    return left;
}

/* ---- the paths ---- */

static void split(mesh_sah *s, uint32_t first, uint32_t end, int level, uint64_t path) {
    sah_cut cut = {.cost = INFINITY};
    if (end - first > s->leaf_tets && level < LEVELS)
        cut = find_cut(s, first, end);
    if (!(cut.cost < INFINITY)) { /* a leaf, or all tets in one place: halve it */
        for (uint32_t i = first; i < end; i++)
            s->records[i].key = path;
        return;
    }
    const uint32_t middle = part(s, first, end, &cut);
    split(s, first, middle, level + 1, path);
    split(s, middle, end, level + 1, path | UINT64_C(1) << (63 - level));
}

status mesh_sah_order(mesh_sah *s, const mesh_record *records, size_t count, mesh_pages *points,
                      const mesh_record **out) {
    assert(count <= s->treelet_tets);
    status st = make_boxes(s, records, count, points);
    if (st != ST_OK)
        return st;
    split(s, 0, (uint32_t)count, 0, 0);
    for (size_t i = 0; i < count; i++)
        memcpy(s->records[i].id, records[s->order[i]].id, sizeof s->records[i].id);
    *out = s->records;
    return ST_OK;
}
