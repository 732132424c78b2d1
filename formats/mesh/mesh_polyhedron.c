#include "formats/mesh/mesh_polyhedron.h"

#include <stdlib.h>
#include <string.h>

enum { QUAD = 4 };

const char *mesh_polyhedron_fault(const mesh_polyhedron *p) {
    size_t at = 0;
    if (p->faces < 4)
        return "has less than four faces";
    for (size_t i = 0; i < p->faces; i++) {
        if (at >= p->size)
            return "has fewer faces than it says";
        if (p->stream[at] < 3)
            return "has a face with less than three corners";
        if (p->stream[at] > p->size - at - 1)
            return "has a face that ends behind it";
        at += 1 + (size_t)p->stream[at];
    }
    return at == p->size ? NULL : "has more numbers than its faces";
}

/* ---- points ---- */

static int by_place(const void *a, const void *b) {
    const mesh_polyhedron_point *x = a, *y = b;
    for (int i = 0; i < 3; i++)
        if (x->at[i] != y->at[i])
            return x->at[i] < y->at[i] ? -1 : 1;
    return (x->id > y->id) - (x->id < y->id);
}

bool mesh_polyhedron_inside(const mesh_polyhedron *p, uint64_t points) {
    for (size_t at = 0; at < p->size; at += 1 + (size_t)p->stream[at])
        for (uint64_t i = 1; i <= p->stream[at]; i++)
            if (p->stream[at + i] >= points)
                return false;
    return true;
}

/* Look up and sort points. */
static void look_up(const mesh_feed *f, const uint64_t *ids, size_t count,
                    mesh_polyhedron_point *points) {
    for (size_t i = 0; i < count; i++) {
        memcpy(points[i].at, f->kept.xyz[ids[i]], sizeof points[i].at);
        points[i].id = ids[i];
    }
    qsort(points, count, sizeof *points, by_place);
}

static int by_id(const void *a, const void *b) {
    const uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

size_t mesh_polyhedron_ids(const mesh_polyhedron *p, uint64_t *ids) {
    size_t all = 0, count = 0;
    for (size_t at = 0; at < p->size; at += 1 + (size_t)p->stream[at])
        for (uint64_t i = 1; i <= p->stream[at]; i++)
            ids[all++] = p->stream[at + i];
    qsort(ids, all, sizeof *ids, by_id);
    for (size_t i = 0; i < all; i++)
        if (count == 0 || ids[i] != ids[count - 1])
            ids[count++] = ids[i];
    return count;
}

status mesh_polyhedron_reserve(mesh_polyhedron_room *r, const mesh_polyhedron *p) {
    if (p->size <= r->room)
        return ST_OK;
    mesh_polyhedron_release(r);
    r->ids = mem_array(r->m, 2 * p->size, sizeof *r->ids);
    r->points = mem_array(r->m, 2 * p->size, sizeof *r->points);
    if (!r->ids || !r->points)
        return ST_NOMEM;
    r->room = 2 * p->size;
    return ST_OK;
}

void mesh_polyhedron_release(mesh_polyhedron_room *r) {
    mem_free(r->m, r->ids);
    mem_free(r->m, r->points);
    *r = (mesh_polyhedron_room){.m = r->m};
}

/* ---- middles ---- */

/* Feed the mean of points, added up in their order. */
static status feed_mean(mesh_feed *f, uint32_t fields, const mesh_polyhedron_point *points,
                        size_t count) {
    double at[3] = {0, 0, 0};
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            at[a] += (double)points[i].at[a];
    for (int a = 0; a < 3; a++)
        at[a] /= (double)count;
    status st = mesh_feed_point(f, at);
    for (uint32_t k = 0; st == ST_OK && k < fields; k++) {
        const float *values = f->kept.values + k * f->kept.count;
        double sum = 0;
        for (size_t i = 0; i < count; i++)
            sum += (double)values[points[i].id];
        st = mesh_feed_value(f, k, sum / (double)count);
    }
    return st;
}

uint64_t mesh_polyhedron_middles(const mesh_polyhedron *p) {
    uint64_t count = 1;
    for (size_t at = 0; at < p->size; at += 1 + (size_t)p->stream[at])
        count += p->stream[at] > QUAD;
    return count;
}

status mesh_polyhedron_feed_middles(const mesh_polyhedron *p, mesh_feed *f, uint32_t fields,
                                    mesh_polyhedron_room *r) {
    const size_t count = mesh_polyhedron_ids(p, r->ids);
    look_up(f, r->ids, count, r->points);
    status st = feed_mean(f, fields, r->points, count);
    for (size_t at = 0; st == ST_OK && at < p->size; at += 1 + (size_t)p->stream[at]) {
        const size_t corners = (size_t)p->stream[at];
        if (corners <= QUAD)
            continue;
        look_up(f, p->stream + at + 1, corners, r->points);
        st = feed_mean(f, fields, r->points, corners);
    }
    return st;
}

/* ---- cells ---- */

status mesh_polyhedron_feed(const mesh_polyhedron *p, mesh_feed *f, uint64_t first,
                            uint64_t middle) {
    uint64_t of_face = middle + 1;
    status st = ST_OK;
    f->report->polyhedra++;
    for (size_t at = 0; at < p->size; at += 1 + (size_t)p->stream[at]) {
        const size_t corners = (size_t)p->stream[at];
        const uint64_t *ids = p->stream + at + 1;
        if (corners <= QUAD) {
            uint64_t cell[QUAD + 1];
            for (size_t i = 0; i < corners; i++)
                cell[i] = first + ids[corners - 1 - i];
            cell[corners] = middle;
            st = mesh_feed_part(f, corners == QUAD ? CELL_PYRAMID : CELL_TET, cell);
        }
        for (size_t i = 0; corners > QUAD && st == ST_OK && i < corners; i++)
            st = mesh_feed_part(
                f, CELL_TET,
                (uint64_t[]){first + ids[(i + 1) % corners], first + ids[i], of_face, middle});
        of_face += corners > QUAD;
        if (st != ST_OK)
            return st;
    }
    return ST_OK;
}
