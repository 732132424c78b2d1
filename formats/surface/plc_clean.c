#include "formats/surface/plc_clean.h"

#include <math.h>
#include <string.h>

#include "formats/base/hash.h"
#include "formats/base/vec3.h"

#define NONE        UINT32_MAX
#define PLANE_LIMIT 1e-8

/* Returns a power of 2: slots for twice as many keys as there may be. */
static size_t slots_for(size_t keys) {
    size_t slots = 16;
    while (slots < 2 * keys)
        slots *= 2;
    return slots;
}

static uint32_t *empty_table(mem *m, size_t slots) {
    uint32_t *table = mem_array(m, slots, sizeof *table);
    if (table)
        memset(table, 0xff, slots * sizeof *table);
    return table;
}

/* ---- points ---- */

/* Returns the point that is already at this place, or NONE after putting `id` there. */
static uint32_t find_or_add(uint32_t *table, size_t slots, double (*points)[3], uint32_t id) {
    size_t at = hash_bytes(points[id], sizeof *points) & (slots - 1);
    while (table[at] != NONE && memcmp(points[table[at]], points[id], sizeof *points) != 0)
        at = (at + 1) & (slots - 1);
    const uint32_t found = table[at];
    if (found == NONE)
        table[at] = id;
    return found;
}

/* Move the points that stay together. new_id[i]: where point i went. */
static void weld_points(plc *x, bool floats, uint32_t *table, size_t slots, uint32_t *new_id) {
    double(*points)[3] = x->points.data;
    double *values = x->values.data;
    uint32_t kept = 0;
    for (size_t i = 0; i < x->points.count; i++) {
        for (int a = 0; a < 3; a++) {
            const double v = points[i][a];
            points[kept][a] = (floats ? (double)(float)v : v) + 0.0; /* -0 becomes 0 */
        }
        if (x->values.count)
            values[kept] = values[i];
        const uint32_t found = find_or_add(table, slots, points, kept);
        new_id[i] = found == NONE ? kept : found;
        kept += found == NONE;
    }
    x->points.count = kept;
    if (x->values.count)
        x->values.count = kept;
}

static status weld(plc *x, bool floats, plc_report *report) {
    const size_t slots = slots_for(x->points.count), before = x->points.count;
    uint32_t *table = empty_table(x->m, slots);
    uint32_t *new_id = mem_array(x->m, before + 1, sizeof *new_id);
    status st = table && new_id ? ST_OK : ST_NOMEM;
    if (st == ST_OK) {
        weld_points(x, floats, table, slots, new_id);
        uint32_t *corner = x->corners.data;
        for (size_t c = 0; c < x->corners.count; c++)
            corner[c] = new_id[corner[c]];
        report->welded = before - x->points.count;
    }
    mem_free(x->m, table);
    mem_free(x->m, new_id);
    return st;
}

/* ---- facets ---- */

/* Move a polygon's corners to index `to`. If `tidy`, leave out corners that repeat the corner
 * before them. Returns the number of corners moved. */
static size_t move_corners(uint32_t *corner, size_t from, size_t end, size_t to, bool tidy) {
    size_t n = 0;
    for (size_t c = from; c < end; c++)
        if (!tidy || n == 0 || corner[to + n - 1] != corner[c])
            corner[to + n++] = corner[c];
    while (tidy && n > 1 && corner[to + n - 1] == corner[to])
        n--;
    return n;
}

static void sort_three(const uint32_t *from, uint32_t to[3]) {
    memcpy(to, from, 3 * sizeof *to);
    for (int i = 0; i < 3; i++) {
        const int a = i == 1, b = a + 1;
        if (to[a] > to[b]) {
            const uint32_t t = to[a];
            to[a] = to[b];
            to[b] = t;
        }
    }
}

/* Returns whether the triangle whose corners begin at `first` is in the table already; else adds
 * it. */
static bool triangle_known(uint32_t *table, size_t slots, const uint32_t *corner, uint32_t first) {
    uint32_t key[3], other[3];
    sort_three(corner + first, key);
    size_t at = hash_bytes(key, sizeof key) & (slots - 1);
    for (; table[at] != NONE; at = (at + 1) & (slots - 1)) {
        sort_three(corner + table[at], other);
        if (memcmp(key, other, sizeof key) == 0)
            return true;
    }
    table[at] = first;
    return false;
}

/* Where the lists are written. */
typedef struct facet_move {
    size_t facets, polygons, corners, holes; /* written so far */
} facet_move;

/* Move a facet's polygons and holes to the end of the written ones. Returns false if the facet is
 * useless. */
static bool move_facet(plc *x, const plc_facet *f, size_t polygons_end, size_t corners_end,
                       size_t holes_end, facet_move *to) {
    uint32_t *polygon = x->polygons.data, *corner = x->corners.data;
    double(*hole)[3] = x->facet_holes.data;
    const bool single = polygons_end - f->polygon == 1;
    size_t first = polygon[f->polygon];
    for (size_t p = f->polygon; p < polygons_end; p++) {
        const size_t end = p + 1 < polygons_end ? polygon[p + 1] : corners_end;
        const size_t n = move_corners(corner, first, end, to->corners, single);
        if (single && n < 3)
            return false;
        first = end;
        polygon[to->polygons++] = (uint32_t)to->corners;
        to->corners += n;
    }
    for (size_t h = f->hole; h < holes_end; h++)
        memcpy(hole[to->holes++], hole[h], sizeof *hole);
    return true;
}

static void drop_facets(plc *x, uint32_t *table, size_t slots, plc_report *report) {
    plc_facet *facet = x->facets.data;
    facet_move to = {0};
    for (size_t f = 0; f < x->facets.count; f++) {
        const size_t polygons_end = plc_polygons_end(x, f);
        const size_t corners_end = plc_corners_begin(x, polygons_end);
        const size_t holes_end = plc_facet_holes_end(x, f);
        const facet_move before = to;
        if (!move_facet(x, &facet[f], polygons_end, corners_end, holes_end, &to)) {
            report->flat++;
            to = before;
        } else if (to.polygons - before.polygons == 1 && to.corners - before.corners == 3 &&
                   triangle_known(table, slots, x->corners.data, (uint32_t)before.corners)) {
            report->repeated++;
            to = before;
        } else {
            facet[to.facets++] =
                (plc_facet){facet[f].number, (uint32_t)before.polygons, (uint32_t)before.holes};
        }
    }
    x->facets.count = to.facets;
    x->polygons.count = to.polygons;
    x->corners.count = to.corners;
    x->facet_holes.count = to.holes;
}

status plc_clean(plc *x, bool floats, plc_report *report) {
    *report = (plc_report){0};
    status st = weld(x, floats, report);
    if (st != ST_OK || x->facets.count == 0)
        return st;
    const size_t slots = slots_for(x->facets.count);
    uint32_t *table = empty_table(x->m, slots);
    if (!table)
        return ST_NOMEM;
    drop_facets(x, table, slots, report);
    mem_free(x->m, table);
    return ST_OK;
}

/* ---- what no mesh can be made of ---- */

/* Returns the largest distance of a point from the span of the points found so far: a point, a
 * line, a plane. `axis` holds 0, 1 or 2 unit vectors at right angles. */
static double farthest(const plc *x, const double (*axis)[3], int axes, size_t *which) {
    double most = -1;
    for (size_t i = 0; i < x->points.count; i++) {
        double d[3];
        vec3_sub(plc_point(x, i), plc_point(x, 0), d);
        for (int a = 0; a < axes; a++) {
            const double along = vec3_dot(d, axis[a]);
            for (int k = 0; k < 3; k++)
                d[k] -= along * axis[a][k];
        }
        const double length = vec3_length(d);
        if (length > most) {
            most = length;
            *which = i;
        }
    }
    return most;
}

status plc_check_solid(const plc *x, const char *file) {
    static const char *const spans[] = {"at one place", "on one line", "in one plane"};
    double axis[3][3], extent = 0;
    if (x->points.count < 4)
        return status_describe(ST_CORRUPT, "%s: %zu different points, expected 4 or more", file,
                               x->points.count);
    for (int axes = 0; axes < 3; axes++) {
        size_t which = 0;
        const double most = farthest(x, (const double(*)[3])axis, axes, &which);
        if (axes == 0)
            extent = most;
        if (!(most > PLANE_LIMIT * extent))
            return status_describe(ST_CORRUPT,
                                   "%s: all %zu points lie %s (to %g of their extent), expected 4 "
                                   "that do not",
                                   file, x->points.count, spans[axes], PLANE_LIMIT);
        vec3_sub(plc_point(x, which), plc_point(x, 0), axis[axes]);
        for (int a = 0; a < axes; a++) {
            const double along = vec3_dot(axis[axes], axis[a]);
            for (int k = 0; k < 3; k++)
                axis[axes][k] -= along * axis[a][k];
        }
        const double length = vec3_length(axis[axes]);
        for (int k = 0; k < 3; k++)
            axis[axes][k] /= length;
    }
    return ST_OK;
}

/* Counts how often each edge is used: 0, 1, or 2 for more. */
typedef struct edge_table {
    uint64_t *key; /* ~0: empty */
    uint8_t *uses;
    size_t slots;
} edge_table;

static uint8_t *edge_uses(edge_table *t, uint32_t a, uint32_t b) {
    const uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    size_t at = hash_bytes(&key, sizeof key) & (t->slots - 1);
    while (t->key[at] != UINT64_MAX && t->key[at] != key)
        at = (at + 1) & (t->slots - 1);
    t->key[at] = key;
    return &t->uses[at];
}

static status open_edge(const plc *x, const char *file, size_t f, uint32_t a, uint32_t b) {
    const double *p = plc_point(x, a), *q = plc_point(x, b);
    return status_describe(ST_CORRUPT,
                           "%s: the surface is open: facet %u (counted from %u) has the edge (%.9g "
                           "%.9g %.9g) to (%.9g %.9g %.9g) alone, expected another facet there",
                           file, plc_facet_at(x, f)->number + x->counted_from, x->counted_from,
                           p[0], p[1], p[2], q[0], q[1], q[2]);
}

/* Go round all polygons: to count the edges, then to find an edge that is used once. */
static status go_round(const plc *x, const char *file, edge_table *t, bool count) {
    const uint32_t *corner = x->corners.data;
    for (size_t f = 0; f < x->facets.count; f++)
        for (size_t p = plc_facet_at(x, f)->polygon; p < plc_polygons_end(x, f); p++) {
            const size_t begin = plc_corners_begin(x, p), end = plc_corners_begin(x, p + 1);
            for (size_t c = begin; c < end && end - begin > 2; c++) {
                const uint32_t next = corner[c + 1 < end ? c + 1 : begin];
                uint8_t *uses = edge_uses(t, corner[c], next);
                if (count)
                    *uses = *uses ? 2 : 1;
                else if (*uses == 1)
                    return open_edge(x, file, f, corner[c], next);
            }
        }
    return ST_OK;
}

status plc_check_closed(const plc *x, const char *file) {
    edge_table t = {.slots = slots_for(x->corners.count)};
    t.key = mem_array(x->m, t.slots, sizeof *t.key);
    t.uses = mem_array(x->m, t.slots, 1);
    status st = t.key && t.uses ? ST_OK : ST_NOMEM;
    if (st == ST_OK) {
        memset(t.key, 0xff, t.slots * sizeof *t.key);
        st = go_round(x, file, &t, true);
    }
    if (st == ST_OK)
        st = go_round(x, file, &t, false);
    mem_free(x->m, t.key);
    mem_free(x->m, t.uses);
    return st;
}
