#include "render/bench/bench_hexes.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "formats/base/vec3.h"
#include "render/app/view_camera.h"
#include "render/bench/bench_hex_errors.h"
#include "render/bench/bench_hex_grid.h"
#include "render/experiments/hex_march.h"

static const char HEADINGS[] = "grid|draws|way|ms|+-|fps|Mhexes/s|hexes/ray|entries/ray|tests/hex|"
                               "patches/hex|hits|lost|" BENCH_HEX_ERROR_HEADINGS;

enum { VIEWS = 4 };

/* What a ray looks for. */
typedef union finder {
    hex_surface surface;
    hex_fog fog;
    hex_maximum maximum;
} finder;

typedef struct entrant {
    double *seconds; /* of every run, over all views */
    double median, spread;
    hex_tally tally;        /* of one picture of each view */
    bench_hex_errors wrong; /* of isosurfaces */
} entrant;

typedef struct trial trial;
typedef struct contest {
    const char *draws, *way;
    /* A picture of the view under way. */
    status (*draw)(trial *t, const struct contest *c, entrant *e);
    hex_way by;
    hex_look *look;
    bool exact; /* rows without counts */
} contest;

static status draw_first(trial *t, const contest *c, entrant *e);
static status draw_march(trial *t, const contest *c, entrant *e);
static status draw_rays(trial *t, const contest *c, entrant *e);
static status draw_frame(trial *t, const contest *c, entrant *e);
static status draw_greatest(trial *t, const contest *c, entrant *e);

static const contest CONTESTS[] = {
    {"initial", "kd-tree", draw_first, HEX_PLUECKER, NULL, false},
    {"march", "pluecker", draw_march, HEX_PLUECKER, NULL, false},
    {"march", "hybrid", draw_march, HEX_HYBRID, NULL, false},
    {"iso", "pluecker", draw_march, HEX_PLUECKER, hex_surface_look, false},
    {"iso", "hybrid", draw_march, HEX_HYBRID, hex_surface_look, false},
    {"iso", "exact rays", draw_rays, HEX_WAYS, NULL, true},
    {"iso", "exact frame", draw_frame, HEX_WAYS, NULL, true},
    {"mip", "pluecker", draw_march, HEX_PLUECKER, hex_maximum_look, false},
    {"mip", "hybrid", draw_march, HEX_HYBRID, hex_maximum_look, false},
    {"mip", "exact frame", draw_greatest, HEX_WAYS, NULL, true},
    {"semi", "pluecker", draw_march, HEX_PLUECKER, hex_fog_look, false},
    {"semi", "hybrid", draw_march, HEX_HYBRID, hex_fog_look, false}};
enum { ENTRANTS = sizeof CONTESTS / sizeof *CONTESTS };

struct trial {
    mem *m;
    const bench_subject *subject;
    leafcast *volume;
    hex_lattice lattice;
    hex_boundary boundary;
    double range[2], isovalue;
    leafcast_camera camera; /* of the view under way */
    size_t pixels;
    leafcast_ray *rays;
    leafcast_ray_hit *hits;
    double *value;
    uint64_t exact_hits; /* of all views */
    entrant all[ENTRANTS];
};

/* ---- pictures ---- */

static status draw_first(trial *t, const contest *c, entrant *e) {
    (void)c;
    for (size_t i = 0; i < t->pixels; i++) {
        const double *o = t->rays[i].origin, *d = t->rays[i].direction;
        const sheared_ray r = sheared_ray_of(o, d);
        hex_entry entry;
        e->tally.entries += hex_boundary_next(&t->boundary, &r, o, d, 0.0, &entry);
    }
    return ST_OK;
}

/* Before anything is seen. A sixteenth of the light is lost at a face of the greatest value. */
static finder fresh(const trial *t, hex_look *look) {
    finder f = {.maximum = {-INFINITY}};
    if (look == hex_surface_look)
        f.surface = (hex_surface){.lattice = &t->lattice, .isovalue = t->isovalue};
    else if (look == hex_fog_look)
        f.fog = (hex_fog){
            .low = t->range[0], .rise = 1.0 / (t->range[1] - t->range[0]), .opacity = 1.0 / 16.0};
    return f;
}

static status draw_march(trial *t, const contest *c, entrant *e) {
    const hex_marcher m = {&t->lattice, &t->boundary, c->by};
    const finder begin = fresh(t, c->look);
    for (size_t i = 0; i < t->pixels; i++) {
        finder f = begin;
        hex_march(&m, t->rays[i].origin, t->rays[i].direction, c->look, &f, &e->tally);
    }
    return ST_OK;
}

static status draw_rays(trial *t, const contest *c, entrant *e) {
    const leafcast_scene scene = leafcast_scene_default();
    (void)c;
    (void)e;
    return (status)leafcast_trace_rays(t->volume, &scene, t->rays, t->pixels, t->hits);
}

static status trace(trial *t, leafcast_project project) {
    leafcast_scene scene = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof image, .value = t->value};
    leafcast_stats stats = {.size = sizeof stats};
    scene.project = project;
    return (status)leafcast_trace(t->volume, &scene, &t->camera, &image, &stats, NULL, NULL);
}

static status draw_frame(trial *t, const contest *c, entrant *e) {
    (void)c;
    (void)e;
    return trace(t, LEAFCAST_PROJECT_NONE);
}

static status draw_greatest(trial *t, const contest *c, entrant *e) {
    (void)c;
    (void)e;
    return trace(t, LEAFCAST_PROJECT_MAX);
}

/* ---- views ---- */

/* View 3 is the one of the flags; from as far, but along an axis, 0 to 2. */
static void look_from(trial *t, int view) {
    leafcast_camera *c = &t->camera;
    *c = view_camera_of(&t->subject->view, t->volume);
    double away[3];
    vec3_sub(c->eye, c->look_at, away);
    const double distance = vec3_length(away);
    for (int a = 0; a < 3 && view < 3; a++) {
        c->eye[a] = c->look_at[a] + (a == view ? distance : 0.0);
        c->up[a] = a == (view == 2 ? 1 : 2);
    }
    for (size_t i = 0; i < t->pixels; i++) {
        leafcast_ray *r = &t->rays[i];
        leafcast_pixel_ray(c, (double)(i % c->width) + 0.5, (double)(i / c->width) + 0.5, r->origin,
                           r->direction);
        r->t0 = 0.0;
        r->t1 = INFINITY;
    }
}

/* By both kinds of normals, beside the exact hits of the view. */
static status judge(trial *t, const contest *c, entrant *e) {
    const hex_marcher m = {&t->lattice, &t->boundary, c->by};
    const finder begin = fresh(t, c->look);
    status st = ST_OK;
    for (int how = HEX_NORMALS_COLUMNS; how <= HEX_NORMALS_INVERSE; how++) {
        hex_tally unused = {0};
        hex_lattice_normals(&t->lattice, (hex_normals)how);
        for (size_t i = 0; i < t->pixels && st == ST_OK; i++) {
            finder f = begin;
            hex_march(&m, t->rays[i].origin, t->rays[i].direction, c->look, &f, &unused);
            st = bench_hex_errors_add(&e->wrong, &t->lattice, (hex_normals)how, &t->hits[i],
                                      &f.surface);
        }
    }
    return st;
}

static status race(bench_job *job, trial *t, int view) {
    status st = ST_OK;
    look_from(t, view);
    hex_lattice_normals(&t->lattice, HEX_NORMALS_COLUMNS);
    for (int run = -1; run < job->runs && st == ST_OK; run++) { /* the first brings treelets in */
        st = progress_step(job->progress, "drawing",
                           (view + (run + 1.0) / (job->runs + 1.0)) / VIEWS);
        for (int i = 0; i < ENTRANTS && st == ST_OK; i++) {
            entrant *e = &t->all[i];
            const hex_tally before = e->tally;
            const double start = clock_cpu_seconds();
            st = CONTESTS[i].draw(t, &CONTESTS[i], e);
            if (run < 0)
                continue;
            e->seconds[run] += clock_cpu_seconds() - start;
            e->tally = before;
        }
    }
    for (size_t i = 0; i < t->pixels; i++)
        t->exact_hits += isfinite(t->hits[i].t);
    for (int i = 0; i < ENTRANTS && st == ST_OK; i++)
        if (CONTESTS[i].look == hex_surface_look)
            st = judge(t, &CONTESTS[i], &t->all[i]);
    return st;
}

/* ---- rows ---- */

/* A share of what is counted; "-" where nothing is. */
static void add_share(bench_table *table, const char *format, double count, double of) {
    if (of > 0.0)
        bench_table_add(table, format, count / of);
    else
        bench_table_add(table, "-");
}

static void add_hits(bench_table *table, const trial *t, int i) {
    const contest *c = &CONTESTS[i];
    const entrant *e = &t->all[i];
    const bool surface = c->look == hex_surface_look;
    if (surface || c->draw == draw_rays || c->draw == draw_frame)
        bench_table_add(table, "%llu",
                        (unsigned long long)(surface ? e->wrong.hits : t->exact_hits));
    else
        bench_table_add(table, "-");
    if (c->exact)
        bench_table_add(table, "-");
    else
        bench_table_add(table, "%llu", (unsigned long long)e->tally.lost);
}

static void add_row(bench_table *table, trial *t, int i) {
    const contest *c = &CONTESTS[i];
    entrant *e = &t->all[i];
    const hex_tally *n = &e->tally;
    const double hexes = (double)n->cells, rays = c->exact ? 0.0 : VIEWS * (double)t->pixels;
    bench_table_add(table, "%s", t->subject->label);
    bench_table_add(table, "%s", c->draws);
    bench_table_add(table, "%s", c->way);
    bench_table_add(table, "%.2f", e->median / VIEWS * 1e3);
    bench_table_add(table, "%.2f", e->spread / VIEWS * 1e3);
    bench_table_add(table, "%.3f", VIEWS / e->median);
    add_share(table, "%.3f", hexes * 1e-6, hexes > 0.0 ? e->median : 0.0);
    add_share(table, "%.3f", hexes, hexes > 0.0 ? rays : 0.0);
    add_share(table, "%.4f", (double)n->entries, rays);
    add_share(table, "%.3f", (double)n->tests, hexes);
    add_share(table, "%.3f", (double)n->patches, hexes);
    add_hits(table, t, i);
    bench_hex_errors_row(&e->wrong, c->look == hex_surface_look, table);
}

/* ---- grids ---- */

static status prepare(bench_job *job, trial *t) {
    const leafcast_options options = {.size = sizeof options, .threads = 1};
    status st = bench_hex_grid_load(&t->lattice, t->m, t->subject->path);
    if (st == ST_OK)
        st = hex_boundary_make(&t->boundary, t->m, &t->lattice);
    if (st == ST_OK)
        st = (status)leafcast_open(t->subject->path, &options, &t->volume);
    if (st == ST_OK)
        st = (status)leafcast_select(t->volume, t->subject->view.surfaces, 1);
    if (st == ST_OK)
        st = (status)leafcast_range(t->volume, 0, 0, t->range);
    if (st != ST_OK)
        return st;
    t->camera = view_camera_of(&t->subject->view, t->volume);
    t->isovalue = t->subject->view.surfaces[0].isovalue;
    t->pixels = (size_t)t->camera.width * t->camera.height;
    t->rays = mem_array(t->m, t->pixels, sizeof *t->rays);
    t->hits = mem_array(t->m, t->pixels, sizeof *t->hits);
    t->value = mem_array(t->m, t->pixels, sizeof *t->value);
    bool all = t->rays && t->hits && t->value;
    for (int i = 0; i < ENTRANTS; i++) {
        bench_hex_errors_init(&t->all[i].wrong, t->m);
        t->all[i].seconds = mem_array(t->m, (size_t)job->runs, sizeof(double));
        all = all && t->all[i].seconds;
    }
    return all ? ST_OK : ST_NOMEM;
}

static void leave(trial *t) {
    for (int i = 0; i < ENTRANTS; i++) {
        mem_free(t->m, t->all[i].seconds);
        bench_hex_errors_free(&t->all[i].wrong);
    }
    mem_free(t->m, t->rays);
    mem_free(t->m, t->hits);
    mem_free(t->m, t->value);
    leafcast_close(t->volume);
    hex_boundary_free(&t->boundary);
    hex_lattice_free(&t->lattice);
}

static status try_grid(bench_job *job, const bench_subject *s) {
    trial t = {.m = &job->m, .subject = s, .lattice.m = &job->m, .boundary.m = &job->m};
    status st = prepare(job, &t);
    for (int view = 0; view < VIEWS && st == ST_OK; view++)
        st = race(job, &t, view);
    for (int i = 0; i < ENTRANTS && st == ST_OK; i++) {
        entrant *e = &t.all[i];
        e->median = bench_median(e->seconds, job->runs, &e->spread);
        add_row(&job->table, &t, i);
    }
    leave(&t);
    return st;
}

status bench_hexes(bench_job *job) {
    static const char *const names[] = {"hexes-warp-40", "hexes-annulus-40", NULL};
    static const char *const brief[] = {"hexes-warp-12", "hexes-annulus-12", NULL};
    bench_table_init(&job->table,
                     "M08 tables 6.5 to 6.7, 6.10: from hexahedron to hexahedron, beside the exact "
                     "cells. Four views together; t in edges of the cell, angles of normals in "
                     "degrees. One thread, medians of CPU time, runs interleaved",
                     HEADINGS);
    return bench_suite_each(job, names, brief, try_grid);
}
