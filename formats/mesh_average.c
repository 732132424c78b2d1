#include "formats/mesh_average.h"

#include "formats/mesh_split.h"

status mesh_average_begin(mesh_average *a, mem *m, uint64_t points) {
    *a = (mesh_average){.m = m, .points = points};
    a->sums = mem_array(m, (size_t)points, sizeof *a->sums);
    a->cells = a->sums ? mem_array(m, (size_t)points, sizeof *a->cells) : NULL;
    return a->cells ? ST_OK : ST_NOMEM;
}

void mesh_average_release(mesh_average *a) {
    if (!a->m)
        return;
    mem_free(a->m, a->sums);
    mem_free(a->m, a->cells);
}

static bool came_before(const uint64_t *ids, int i) {
    for (int k = 0; k < i; k++)
        if (ids[k] == ids[i])
            return true;
    return false;
}

/* The values lie so many places apart. */
static void add(mesh_average *a, mesh_cell kind, const uint64_t *ids, const double *values,
                int step) {
    int count = mesh_split_vertices(kind);
    for (int i = 0; i < count; i++)
        if (ids[i] >= a->points)
            return;
    for (int i = 0; i < count; i++) {
        if (came_before(ids, i))
            continue;
        a->sums[ids[i]] += values[i * step];
        a->cells[ids[i]]++;
    }
}

void mesh_average_add(mesh_average *a, mesh_cell kind, const uint64_t *ids, double value) {
    add(a, kind, ids, &value, 0);
}

void mesh_average_add_each(mesh_average *a, mesh_cell kind, const uint64_t *ids,
                           const float *values) {
    double wide[8];
    for (int i = 0; i < mesh_split_vertices(kind); i++)
        wide[i] = (double)values[i];
    add(a, kind, ids, wide, 1);
}

status mesh_average_feed(const mesh_average *a, mesh_feed *feed) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < a->points; i++)
        st = mesh_feed_value(feed, a->cells[i] ? a->sums[i] / a->cells[i] : 0);
    return st;
}
