#include "prep/tetrahedralize/tetrahedralize.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/exact.h"
#include "formats/base/pool.h"
#include "formats/mesh/mesh_stream.h"
#include "prep/tetrahedralize/tetgen_job.h"
#include "prep/tetrahedralize/triangle_tree.h"

enum { BATCH = 4096 };

/* State of one job. */
typedef struct work {
    mem *m;
    const tetrahedralize_options *options;
    const progress *progress;
    tetrahedralize_report *report;
    const char *file; /* for messages */
    plc input;
    bool distance; /* is the field */
    tetgen_job job;
    float (*xyz)[3]; /* of the mesh, rounded as written */
    float *values;
} work;

/* ---- the input ---- */

static status check_options(const work *w) {
    if (w->report->surface)
        return ST_OK;
    if (w->options->meshing)
        return status_describe(ST_USAGE,
                               "%s: --quality and --max-volume are of surfaces: points alone have "
                               "one Delaunay mesh",
                               w->file);
    if (w->options->field && !w->input.field[0])
        return status_describe(ST_USAGE,
                               "%s: the distance is of surfaces: points have the fields of their "
                               "file",
                               w->file);
    return ST_OK;
}

static uint64_t memory_of(const tetrahedralize_options *o) {
    return o->memory ? o->memory
                     : (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
}

static status check_memory(const work *w) {
    const uint64_t need = tetgen_job_memory(w->input.points.count) + mem_used(w->m);
    if (need <= memory_of(w->options))
        return ST_OK;
    return status_describe(
        ST_NOMEM, "%s: %zu points need about %.0f MiB, expected at most %.0f MiB%s", w->file,
        w->input.points.count, (double)need / 0x1p20, (double)memory_of(w->options) / 0x1p20,
        w->options->memory ? " (--memory)" : "");
}

static status read_input(work *w) {
    const tetrahedralize_options *o = w->options;
    const bool distance = o->field && strcmp(o->field, TETRAHEDRALIZE_DISTANCE) == 0;
    const plc_hints hints = {.field = o->field, .format = o->format, .optional = distance};
    tetrahedralize_report *r = w->report;
    status st = plc_read(w->m, o->input, &hints, &w->input);
    if (st != ST_OK)
        return st;
    if (o->points)
        w->input.facets.count = w->input.polygons.count = w->input.corners.count = 0;
    r->surface = w->input.facets.count > 0;
    w->distance = r->surface && (!o->field || (distance && !w->input.field[0]));
    st = check_options(w);
    if (st == ST_OK)
        st = plc_clean(&w->input, !r->surface, &r->cleaned);
    if (st == ST_OK)
        st = plc_check_solid(&w->input, w->file);
    if (st == ST_OK && r->surface && !w->input.loose)
        st = plc_check_closed(&w->input, w->file);
    r->points_in = w->input.points.count;
    r->facets_in = w->input.facets.count;
    strcpy(r->field, w->distance ? TETRAHEDRALIZE_DISTANCE : w->input.field);
    return st == ST_OK ? check_memory(w) : st;
}

/* ---- meshing ---- */

static status run_tetgen(work *w) {
    const tetrahedralize_options *o = w->options;
    const tetgen_options how = {.file = w->file,
                                .ratio = w->report->surface ? o->ratio : 0,
                                .angle = o->angle,
                                .max_volume = o->max_volume,
                                .memory = memory_of(o) - mem_used(w->m),
                                .seconds = o->seconds,
                                .progress = w->progress};
    status st = tetgen_job_run(&w->job, w->m, &w->input, &how);
    if (st != ST_OK)
        return st;
    if (w->job.tets == 0 || w->job.points < w->input.points.count) {
        /* If a .poly is open, name an edge of the gap. */
        st = w->report->surface ? plc_check_closed(&w->input, w->file) : ST_OK;
        return st != ST_OK
                   ? st
                   : status_describe(ST_CORRUPT, "%s: encloses nothing, expected %s", w->file,
                                     w->report->surface ? "a closed surface" : "points that do");
    }
    w->report->points = w->job.points;
    w->report->tets = w->job.tets;
    return ST_OK;
}

static status round_points(work *w) {
    w->xyz = mem_array(w->m, w->job.points, sizeof *w->xyz);
    w->values = mem_array(w->m, w->job.points, sizeof *w->values);
    if (!w->xyz || !w->values)
        return ST_NOMEM;
    for (size_t i = 0; i < w->job.points; i++)
        for (int a = 0; a < 3; a++)
            w->xyz[i][a] = (float)w->job.xyz[i][a];
    return ST_OK;
}

/* ---- values ---- */

typedef struct near_task {
    const work *w;
    const triangle_tree *tree;
    const uint32_t (*corners)[3];
    const double *given; /* values at the input's points; NULL: compute distances */
    size_t first;        /* first point that needs a value */
} near_task;

static status near_batch(void *ctx, size_t index, int worker) {
    const near_task *t = ctx;
    const work *w = t->w;
    (void)worker;
    size_t i = t->first + index * BATCH;
    const size_t end = w->job.points - i < BATCH ? w->job.points : i + BATCH;
    for (; i < end; i++) {
        const triangle_near near = triangle_tree_nearest(t->tree, w->xyz[i]);
        const uint32_t *c = t->corners[near.triangle];
        double value = near.distance;
        if (t->given)
            value = near.weight[0] * t->given[c[0]] + near.weight[1] * t->given[c[1]] +
                    near.weight[2] * t->given[c[2]];
        w->values[i] = (float)value;
    }
    return progress_step(w->progress, "distances", 0.8);
}

static status run_near(near_task *t, size_t triangles) {
    const work *w = t->w;
    triangle_tree *tree = NULL;
    pool *p = NULL;
    status st = triangle_tree_build(w->m, (const float(*)[3])w->xyz, t->corners, triangles, &tree);
    t->tree = tree;
    if (st == ST_OK)
        st = pool_create(w->m, w->options->threads, &p);
    if (st == ST_OK)
        st = pool_run(p, (w->job.points - t->first + BATCH - 1) / BATCH, near_batch, t);
    pool_destroy(p);
    triangle_tree_free(tree);
    return st;
}

static status set_distances(work *w) {
    near_task t = {.w = w, .corners = (const uint32_t(*)[3])w->job.triangle};
    for (size_t i = 0; i < 3 * w->job.triangles; i++)
        if (w->job.triangle[i / 3][i % 3] >= w->job.points)
            return status_describe(ST_FAILED, "%s: a triangle with a corner that is no point",
                                   w->file);
    return run_near(&t, w->job.triangles);
}

/* Cut the facets' polygons into fans of triangles. */
static size_t make_fans(const plc *x, uint32_t (*corners)[3]) {
    const uint32_t *corner = x->corners.data;
    size_t n = 0;
    for (size_t p = 0; p < x->polygons.count; p++) {
        const size_t begin = plc_corners_begin(x, p), end = plc_corners_begin(x, p + 1);
        for (size_t c = begin + 1; c + 1 < end; c++, n++)
            memcpy(corners[n], (uint32_t[3]){corner[begin], corner[c], corner[c + 1]},
                   sizeof *corners);
    }
    return n;
}

/* Points of a surface keep their values. Points that TetGen added get the value of the nearest
 * place on it. */
static status set_field(work *w) {
    const double *given = w->input.values.data;
    const size_t first = w->input.points.count;
    for (size_t i = 0; i < first; i++)
        w->values[i] = (float)given[i];
    if (w->job.points == first)
        return ST_OK;
    uint32_t(*corners)[3] = mem_array(w->m, w->input.corners.count, sizeof *corners);
    near_task t = {
        .w = w, .corners = (const uint32_t(*)[3])corners, .given = given, .first = first};
    status st = corners ? run_near(&t, make_fans(&w->input, corners)) : ST_NOMEM;
    mem_free(w->m, corners);
    return st;
}

static status set_values(work *w) {
    if (w->distance)
        return set_distances(w);
    return w->report->field[0] ? set_field(w) : ST_OK; /* else: zeros */
}

/* ---- the output ---- */

/* Six times the signed volume; 0 if and only if the tet is flat. */
static double six_volumes(const float (*xyz)[3], const uint32_t tet[4]) {
    double p[4][3];
    for (int c = 0; c < 4; c++)
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)xyz[tet[c]][a];
    return exact_volume((const double(*)[3])p);
}

typedef struct tally {
    uint64_t positive, negative;
    double volume;
    uint8_t *used; /* a byte per point */
} tally;

static void count_tet(const work *w, tally *t, const uint32_t tet[4]) {
    const double six = six_volumes((const float(*)[3])w->xyz, tet);
    t->positive += six > 0;
    t->negative += six < 0;
    t->volume += six / 6;
    for (int c = 0; c < 4; c++)
        t->used[tet[c]] = 1;
}

static void sum_up(const work *w, const tally *t) {
    tetrahedralize_report *r = w->report;
    r->volume = fabs(t->volume);
    r->flat = r->tets - (t->positive > t->negative ? t->positive : t->negative);
    for (size_t i = 0; i < w->job.points; i++)
        r->unused += !t->used[i];
}

static status write_tets(work *w, mesh_stream_writer *out, tally *t) {
    uint32_t(*tets)[4] = mem_array(w->m, BATCH, sizeof *tets);
    status st = tets ? ST_OK : ST_NOMEM;
    for (uint64_t done = 0; st == ST_OK && done < w->job.tets; done += BATCH) {
        const size_t n = w->job.tets - done < BATCH ? (size_t)(w->job.tets - done) : BATCH;
        st = tetgen_job_tets(&w->job, tets, n);
        for (size_t i = 0; st == ST_OK && i < n; i++)
            count_tet(w, t, tets[i]);
        if (st == ST_OK)
            st = mesh_stream_tets(out, n, (const uint32_t(*)[4])tets);
        if (st == ST_OK)
            st = progress_step(w->progress, "writing",
                               0.9 + 0.1 * (double)done / (double)w->job.tets);
    }
    mem_free(w->m, tets);
    return st;
}

static status write_mesh(work *w) {
    mesh_stream_header header = {.points = w->job.points, .tets = w->job.tets};
    mesh_stream_writer *out = NULL;
    tally t = {.used = mem_zalloc(w->m, w->job.points)};
    strcpy(header.field, w->report->field);
    status st = t.used
                    ? mesh_stream_create(w->m, w->options->output, w->options->force, &header, &out)
                    : ST_NOMEM;
    if (st == ST_OK)
        st = mesh_stream_points(out, w->job.points, (const float(*)[3])w->xyz);
    if (st == ST_OK)
        st = mesh_stream_values(out, w->job.points, w->values);
    if (st == ST_OK)
        st = write_tets(w, out, &t);
    if (st == ST_OK)
        st = mesh_stream_commit(out);
    else
        mesh_stream_discard(out);
    if (st == ST_OK)
        sum_up(w, &t);
    mem_free(w->m, t.used);
    return st;
}

status tetrahedralize(mem *m, const tetrahedralize_options *options, const progress *p,
                      tetrahedralize_report *report) {
    work w = {.m = m,
              .options = options,
              .progress = p,
              .report = report,
              .file = strcmp(options->input, "-") == 0 ? "standard input" : options->input};
    *report = (tetrahedralize_report){0};
    status st = tetgen_job_available();
    if (st == ST_OK)
        st = progress_step(p, "reading", 0);
    if (st == ST_OK)
        st = read_input(&w);
    if (st == ST_OK)
        st = run_tetgen(&w);
    if (st == ST_OK)
        st = round_points(&w);
    if (st == ST_OK)
        st = set_values(&w);
    if (st == ST_OK)
        st = write_mesh(&w);
    tetgen_job_end(&w.job);
    mem_free(m, w.xyz);
    mem_free(m, w.values);
    plc_release(&w.input);
    return st;
}
