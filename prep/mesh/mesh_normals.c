#include "prep/mesh/mesh_normals.h"

#include <string.h>

enum { BAND_MIN = 1024, SOME = 1024 /* normals written at a time */ };

uint64_t mesh_normals_memory(const mesh_normals_plan *plan) {
    return sizeof(mesh_normals) + vertex_normals_memory((size_t)plan->band) + plan->points_window +
           1024;
}

mesh_normals_plan mesh_normals_plan_make(const mesh_spool *points, uint64_t vertices, bool paged,
                                         uint64_t room) {
    mesh_normals_plan plan = {.band = vertices < BAND_MIN ? vertices : BAND_MIN};
    const uint64_t least = paged ? mesh_pages_least(points) : 0;
    /* Prefer fewer bands: another band costs more than a narrower window does. */
    const uint64_t wide = paged ? room / 4 : 0;
    plan.points_window = paged ? mesh_pages_memory(points, wide > least ? wide : least) : 0;
    for (;;) {
        mesh_normals_plan next = plan;
        next.band = plan.band <= vertices / 2 ? 2 * plan.band : vertices;
        if (next.band == plan.band || mesh_normals_memory(&next) > room)
            break;
        plan = next;
    }
    if (mesh_normals_memory(&plan) > room)
        plan.points_window = least;
    return plan;
}

status mesh_normals_init(mesh_normals *n, mem *m, mesh_spool *points, uint64_t vertices,
                         const mesh_normals_plan *plan) {
    *n = (mesh_normals){.vertices = vertices, .band = plan->band};
    const status st = vertex_normals_init(&n->at, m, (size_t)plan->band);
    return st == ST_OK ? mesh_pages_init(&n->points, points, plan->points_window) : st;
}

void mesh_normals_release(mesh_normals *n) {
    mesh_pages_release(&n->points);
    vertex_normals_release(&n->at);
}

uint64_t mesh_normals_bands(const mesh_normals *n) {
    return (n->vertices + n->band - 1) / n->band;
}

status mesh_normals_begin(mesh_normals *n, uint64_t band, uint64_t point) {
    n->first = band * n->band;
    n->points.first = point;
    vertex_normals_begin(&n->at);
    const uint64_t left = n->vertices - n->first, count = left < n->band ? left : n->band;
    for (uint64_t i = 0; i < count; i++) {
        const void *at = mesh_pages_at(&n->points, n->first + i);
        float p[3];
        if (!at)
            return n->points.st;
        memcpy(p, at, sizeof p);
        vertex_normals_put(&n->at, p);
    }
    return ST_OK;
}

status mesh_normals_add(mesh_normals *n, const mesh_record *records, size_t count) {
    for (size_t i = 0; i < count; i++) {
        float corner[3][3];
        size_t numbers[3];
        for (int k = 0; k < 3; k++) {
            const uint64_t id = records[i].id[k];
            const void *at = mesh_pages_at(&n->points, id);
            if (!at)
                return n->points.st;
            memcpy(corner[k], at, sizeof corner[k]);
            numbers[k] = id >= n->first ? (size_t)(id - n->first) : SIZE_MAX;
        }
        vertex_normals_add(&n->at, (const float(*)[3])corner, numbers);
    }
    return ST_OK;
}

status mesh_normals_end(mesh_normals *n, mesh_spool *to) {
    uint32_t some[SOME];
    status st = ST_OK;
    for (size_t at = 0; st == ST_OK && at < n->at.count; at += SOME) {
        const size_t count = n->at.count - at < SOME ? n->at.count - at : SOME;
        for (size_t i = 0; i < count; i++)
            some[i] = vertex_normals_code(&n->at, at + i);
        st = mesh_spool_append(to, some, count);
    }
    return st;
}
