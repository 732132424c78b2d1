#include "formats/surface/surface_flow.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#include "formats/leaf/triangle_normal.h"

/* ---- pieces ---- */

status surface_flow_piece(surface_flow *f, uint64_t points) {
    f->count = points;
    f->held = f->normals_held = 0;
    for (uint32_t k = 0; f->apart && k < f->choice->taken_count; k++)
        f->columns[k].count = 0;
    return f->averaged ? mesh_average_begin(&f->sums, f->m, points, f->choice->taken_count) : ST_OK;
}

status surface_flow_end_piece(surface_flow *f) {
    status st = f->averaged ? mesh_average_feed(&f->sums, f->feed, 0) : ST_OK;
    mesh_average_release(&f->sums);
    f->sums = (mesh_average){0};
    f->base += f->count;
    return st;
}

/* ---- points ---- */

status surface_flow_point(surface_flow *f, const double xyz[3]) {
    if (!f->apart)
        return mesh_feed_point(f->feed, xyz);
    status st = mem_grow(f->m, &f->xyz, sizeof *f->xyz, f->held, 1024, &f->room);
    for (int a = 0; st == ST_OK && a < 3; a++)
        f->xyz[f->held][a] = (float)xyz[a];
    f->held += st == ST_OK;
    return st;
}

status surface_flow_value(surface_flow *f, uint32_t k, double value) {
    if (!f->apart)
        return mesh_feed_value(f->feed, k, value);
    surface_column *c = &f->columns[k];
    status st = mem_grow(f->m, &c->values, sizeof *c->values, c->count, 1024, &c->room);
    if (st == ST_OK)
        c->values[c->count++] = (float)value;
    return st;
}

/* ---- normals ---- */

static status put_normal(surface_flow *f, uint32_t code) {
    if (!f->apart)
        return mesh_feed_normal(f->feed, code);
    status st =
        mem_grow(f->m, &f->normals, sizeof *f->normals, f->normals_held, 1024, &f->normals_room);
    if (st == ST_OK)
        f->normals[f->normals_held++] = code;
    return st;
}

status surface_flow_normal(surface_flow *f, const double normal[3]) {
    return put_normal(f, triangle_normal_encode(normal));
}

status surface_flow_no_normals(surface_flow *f, uint64_t count) {
    status st = ST_OK;
    for (uint64_t i = 0; st == ST_OK && i < count; i++)
        st = put_normal(f, TRIANGLE_NO_NORMAL);
    return st;
}

/* ---- faces with points of their own ---- */

static double value_of(const surface_flow *f, uint32_t k, uint64_t id, const double *values) {
    return surface_choice_taken(f->choice, k)->of_faces ? values[k]
                                                        : (double)f->columns[k].values[id];
}

static status changed(const surface_flow *f) {
    return status_describe(ST_IO, "%s: changed while it was read", f->feed->name);
}

/* Feed one triangle's points, their values and itself. */
static status feed_apart(surface_flow *f, const uint64_t ids[3], const double *values) {
    status st = ST_OK;
    if (ids[0] == ids[1] || ids[1] == ids[2] || ids[2] == ids[0]) {
        f->feed->report->repeated += !f->dry;
        return ST_OK;
    }
    const uint64_t own[3] = {f->fed, f->fed + 1, f->fed + 2};
    f->fed += 3;
    if (f->dry)
        return ST_OK;
    if (f->fed > f->expected)
        return changed(f);
    for (int c = 0; st == ST_OK && c < 3; c++)
        st = mesh_feed_points(f->feed, (const float(*)[3])f->xyz + ids[c], 1);
    for (uint32_t k = 0; k < f->choice->taken_count; k++)
        for (int c = 0; st == ST_OK && c < 3; c++)
            st = mesh_feed_value(f->feed, k, value_of(f, k, ids[c], values));
    for (int c = 0; st == ST_OK && c < 3 && f->normals_held == f->held; c++)
        st = mesh_feed_normal(f->feed, f->normals[ids[c]]);
    return st == ST_OK ? mesh_feed_triangle(f->feed, own) : st;
}

static status put_apart(surface_flow *f, const uint64_t *ids, size_t corners,
                        const double *values) {
    mesh_polygon_room *s = &f->polygon;
    for (size_t i = 0; i < corners; i++)
        if (ids[i] >= f->held) {
            f->feed->report->bad_indices += !f->dry;
            return ST_OK;
        }
    status st = mesh_polygon_reserve(s, corners);
    for (size_t i = 0; st == ST_OK && i < corners; i++)
        for (int a = 0; a < 3; a++)
            s->xyz[i][a] = (double)f->xyz[ids[i]][a];
    if (st != ST_OK)
        return st;
    const bool fanned = !mesh_polygon_cut(s, corners, true);
    f->feed->report->polygons += !f->dry && corners > 3;
    f->feed->report->fanned += !f->dry && fanned;
    for (size_t i = 0; st == ST_OK && i + 2 < corners; i++) {
        const uint32_t *t = s->cut[i];
        st = feed_apart(f, (const uint64_t[3]){ids[t[0]], ids[t[1]], ids[t[2]]}, values);
    }
    return st;
}

/* ---- faces ---- */

static status put_shared(surface_flow *f, const uint64_t *ids, size_t corners) {
    uint64_t few[8], *moved = few;
    if (f->base == 0 && f->count >= f->feed->points)
        return mesh_feed_polygon(f->feed, ids, corners);
    if (corners > sizeof few / sizeof *few)
        moved = mem_array(f->m, corners, sizeof *moved);
    if (!moved)
        return ST_NOMEM;
    for (size_t i = 0; i < corners; i++)
        moved[i] = ids[i] < f->count ? f->base + ids[i] : UINT64_MAX;
    const status st = mesh_feed_polygon(f->feed, moved, corners);
    if (moved != few)
        mem_free(f->m, moved);
    return st;
}

void surface_flow_skip(surface_flow *f, uint64_t count) {
    f->feed->report->skipped += f->dry ? 0 : count;
}

status surface_flow_polygon(surface_flow *f, const uint64_t *ids, size_t corners,
                            const double *values) {
    if (corners < 3) {
        surface_flow_skip(f, 1);
        return ST_OK;
    }
    if (f->apart)
        return put_apart(f, ids, corners, values);
    for (uint32_t k = 0; f->averaged && k < f->choice->taken_count; k++)
        mesh_average_add_points(&f->sums, k, ids, corners, values[k]);
    return put_shared(f, ids, corners);
}

/* Every other triangle of a strip turns the other way. */
status surface_flow_strip(surface_flow *f, surface_strip *s, uint64_t id, const double *values) {
    status st = ST_OK;
    if (s->count >= 2) {
        const bool odd = s->count % 2;
        st = surface_flow_polygon(f, (const uint64_t[3]){s->ids[odd], s->ids[!odd], id}, 3, values);
    }
    s->ids[0] = s->ids[1];
    s->ids[1] = id;
    s->count++;
    return st;
}

/* ---- the surface ---- */

void surface_flow_expect_polygons(const surface_choice *choice, mesh_feed *feed) {
    if (!surface_choice_apart(choice)) /* else all points are kept */
        mesh_feed_keep_corners(feed);
}

static void release(surface_flow *f) {
    mesh_average_release(&f->sums);
    mem_free(f->m, f->xyz);
    mem_free(f->m, f->normals);
    for (uint32_t k = 0; f->columns && k < f->choice->taken_count; k++)
        mem_free(f->m, f->columns[k].values);
    mem_free(f->m, f->columns);
    mesh_polygon_release(&f->polygon);
}

static status run(surface_flow *f, surface_pass *pass, void *state) {
    status st = ST_OK;
    if (f->apart) {
        f->columns = mem_array(f->m, f->choice->taken_count, sizeof *f->columns);
        st = f->columns ? ST_OK : ST_NOMEM;
    }
    if (st == ST_OK)
        st = pass(state, f);
    release(f);
    return st;
}

/* Count the points of all triangles, where several fields need to know. */
static status count_apart(const surface_flow *f, bool again, surface_pass *pass, void *state,
                          uint64_t *points) {
    surface_flow dry = *f;
    dry.dry = true;
    if (!again)
        return status_describe(ST_UNSUPPORTED,
                               "%s: several fields, of which one is of the faces: these are read "
                               "twice, so from a file alone",
                               f->feed->name);
    status st = run(&dry, pass, state);
    *points = dry.fed;
    return st;
}

status surface_flow_run(const surface_choice *choice, mesh_feed *feed, uint64_t points, bool again,
                        surface_pass *pass, void *state) {
    const bool averaged = choice->source->hints.cells_to_points && choice->taken_count > 0;
    surface_flow f = {.feed = feed,
                      .choice = choice,
                      .m = feed->m,
                      .apart = surface_choice_apart(choice),
                      .averaged = averaged,
                      .expected = UINT64_MAX,
                      .polygon = {.m = feed->m}};
    status st = ST_OK;
    if (choice->taken_count > 0)
        snprintf(feed->report->field, sizeof feed->report->field, "%s",
                 surface_choice_taken(choice, 0)->name);
    if (f.apart && choice->taken_count > 1) {
        st = count_apart(&f, again, pass, state, &points);
        f.expected = points;
    } else if (f.apart) {
        points = UINT64_MAX;
    }
    if (st == ST_OK && points != UINT64_MAX)
        st = mesh_feed_expect(feed, points);
    else if (st == ST_OK && feed->fields > 1)
        return status_describe(ST_UNSUPPORTED,
                               "%s: several fields, expected one: the file does not "
                               "tell how many points it has",
                               feed->name);
    else if (st == ST_OK)
        mesh_feed_expect_open(feed, choice->source->data);
    if (st == ST_OK)
        st = run(&f, pass, state);
    if (st == ST_OK && f.expected != UINT64_MAX && f.fed < f.expected)
        st = changed(&f);
    return st == ST_OK && choice->taken_count == 0 ? mesh_feed_zeros(feed) : st;
}
