#include "prep/mesh_gather.h"

#include <assert.h>
#include <math.h>

void mesh_gather_init(mesh_gather *g, mem *m, const char *beside, size_t ceiling,
                      const progress *p) {
    *g = (mesh_gather){.p = p};
    mesh_spool_init(&g->points, m, beside, sizeof(float[3]), ceiling);
    mesh_spool_init(&g->values, m, beside, sizeof(float), ceiling);
    mesh_spool_init(&g->tets, m, beside, sizeof(uint32_t[4]), ceiling);
    g->points.first_out = g->values.first_out = &g->tets;
    for (int a = 0; a < 3; a++) {
        g->bounds[a] = INFINITY;
        g->bounds[a + 3] = -INFINITY;
    }
}

void mesh_gather_release(mesh_gather *g) {
    if (g->counted)
        return;
    mesh_spool_release(&g->points);
    mesh_spool_release(&g->values);
    mesh_spool_release(&g->tets);
}

size_t mesh_gather_least(void) {
    return mesh_spool_buffers(sizeof(float[3])) + mesh_spool_buffers(sizeof(float)) +
           mesh_spool_buffers(sizeof(uint32_t[4]));
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    mesh_gather *g = ctx;
    assert(first == g->points.count);
    (void)first;
    float *lo = g->bounds, *hi = g->bounds + 3;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            lo[a] = xyz[i][a] < lo[a] ? xyz[i][a] : lo[a];
            hi[a] = xyz[i][a] > hi[a] ? xyz[i][a] : hi[a];
        }
    status st = mesh_spool_append(&g->points, xyz, count);
    return st == ST_OK ? progress_step(g->p, "read", 0) : st;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    mesh_gather *g = ctx;
    assert(first == g->values.count);
    (void)first;
    for (size_t i = 0; i < count; i++)
        g->non_finite += !isfinite(values[i]);
    status st = mesh_spool_append(&g->values, values, count);
    return st == ST_OK ? progress_step(g->p, "read", 0) : st;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    mesh_gather *g = ctx;
    status st = mesh_spool_append(&g->tets, ids, count);
    return st == ST_OK ? progress_step(g->p, "read", 0) : st;
}

mesh_sink mesh_gather_sink(mesh_gather *g) {
    return (mesh_sink){.ctx = g, .points = take_points, .values = take_values, .tets = take_tets};
}

status mesh_gather_end(mesh_gather *g) {
    assert(g->values.count == g->points.count);
    status st = mesh_spool_end(&g->points);
    if (st == ST_OK)
        st = mesh_spool_end(&g->values);
    return st == ST_OK ? mesh_spool_end(&g->tets) : st;
}

/* ---- counting ---- */

static status count_in(mesh_gather *g, mesh_spool *s, size_t count) {
    s->count += count;
    s->chunk_count = (size_t)(s->count >> MESH_SPOOL_LOG2) + 1;
    return progress_step(g->p, "read", 0);
}

static status count_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    mesh_gather *g = ctx;
    (void)first, (void)xyz;
    return count_in(g, &g->points, count);
}

static status count_values(void *ctx, uint64_t first, size_t count, const float *values) {
    mesh_gather *g = ctx;
    (void)first, (void)values;
    return count_in(g, &g->values, count);
}

static status count_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    mesh_gather *g = ctx;
    (void)ids;
    return count_in(g, &g->tets, count);
}

mesh_sink mesh_gather_counter(mesh_gather *g) {
    g->counted = true;
    return (mesh_sink){
        .ctx = g, .points = count_points, .values = count_values, .tets = count_tets};
}
