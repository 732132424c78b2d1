#include "formats/mesh/mesh_feed.h"
#include "formats/base/quadratic_tet.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "formats/leaf/leaf_place.h"
#include "formats/mesh/mesh_split.h"

status mesh_feed_begin(mesh_feed *f, mem *m, const char *name, uint32_t fields,
                       const mesh_sink *sink, mesh_report *report) {
    *f = (mesh_feed){.m = m, .name = name, .sink = sink, .report = report, .fields = fields};
    *report = (mesh_report){0};
    for (int a = 0; a < 3; a++) {
        f->bounds[a] = INFINITY;
        f->bounds[a + 3] = -INFINITY;
    }
    f->xyz = mem_array(m, MESH_FEED_CHUNK, sizeof *f->xyz);
    f->corners.scratch.m = m;
    if (sink->triangles)
        f->triangles = mem_array(m, MESH_FEED_CHUNK, sizeof *f->triangles);
    else if (sink->cells)
        f->whole = mem_array(m, MESH_FEED_CHUNK, sizeof *f->whole);
    else
        f->tets = mem_array(m, MESH_FEED_CHUNK, sizeof *f->tets);
    f->columns = mem_array(m, fields, sizeof *f->columns);
    if (sink->normals && !(f->normals = mem_array(m, MESH_FEED_CHUNK, sizeof *f->normals)))
        return ST_NOMEM;
    if (!f->xyz || !(f->tets || f->whole || f->triangles) || !f->columns)
        return ST_NOMEM;
    for (uint32_t k = 0; k < fields; k++)
        if (!(f->columns[k].values = mem_array(m, MESH_FEED_CHUNK, sizeof(float))))
            return ST_NOMEM;
    return ST_OK;
}

static void forget(mesh_feed *f) {
    mem_free(f->m, f->kept.xyz);
    mem_free(f->m, f->kept.values);
    f->kept = (mesh_feed_kept){.count = 0};
}

void mesh_feed_release(mesh_feed *f) {
    for (uint32_t k = 0; f->columns && k < f->fields; k++)
        mem_free(f->m, f->columns[k].values);
    mem_free(f->m, f->columns);
    mem_free(f->m, f->xyz);
    mem_free(f->m, f->normals);
    mem_free(f->m, f->tets);
    mem_free(f->m, f->whole);
    mem_free(f->m, f->triangles);
    mem_free(f->m, f->corners.xyz);
    mesh_polygon_release(&f->corners.scratch);
    forget(f);
}

status mesh_feed_expect(mesh_feed *f, uint64_t points) {
    if (points > MESH_POINTS_MAX)
        return status_describe(ST_UNSUPPORTED, "%s: %llu points, expected at most %llu", f->name,
                               (unsigned long long)points, (unsigned long long)MESH_POINTS_MAX);
    f->points = points;
    return ST_OK;
}

void mesh_feed_expect_open(mesh_feed *f, const byte_stream *by) {
    assert(f->fields == 1);
    f->points = MESH_POINTS_MAX;
    f->open = by;
}

/* All points have come. */
static void settle(mesh_feed *f) {
    if (f->open)
        f->points = f->points_given + f->points_held;
    f->open = NULL;
}

void mesh_feed_expect_cells(mesh_feed *f, uint64_t cells) {
    f->cells += cells;
}

static double share_of(const byte_stream *s) {
    const uint64_t left = byte_stream_left(s), taken = byte_stream_position(s);
    return left == UINT64_MAX ? 0 : (double)taken / ((double)taken + (double)left + 1);
}

double mesh_feed_share(const mesh_feed *f) {
    if (f->open)
        return share_of(f->open);
    const double point = sizeof *f->xyz, value = sizeof(float),
                 cell = f->triangles ? sizeof *f->triangles
                        : f->whole   ? sizeof *f->whole
                                     : sizeof *f->tets;
    const double cells = f->cells ? (double)f->cells : 5 * (double)f->points;
    const double all = (point + value * f->fields) * (double)f->points + cell * cells;
    double seen =
        point * (double)f->points_given + cell * (double)(f->cells_seen + f->report->skipped);
    for (uint32_t k = 0; k < f->fields; k++)
        seen += value * (double)f->columns[k].given;
    return seen < all ? seen / all : f->points > 0;
}

/* ---- points and values ---- */

static status flush_points(mesh_feed *f) {
    size_t count = f->points_held;
    if (count == 0)
        return ST_OK;
    uint64_t first = f->points_given;
    f->points_given += count;
    f->points_held = 0;
    f->report->points += count;
    return f->sink->points(f->sink->ctx, first, count, (const float(*)[3])f->xyz);
}

static status flush_values(mesh_feed *f, uint32_t field) {
    mesh_feed_column *c = &f->columns[field];
    const size_t count = c->held;
    const uint64_t first = field * f->points + c->given;
    if (count == 0)
        return ST_OK;
    c->given += count;
    c->held = 0;
    return f->sink->values(f->sink->ctx, first, count, c->values);
}

static status flush_normals(mesh_feed *f) {
    const size_t count = f->normals_held;
    const uint64_t first = f->normals_given;
    if (count == 0)
        return ST_OK;
    f->normals_given += count;
    f->normals_held = 0;
    f->report->normals += count;
    return f->sink->normals(f->sink->ctx, first, count, f->normals);
}

status mesh_feed_normal(mesh_feed *f, uint32_t code) {
    assert(f->normals && f->normals_given + f->normals_held < f->points);
    f->normals[f->normals_held++] = code;
    return f->normals_held == MESH_FEED_CHUNK ? flush_normals(f) : ST_OK;
}

status mesh_feed_keep(mesh_feed *f, uint64_t count) {
    forget(f);
    if (count == 0)
        return ST_OK;
    f->kept.xyz = mem_array(f->m, count, sizeof *f->kept.xyz);
    f->kept.values = mem_array(f->m, count * f->fields, sizeof *f->kept.values);
    if (!f->kept.xyz || !f->kept.values)
        return ST_NOMEM;
    f->kept.first = f->points_given + f->points_held;
    f->kept.count = (size_t)count;
    return ST_OK;
}

void mesh_feed_keep_corners(mesh_feed *f) {
    f->corners.wanted = f->triangles != NULL && f->points_given + f->points_held == 0;
}

/* Keep one more point where there is room. The first that is not kept is the last one tried. */
static status keep_corner(mesh_feed *f, const float p[3]) {
    mesh_feed_corners *c = &f->corners;
    if (c->count == c->room) {
        const size_t more = c->room ? 3 * c->room * sizeof *c->xyz : 0, used = mem_used(f->m);
        const size_t left = f->m->limit > used ? f->m->limit - used : 0;
        c->wanted = c->count < MESH_FEED_CORNERS && (f->m->limit == 0 || more <= left / 8);
        if (!c->wanted)
            return ST_OK;
    }
    status st = mem_grow(f->m, &c->xyz, sizeof *c->xyz, c->count, 1024, &c->room);
    if (st == ST_OK)
        memcpy(c->xyz[c->count++], p, sizeof *c->xyz);
    return st;
}

static status keep_point(mesh_feed *f, const float p[3]) {
    uint64_t id = f->points_given + f->points_held;
    assert(id < f->points || f->open);
    if (id >= f->points)
        return mesh_feed_expect(f, id + 1);
    if (!isfinite(p[0]) || !isfinite(p[1]) || !isfinite(p[2]))
        return status_describe(ST_CORRUPT,
                               "%s: point %llu (counted from 0) lies at (%g, %g, %g), expected "
                               "numbers that are finite as float",
                               f->name, (unsigned long long)id, (double)p[0], (double)p[1],
                               (double)p[2]);
    for (int a = 0; a < 3; a++) {
        f->bounds[a] = fminf(f->bounds[a], p[a]);
        f->bounds[a + 3] = fmaxf(f->bounds[a + 3], p[a]);
    }
    if (id - f->kept.first < f->kept.count)
        memcpy(f->kept.xyz[id - f->kept.first], p, sizeof *f->kept.xyz);
    memcpy(f->xyz[f->points_held++], p, sizeof *f->xyz);
    const status st = f->corners.wanted ? keep_corner(f, p) : ST_OK;
    if (st != ST_OK)
        return st;
    return f->points_held == MESH_FEED_CHUNK ? flush_points(f) : ST_OK;
}

status mesh_feed_point(mesh_feed *f, const double xyz[3]) {
    const float p[3] = {(float)xyz[0], (float)xyz[1], (float)xyz[2]};
    for (int a = 0; a < 3; a++)
        f->vanished |= xyz[a] != 0 && p[a] == 0;
    return keep_point(f, p);
}

status mesh_feed_points(mesh_feed *f, const float (*xyz)[3], size_t count) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < count; i++)
        st = keep_point(f, xyz[i]);
    return st;
}

static status keep_value(mesh_feed *f, uint32_t field, float value) {
    mesh_feed_column *c = &f->columns[field];
    assert(field < f->fields && c->given + c->held < f->points);
    const uint64_t at = c->given + c->held - f->kept.first;
    if (at < f->kept.count)
        f->kept.values[field * f->kept.count + at] = value;
    c->values[c->held++] = value;
    return c->held == MESH_FEED_CHUNK ? flush_values(f, field) : ST_OK;
}

status mesh_feed_value(mesh_feed *f, uint32_t field, double value) {
    return keep_value(f, field, (float)value);
}

status mesh_feed_values(mesh_feed *f, uint32_t field, const float *values, size_t count) {
    status st = ST_OK;
    for (size_t i = 0; st == ST_OK && i < count; i++)
        st = keep_value(f, field, values[i]);
    return st;
}

status mesh_feed_zeros(mesh_feed *f) {
    status st = ST_OK;
    settle(f);
    while (st == ST_OK && f->columns[0].given + f->columns[0].held < f->points)
        st = keep_value(f, 0, 0);
    return st;
}

double mesh_feed_magnitude(const double *components, int count, int component) {
    assert(component <= count);
    if (component > 0 || count == 1)
        return components[component > 0 ? component - 1 : 0];
    double sum = 0;
    for (int i = 0; i < count; i++)
        sum += components[i] * components[i];
    return sqrt(sum);
}

/* ---- cells ---- */

static status flush_tets(mesh_feed *f) {
    size_t count = f->tets_held;
    if (count == 0)
        return ST_OK;
    f->tets_held = 0;
    f->report->tets += count;
    if (f->triangles)
        return f->sink->triangles(f->sink->ctx, count, (const uint32_t(*)[3])f->triangles);
    if (f->whole)
        return f->sink->cells(f->sink->ctx, count, (const uint32_t(*)[CELL_ROW])f->whole);
    return f->sink->tets(f->sink->ctx, count, (const uint32_t(*)[4])f->tets);
}

static bool repeats(const uint32_t t[4]) {
    return t[0] == t[1] || t[0] == t[2] || t[0] == t[3] || t[1] == t[2] || t[1] == t[3] ||
           t[2] == t[3];
}

/* Keep one tet whose ids are all valid. */
static status keep_tet(mesh_feed *f, const uint32_t ids[4]) {
    if (repeats(ids)) {
        f->report->repeated++;
        return ST_OK;
    }
    memcpy(f->tets[f->tets_held++], ids, sizeof *f->tets);
    return f->tets_held == MESH_FEED_CHUNK ? flush_tets(f) : ST_OK;
}

static int count_different(const uint32_t *ids, int count) {
    int different = 0;
    for (int i = 0; i < count; i++) {
        int k = 0;
        while (ids[k] != ids[i])
            k++;
        different += k == i;
    }
    return different;
}

/* Keep a cell as it is, whose ids are all valid. A quadratic tet has ten different ones. */
static status keep_whole(mesh_feed *f, cell_shape kind, const uint32_t *ids, bool counts) {
    const uint8_t *vertex = cell_shape_row(kind);
    const int least = kind == CELL_QUADRATIC_TET ? QUADRATIC_NODES : QUADRATIC_CORNERS;
    if (count_different(ids, cell_shape_vertices(kind)) < least) {
        f->report->repeated++;
        return ST_OK;
    }
    f->report->whole[kind] += counts;
    for (int c = 0; c < CELL_ROW; c++)
        f->whole[f->tets_held][c] = ids[vertex[c]];
    return ++f->tets_held == MESH_FEED_CHUNK ? flush_tets(f) : ST_OK;
}

/* Keep a cell whose ids are all valid, as it is or as tets. counts: in the report. */
static status keep_cell(mesh_feed *f, cell_shape kind, const uint32_t *ids, bool counts) {
    uint32_t tets[MESH_SPLIT_TETS][4];
    if (f->whole)
        return keep_whole(f, kind, ids, counts);
    if (kind == CELL_QUADRATIC_TET) {
        f->report->whole[kind] += counts;
        return keep_tet(f, ids);
    }
    if (counts && kind != CELL_TET)
        f->report->split[kind]++;
    const int count = mesh_split(kind, ids, tets);
    status st = ST_OK;
    for (int i = 0; st == ST_OK && i < count; i++)
        st = keep_tet(f, tets[i]);
    return st;
}

status mesh_feed_part(mesh_feed *f, cell_shape kind, const uint64_t *ids) {
    uint32_t small[CELL_VERTICES_MAX];
    for (int i = 0; i < cell_shape_vertices(kind); i++) {
        assert(ids[i] < f->points);
        small[i] = (uint32_t)ids[i];
    }
    return keep_cell(f, kind, small, false);
}

status mesh_feed_cell(mesh_feed *f, cell_shape kind, const uint64_t *ids) {
    uint32_t small[CELL_VERTICES_MAX];
    f->cells_seen++;
    for (int i = 0; i < cell_shape_vertices(kind); i++) {
        if (ids[i] >= f->points) {
            f->report->bad_indices++;
            return ST_OK;
        }
        small[i] = (uint32_t)ids[i];
    }
    return keep_cell(f, kind, small, true);
}

status mesh_feed_tets(mesh_feed *f, const uint32_t (*ids)[4], size_t count) {
    status st = ST_OK;
    f->cells_seen += count;
    for (size_t i = 0; st == ST_OK && i < count; i++) {
        const uint32_t *t = ids[i];
        if (t[0] < f->points && t[1] < f->points && t[2] < f->points && t[3] < f->points)
            st = f->whole ? keep_whole(f, CELL_TET, t, true) : keep_tet(f, t);
        else
            f->report->bad_indices++;
    }
    return st;
}

/* ---- surfaces ---- */

static status keep_triangle(mesh_feed *f, uint64_t a, uint64_t b, uint64_t c) {
    if (a == b || b == c || c == a) {
        f->report->repeated++;
        return ST_OK;
    }
    uint32_t *to = f->triangles[f->tets_held++];
    to[0] = (uint32_t)a;
    to[1] = (uint32_t)b;
    to[2] = (uint32_t)c;
    return f->tets_held == MESH_FEED_CHUNK ? flush_tets(f) : ST_OK;
}

/* Whether all ids may be points'; else the cell is counted as bad. */
static bool are_points(mesh_feed *f, const uint64_t *ids, size_t count) {
    assert(f->triangles); /* the sink takes surfaces */
    f->cells_seen++;
    for (size_t i = 0; i < count; i++)
        if (ids[i] >= f->points) {
            f->report->bad_indices++;
            return false;
        }
    for (size_t i = 0; i < count; i++)
        f->highest = ids[i] > f->highest ? ids[i] : f->highest;
    return true;
}

status mesh_feed_triangle(mesh_feed *f, const uint64_t ids[3]) {
    return are_points(f, ids, 3) ? keep_triangle(f, ids[0], ids[1], ids[2]) : ST_OK;
}

/* Gather the corners of a polygon. Returns whether all are kept. */
static bool gather_corners(mesh_feed *f, const uint64_t *ids, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (ids[i] >= f->corners.count)
            return false;
        for (int a = 0; a < 3; a++)
            f->corners.scratch.xyz[i][a] = (double)f->corners.xyz[ids[i]][a];
    }
    return true;
}

status mesh_feed_polygon(mesh_feed *f, const uint64_t *ids, size_t corners) {
    assert(corners >= 3);
    if (!are_points(f, ids, corners))
        return ST_OK;
    if (corners == 3)
        return keep_triangle(f, ids[0], ids[1], ids[2]);
    mesh_polygon_room *s = &f->corners.scratch;
    status st = mesh_polygon_reserve(s, corners);
    if (st != ST_OK)
        return st;
    f->report->polygons++;
    f->report->fanned += !mesh_polygon_cut(s, corners, gather_corners(f, ids, corners));
    for (size_t i = 0; st == ST_OK && i + 2 < corners; i++)
        st = keep_triangle(f, ids[s->cut[i][0]], ids[s->cut[i][1]], ids[s->cut[i][2]]);
    return st;
}

/* Check the ids of a mesh whose number of points has only now become known. */
static status check_ids(mesh_feed *f) {
    const bool open = f->open;
    settle(f);
    if (!open || f->cells_seen == f->report->bad_indices || f->highest < f->points)
        return ST_OK;
    return status_describe(ST_CORRUPT,
                           "%s: a face of point %llu (counted from 0), expected one of %llu",
                           f->name, (unsigned long long)f->highest, (unsigned long long)f->points);
}

static status check_place(const mesh_feed *f) {
    const float *b = f->bounds;
    char why[LEAF_PLACE_TEXT] = "its points are told apart by less than floats hold: scale it";
    const bool vanished =
        f->vanished && !(b[3] > b[0]) && !(b[4] > b[1]) && !(b[5] > b[2]) && f->points > 0;
    if (!vanished && (f->points == 0 || leaf_place_mesh(b, why)))
        return ST_OK;
    return status_describe(ST_CORRUPT, "%s: %s", f->name, why);
}

status mesh_feed_end(mesh_feed *f) {
    status st = check_ids(f);
    if (st == ST_OK)
        st = check_place(f);
    if (st == ST_OK)
        st = flush_points(f);
    assert(st != ST_OK || f->points_given == f->points);
    for (uint32_t k = 0; st == ST_OK && k < f->fields; k++) {
        st = flush_values(f, k);
        assert(st != ST_OK || f->columns[k].given == f->points);
    }
    if (st == ST_OK)
        st = flush_normals(f);
    assert(st != ST_OK || f->normals_given == 0 || f->normals_given == f->points);
    return st == ST_OK ? flush_tets(f) : st;
}
