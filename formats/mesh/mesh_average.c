#include "formats/mesh/mesh_average.h"

#include <string.h>

#include "formats/mesh/mesh_split.h"

enum { WINDOW_MIN = 1 << 10, WINDOW_MAX = 1 << 24 };

static status begin(mesh_average *a, mem *m, uint64_t points, uint32_t fields, uint64_t room) {
    *a = (mesh_average){
        .m = m, .points = points, .room = (size_t)room, .count = (size_t)room, .fields = fields};
    a->sums = mem_array(m, a->room * fields, sizeof *a->sums);
    a->cells = a->sums ? mem_array(m, a->room * fields, sizeof *a->cells) : NULL;
    return a->cells ? ST_OK : ST_NOMEM;
}

status mesh_average_begin(mesh_average *a, mem *m, uint64_t points, uint32_t fields) {
    return begin(a, m, points, fields, points);
}

status mesh_average_begin_rounds(mesh_average *a, mem *m, uint64_t points, uint32_t fields) {
    uint64_t most = WINDOW_MAX;
    if (m->limit > 0) {
        size_t used = mem_used(m), left = m->limit > used ? m->limit - used : 0;
        size_t fitting = left / 4 / (sizeof *a->sums + sizeof *a->cells);
        most = fitting < most ? fitting : most;
    }
    most /= fields;
    most = most < WINDOW_MIN ? WINDOW_MIN : most;
    return begin(a, m, points, fields, points < most ? points : most);
}

bool mesh_average_next(mesh_average *a) {
    a->first += a->count;
    if (a->first >= a->points)
        return false;
    uint64_t left = a->points - a->first;
    a->count = left < a->room ? (size_t)left : a->room;
    memset(a->sums, 0, a->room * a->fields * sizeof *a->sums);
    memset(a->cells, 0, a->room * a->fields * sizeof *a->cells);
    return true;
}

void mesh_average_release(mesh_average *a) {
    if (!a->m)
        return;
    mem_free(a->m, a->sums);
    mem_free(a->m, a->cells);
}

static void add_one(mesh_average *a, uint32_t field, uint64_t id, double value) {
    const uint64_t at = id - a->first;
    if (id < a->first || at >= a->count)
        return;
    a->sums[field * a->room + at] += value;
    a->cells[field * a->room + at]++;
}

void mesh_average_add_points(mesh_average *a, uint32_t field, const uint64_t *ids, size_t count,
                             double value) {
    for (size_t i = 0; i < count; i++)
        if (ids[i] >= a->points)
            return;
    for (size_t i = 0; i < count; i++)
        add_one(a, field, ids[i], value);
}

static bool came_before(const uint64_t *ids, int i) {
    for (int k = 0; k < i; k++)
        if (ids[k] == ids[i])
            return true;
    return false;
}

/* Vertex i's value is values[i * step]. */
static void add(mesh_average *a, uint32_t field, cell_shape kind, const uint64_t *ids,
                const double *values, int step) {
    int count = cell_shape_vertices(kind);
    for (int i = 0; i < count; i++)
        if (ids[i] >= a->points)
            return;
    for (int i = 0; i < count; i++)
        if (!came_before(ids, i))
            add_one(a, field, ids[i], values[i * step]);
}

void mesh_average_add(mesh_average *a, uint32_t field, cell_shape kind, const uint64_t *ids,
                      double value) {
    add(a, field, kind, ids, &value, 0);
}

void mesh_average_add_each(mesh_average *a, uint32_t field, cell_shape kind, const uint64_t *ids,
                           const float *values) {
    double wide[CELL_VERTICES_MAX];
    for (int i = 0; i < cell_shape_vertices(kind); i++)
        wide[i] = (double)values[i];
    add(a, field, kind, ids, wide, 1);
}

static status feed_field(const mesh_average *a, mesh_feed *feed, uint32_t first, uint32_t field) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < a->count; i++)
        st = mesh_feed_value(feed, first + field, mesh_average_value(a, field, i));
    return st;
}

status mesh_average_feed(const mesh_average *a, mesh_feed *feed, uint32_t first) {
    status st = ST_OK;
    for (uint32_t field = 0; st == ST_OK && field < a->fields; field++)
        st = feed_field(a, feed, first, field);
    return st;
}
