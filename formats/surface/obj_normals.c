#include "formats/surface/obj_normals.h"

#include "formats/leaf/triangle_normal.h"

#define LAST UINT32_MAX

void obj_normals_begin(obj_normals *n, mem *m, surface_flow *flow, bool coloured) {
    *n = (obj_normals){.m = m, .coloured = coloured};
    n->flow = mesh_feed_takes_normals(flow->feed) ? flow : NULL;
}

void obj_normals_release(obj_normals *n) {
    mem_free(n->m, n->codes);
    mem_free(n->m, n->xyz);
    mem_free(n->m, n->colours);
    mem_free(n->m, n->points);
    mem_free(n->m, n->first);
    *n = (obj_normals){.m = n->m};
}

/* ---- points ---- */

static void drop_points(obj_normals *n) {
    mem_free(n->m, n->xyz);
    mem_free(n->m, n->colours);
    n->xyz = NULL;
    n->colours = NULL;
    n->unkept = true;
}

/* Whether another point may be kept. Once there are normals it must be. */
static bool has_room(const obj_normals *n) {
    const size_t used = mem_used(n->m), left = n->m->limit > used ? n->m->limit - used : 0;
    const size_t more = 3 * n->xyz_room * (sizeof *n->xyz + (n->coloured ? sizeof(double) : 0));
    return n->count > 0 || n->m->limit == 0 || n->held < n->xyz_room || more <= left / 8;
}

static status keep_point(obj_normals *n, const double xyz[3], double colour) {
    status st = mem_grow(n->m, &n->xyz, sizeof *n->xyz, n->held, 1024, &n->xyz_room);
    if (st == ST_OK && n->coloured)
        st = mem_grow(n->m, &n->colours, sizeof *n->colours, n->held, 1024, &n->colour_room);
    if (st != ST_OK)
        return st;
    for (int a = 0; a < 3; a++)
        n->xyz[n->held][a] = (float)xyz[a];
    if (n->coloured)
        n->colours[n->held] = colour;
    n->held++;
    return ST_OK;
}

/* Give all points that are there what those of files with normals have. */
static status catch_up(obj_normals *n) {
    status st = ST_OK;
    while (st == ST_OK && n->points_count < n->held) {
        st = mem_grow(n->m, &n->points, sizeof *n->points, n->points_count, 1024, &n->points_room);
        if (st == ST_OK)
            n->points[n->points_count++] = (obj_point){TRIANGLE_NO_NORMAL, false, LAST};
    }
    return st;
}

/* Begin with normals: so far each vertex has one point. */
static status begin_normals(obj_normals *n) {
    if (n->unkept)
        return status_describe(ST_NOMEM,
                               "%s: the memory budget is too small for its %zu points with "
                               "normals; convert --normals flat leaves these out",
                               n->flow->feed->name, n->held);
    n->first = mem_array(n->m, n->held + 1, sizeof *n->first);
    if (!n->first)
        return ST_NOMEM;
    n->first_room = n->held + 1;
    for (n->vertices = 0; n->vertices < n->held; n->vertices++)
        n->first[n->vertices] = (uint32_t)n->vertices;
    return catch_up(n);
}

status obj_normals_vertex(obj_normals *n, const double xyz[3], double colour) {
    if (!n->flow || n->unkept)
        return ST_OK;
    if (!has_room(n)) {
        drop_points(n);
        return ST_OK;
    }
    status st = keep_point(n, xyz, colour);
    if (st != ST_OK || n->count == 0)
        return st;
    st = mem_grow(n->m, &n->first, sizeof *n->first, n->vertices, 1024, &n->first_room);
    if (st == ST_OK)
        n->first[n->vertices++] = (uint32_t)(n->held - 1);
    return st == ST_OK ? catch_up(n) : st;
}

status obj_normals_add(obj_normals *n, const double normal[3]) {
    if (!n->flow)
        return ST_OK;
    status st = mem_grow(n->m, &n->codes, sizeof *n->codes, n->count, 1024, &n->code_room);
    if (st == ST_OK)
        n->codes[n->count++] = triangle_normal_encode(normal);
    return st == ST_OK && n->count == 1 ? begin_normals(n) : st;
}

/* ---- corners ---- */

/* Put another point at the place of one that is there. */
static status add_point(obj_normals *n, uint32_t last, uint32_t code) {
    const float *from = n->xyz[last];
    const double xyz[3] = {(double)from[0], (double)from[1], (double)from[2]},
                 colour = n->coloured ? n->colours[last] : 0;
    status st = surface_flow_point(n->flow, xyz);
    for (uint32_t k = 0; st == ST_OK && k < n->flow->choice->taken_count; k++)
        st = surface_flow_value(n->flow, k, colour);
    if (st == ST_OK)
        st = keep_point(n, xyz, colour);
    if (st == ST_OK)
        st = catch_up(n);
    if (st != ST_OK)
        return st;
    n->points[last].next = (uint32_t)(n->held - 1);
    n->points[n->held - 1].normal = code;
    n->points[n->held - 1].has = true;
    return ST_OK;
}

status obj_normals_point(obj_normals *n, uint64_t vertex, uint64_t normal, uint64_t *point) {
    *point = vertex;
    if (n->count == 0 || vertex >= n->vertices)
        return ST_OK;
    const uint32_t code = normal < n->count ? n->codes[normal] : TRIANGLE_NO_NORMAL;
    uint32_t at = n->first[vertex];
    if (!n->points[at].has) {
        n->points[at].normal = code;
        n->points[at].has = true;
    }
    while (n->points[at].normal != code && n->points[at].next != LAST)
        at = n->points[at].next;
    status st = ST_OK;
    if (n->points[at].normal != code) {
        st = add_point(n, at, code);
        at = (uint32_t)(n->held - 1);
    }
    *point = at;
    return st;
}

status obj_normals_end(obj_normals *n) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && n->count > 0 && i < n->held; i++)
        st = mesh_feed_normal(n->flow->feed, n->points[i].normal);
    return st;
}
