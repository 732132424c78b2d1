#include "prep/mesh/mesh_gather.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/hexahedron.h"
#include "formats/mesh/mesh_feed.h"

void mesh_gather_init(mesh_gather *g, mem *m, const char *beside, size_t ceiling,
                      const progress *p) {
    *g = (mesh_gather){.corners = 4, .p = p, .fields = 1, .steps = 1, .share = 1};
    mesh_spool_init(&g->points, m, beside, sizeof(float[3]), ceiling);
    mesh_spool_init(&g->values, m, beside, sizeof(float), ceiling);
    mesh_spool_init(&g->tets, m, beside, sizeof(uint32_t[4]), ceiling);
    mesh_spool_init(&g->normals, m, beside, sizeof(uint32_t), ceiling);
    g->points.first_out = g->values.first_out = g->normals.first_out = &g->tets;
    g->points.p = g->values.p = g->tets.p = g->normals.p = p;
    for (int a = 0; a < 3; a++) {
        g->bounds[a] = INFINITY;
        g->bounds[a + 3] = -INFINITY;
    }
}

void mesh_gather_cells(mesh_gather *g, uint32_t corners) {
    g->corners = corners;
    g->tets.element = (uint32_t)(corners * sizeof(uint32_t));
}

void mesh_gather_release(mesh_gather *g) {
    if (g->counted)
        return;
    mesh_spool_release(&g->points);
    mesh_spool_release(&g->values);
    mesh_spool_release(&g->tets);
    mesh_spool_release(&g->normals);
}

size_t mesh_gather_least(const mesh_gather *g, uint32_t fields) {
    return fields * mesh_feed_memory() + mesh_spool_buffers(sizeof(float[3])) +
           mesh_spool_buffers(sizeof(float)) + mesh_spool_buffers(g->tets.element) +
           (g->takes_normals ? mesh_feed_memory() + mesh_spool_buffers(sizeof(uint32_t)) : 0);
}

/* Returns whether this step is the first, whose points and tets all other steps are compared
 * with. */
static bool is_first(const mesh_gather *g) {
    return g->step == 0;
}

static void widen_bounds(mesh_gather *g, size_t count, const float (*xyz)[3]) {
    float *lo = g->bounds, *hi = g->bounds + 3;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            lo[a] = xyz[i][a] < lo[a] ? xyz[i][a] : lo[a];
            hi[a] = xyz[i][a] > hi[a] ? xyz[i][a] : hi[a];
        }
}

/* ---- a further step ---- */

enum { SOME = 512 };

/* What cells are called, in the plural. */
static const char *name_of(const mesh_gather *g) {
    return g->corners == 3 ? "triangles" : g->corners == 4 ? "tets" : "cells";
}

static status too_many(const mesh_gather *g, const char *what, uint64_t expected) {
    return status_describe(ST_CORRUPT, "%s: expected %llu %s, as %s has, found more", g->name,
                           (unsigned long long)expected, what, g->first_name);
}

/* Copy the first step's points for the steps that did not move, and up to point `end` of this
 * step. */
static status catch_up(mesh_gather *g, uint64_t end) {
    float xyz[SOME][3];
    for (uint32_t step = 1; step <= g->step; step++) {
        const uint64_t all = step < g->step ? g->vertices : end;
        for (uint64_t at = 0; at < all; at += SOME) {
            const size_t some = all - at < SOME ? (size_t)(all - at) : SOME;
            status st = mesh_spool_read(&g->points, at, some, xyz);
            if (st == ST_OK)
                st = mesh_spool_append(&g->points, xyz, some);
            if (st != ST_OK)
                return st;
        }
    }
    return ST_OK;
}

/* Count how many points equal the first step's bit by bit. They begin with number `first`. */
static status count_same(mesh_gather *g, uint64_t first, size_t count, const float (*xyz)[3],
                         size_t *same) {
    float before[SOME][3];
    for (*same = 0; *same < count;) {
        const size_t some = count - *same < SOME ? count - *same : SOME;
        status st = mesh_spool_read(&g->points, first + *same, some, before);
        if (st != ST_OK)
            return st;
        if (memcmp(before, xyz + *same, some * sizeof *before) != 0) {
            for (size_t i = 0; memcmp(before[i], xyz[*same], sizeof *before) == 0; i++)
                ++*same;
            return ST_OK;
        }
        *same += some;
    }
    return ST_OK;
}

static status take_moved(mesh_gather *g, uint64_t first, size_t count, const float (*xyz)[3]) {
    size_t same = 0;
    if (count > g->vertices - first)
        return too_many(g, "points", g->vertices);
    if (!g->moving) {
        status st = count_same(g, first, count, xyz, &same);
        if (st != ST_OK || same == count)
            return st;
        st = catch_up(g, first + same);
        if (st != ST_OK)
            return st;
        g->moving = true;
    }
    return mesh_spool_append(&g->points, xyz + same, count - same);
}

static status differs(const mesh_gather *g, uint64_t tet, const uint32_t *now,
                      const uint32_t *before) {
    char text[2][12 * CELL_ROW] = {"", ""};
    const bool quadratic =
        g->corners == CELL_ROW && (cell_row_is_quadratic(now) || cell_row_is_quadratic(before));
    const uint32_t told = g->corners == CELL_ROW && !quadratic ? HEX_CORNERS : g->corners;
    for (uint32_t c = 0; c < told; c++)
        for (int k = 0; k < 2; k++) {
            const size_t end = strlen(text[k]);
            snprintf(text[k] + end, sizeof text[k] - end, "%s%u", c ? ", " : "",
                     (k ? before : now)[c]);
        }
    const char *what = name_of(g);
    return status_describe(ST_CORRUPT,
                           "%s: %.*s %llu has the vertices %s, expected %s as in %s: the %s of a "
                           "series must be the same at each step",
                           g->name, (int)strlen(what) - 1, what, (unsigned long long)tet, text[0],
                           text[1], g->first_name, what);
}

/* ids: g->corners of each. */
static status check_tets(mesh_gather *g, size_t count, const uint32_t *ids) {
    uint32_t before[SOME * CELL_ROW];
    const size_t each = g->corners, bytes = each * sizeof *ids;
    if (count > g->tets.count - g->tets_seen)
        return too_many(g, name_of(g), g->tets.count);
    for (size_t at = 0; at < count; at += SOME) {
        const size_t some = count - at < SOME ? count - at : SOME;
        status st = mesh_spool_read(&g->tets, g->tets_seen + at, some, before);
        if (st != ST_OK)
            return st;
        for (size_t i = 0; i < some; i++)
            if (memcmp(before + each * i, ids + each * (at + i), bytes) != 0)
                return differs(g, g->tets_seen + at + i, ids + each * (at + i), before + each * i);
    }
    return ST_OK;
}

/* ---- taking ---- */

/* Report progress over all readings. */
static status tell(const mesh_gather *g) {
    const double done = g->step + (g->reading ? mesh_input_share(g->reading) : 0);
    return progress_step(g->p, "read", g->share * done / g->steps);
}

static status take_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    mesh_gather *g = ctx;
    status st = ST_OK;
    assert(first == g->points_seen);
    if (is_first(g)) {
        widen_bounds(g, count, xyz);
        st = mesh_spool_append(&g->points, xyz, count);
        g->vertices += count;
    } else {
        st = take_moved(g, first, count, xyz);
    }
    g->points_seen += count;
    return st == ST_OK ? tell(g) : st;
}

static status take_values(void *ctx, uint64_t first, size_t count, const float *values) {
    mesh_gather *g = ctx;
    const uint64_t all = g->vertices * g->fields;
    for (size_t i = 0; i < count; i++)
        g->non_finite += !isfinite(values[i]);
    g->values_seen += count;
    if (!is_first(g) && (first >= all || count > all - first))
        return too_many(g, "values", all);
    status st = mesh_spool_put(&g->values, g->step * all + first, values, count);
    return st == ST_OK ? tell(g) : st;
}

static status take_normals(void *ctx, uint64_t first, size_t count, const uint32_t *codes) {
    mesh_gather *g = ctx;
    (void)first;
    g->normals_seen += count;
    if (!is_first(g) && (g->normals.count == 0 || g->normals_seen > g->vertices))
        return g->normals.count == 0 ? ST_OK : too_many(g, "normals", g->vertices);
    const status st = mesh_spool_append(&g->normals, codes, count);
    return st == ST_OK ? tell(g) : st;
}

static status take_ids(mesh_gather *g, size_t count, const uint32_t *ids) {
    status st = ST_OK;
    if (is_first(g))
        st = mesh_spool_append(&g->tets, ids, count);
    else
        st = check_tets(g, count, ids);
    g->tets_seen += count;
    return st == ST_OK ? tell(g) : st;
}

static status take_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    return take_ids(ctx, count, ids[0]);
}

static status take_triangles(void *ctx, size_t count, const uint32_t (*ids)[3]) {
    return take_ids(ctx, count, ids[0]);
}

static status take_cells(void *ctx, size_t count, const uint32_t (*ids)[CELL_ROW]) {
    return take_ids(ctx, count, ids[0]);
}

mesh_sink mesh_gather_sink(mesh_gather *g) {
    return (mesh_sink){.ctx = g,
                       .points = take_points,
                       .values = take_values,
                       .tets = take_tets,
                       .triangles = g->corners == 3 ? take_triangles : NULL,
                       .normals = g->takes_normals ? take_normals : NULL,
                       .cells = g->corners == CELL_ROW ? take_cells : NULL};
}

void mesh_gather_next(mesh_gather *g, uint32_t step, const char *name) {
    assert(step < g->steps);
    g->step = step;
    g->name = name;
    if (step == 0)
        g->first_name = name;
    g->points_seen = g->values_seen = g->tets_seen = g->normals_seen = 0;
}

status mesh_gather_done(mesh_gather *g) {
    const struct {
        const char *what;
        uint64_t found, expected;
    } counts[] = {{"points", g->points_seen, g->vertices},
                  {"values", g->values_seen, g->vertices * g->fields},
                  {name_of(g), g->tets_seen, g->tets.count},
                  {"normals", g->normals_seen, g->vertices}};
    /* Normals are looked at where the first step has some. */
    for (int i = 0; i < (g->takes_normals && g->normals.count > 0 ? 4 : 3); i++)
        if (counts[i].found != counts[i].expected)
            return status_describe(ST_CORRUPT, "%s: expected %llu %s, as %s has, found %llu",
                                   g->name, (unsigned long long)counts[i].expected, counts[i].what,
                                   g->first_name, (unsigned long long)counts[i].found);
    g->done = g->step + 1;
    return ST_OK;
}

status mesh_gather_read(mesh_gather *g, mesh_input *x, const mesh_sink *sink, mesh_report *report) {
    g->reading = x;
    status st = mesh_input_read(x, sink, report);
    g->reading = NULL;
    return st;
}

/* ---- for another run ---- */

void mesh_gather_keep_in(mesh_gather *g, work_folder *work) {
    mesh_spool_keep_in(&g->points, work, WORK_POINTS);
    mesh_spool_keep_in(&g->values, work, WORK_VALUES);
    mesh_spool_keep_in(&g->tets, work, WORK_TETS);
    if (g->corners == 3) /* surfaces have no gradients */
        mesh_spool_keep_in(&g->normals, work, WORK_GRADIENTS);
}

status mesh_gather_store(mesh_gather *g) {
    status st = mesh_spool_store(&g->points);
    if (st == ST_OK)
        st = mesh_spool_store(&g->values);
    if (st == ST_OK)
        st = mesh_spool_store(&g->normals);
    return st == ST_OK ? mesh_spool_store(&g->tets) : st;
}

void mesh_gather_unstore(mesh_gather *g) {
    mesh_spool_unstore(&g->points);
    mesh_spool_unstore(&g->values);
    mesh_spool_unstore(&g->tets);
    mesh_spool_unstore(&g->normals);
}

void mesh_gather_files(const mesh_gather *g, out_file *files[WORK_FILES]) {
    files[WORK_POINTS] = mesh_spool_file(&g->points);
    files[WORK_VALUES] = mesh_spool_file(&g->values);
    files[WORK_TETS] = mesh_spool_file(&g->tets);
    if (g->corners == 3)
        files[WORK_GRADIENTS] = mesh_spool_file(&g->normals);
}

/* Whether the spools hold what they must after so many steps. */
static bool fits(const mesh_gather *g) {
    const uint64_t places = g->done == 0 ? 0 : g->moving ? g->done : 1;
    return g->done <= g->steps && g->vertices <= (uint64_t)UINT32_MAX + 1 &&
           g->points.count == places * g->vertices &&
           g->normals.count <= (uint64_t)g->done * g->vertices &&
           g->values.count == (uint64_t)g->done * g->fields * g->vertices;
}

status mesh_gather_keep(mesh_gather *g, state_io *io) {
    uint32_t moving = g->moving;
    status st = STATE_IO(io, g->done);
    if (st == ST_OK)
        st = STATE_IO(io, g->vertices);
    if (st == ST_OK)
        st = STATE_IO(io, g->non_finite);
    if (st == ST_OK)
        st = STATE_IO(io, g->bounds);
    if (st == ST_OK)
        st = STATE_IO(io, moving);
    g->moving = moving != 0;
    if (st == ST_OK)
        st = mesh_spool_keep(&g->points, io);
    if (st == ST_OK)
        st = mesh_spool_keep(&g->values, io);
    if (st == ST_OK)
        st = mesh_spool_keep(&g->tets, io);
    if (st == ST_OK)
        st = mesh_spool_keep(&g->normals, io);
    return st == ST_OK && !fits(g) ? state_io_fault(io) : st;
}

/* ---- counting ---- */

static status count_in(mesh_gather *g, mesh_spool *s, size_t count) {
    s->count += count;
    s->chunk_count = (size_t)(s->count >> MESH_SPOOL_LOG2) + 1;
    return tell(g);
}

/* Count as if all points of a series moved. */
static status count_points(void *ctx, uint64_t first, size_t count, const float (*xyz)[3]) {
    mesh_gather *g = ctx;
    (void)first, (void)xyz;
    g->points_seen += count;
    if (is_first(g))
        g->vertices += count;
    return count_in(g, &g->points, count);
}

static status count_values(void *ctx, uint64_t first, size_t count, const float *values) {
    mesh_gather *g = ctx;
    (void)first, (void)values;
    g->values_seen += count;
    return count_in(g, &g->values, count);
}

static status count_normals(void *ctx, uint64_t first, size_t count, const uint32_t *codes) {
    mesh_gather *g = ctx;
    (void)first, (void)codes;
    g->normals_seen += count;
    return is_first(g) || g->normals.count > 0 ? count_in(g, &g->normals, count) : ST_OK;
}

static status count_ids(mesh_gather *g, size_t count) {
    g->tets_seen += count;
    return is_first(g) ? count_in(g, &g->tets, count) : ST_OK;
}

static status count_tets(void *ctx, size_t count, const uint32_t (*ids)[4]) {
    (void)ids;
    return count_ids(ctx, count);
}

static status count_triangles(void *ctx, size_t count, const uint32_t (*ids)[3]) {
    (void)ids;
    return count_ids(ctx, count);
}

static status count_cells(void *ctx, size_t count, const uint32_t (*ids)[CELL_ROW]) {
    (void)ids;
    return count_ids(ctx, count);
}

mesh_sink mesh_gather_counter(mesh_gather *g) {
    g->counted = true;
    g->moving = g->steps > 1;
    return (mesh_sink){.ctx = g,
                       .points = count_points,
                       .values = count_values,
                       .tets = count_tets,
                       .triangles = g->corners == 3 ? count_triangles : NULL,
                       .normals = g->takes_normals ? count_normals : NULL,
                       .cells = g->corners == CELL_ROW ? count_cells : NULL};
}
