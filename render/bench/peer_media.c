#include "render/bench/peer_media.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"
#include "render/bench/bench_media.h"
#include "render/bench/peer_vtk.h"

const char peer_media_headings[] =
    "transfer|contestant|setting|ms|+-|Mray/s|worst|99 %|rms|> 1/510 "
    "%|of seeing %|x ours|by 99 %|opacity off";

enum { OURS = 7, TYPES = 2, DISTANCES = 3, CONTESTANTS = OURS + TYPES * DISTANCES };

typedef struct contestant {
    const char *name, *setting;
    const char *type; /* VTK's; NULL: ours */
    double error;     /* ours: asked for */
    double cells;     /* VTK's: between samples */
    double *seconds;
    double median, spread, seeing;
    bench_media_error off;
} contestant;

typedef struct media_race {
    mem *m;
    const peer_race_options *o;
    const char *transfer;
    leafcast *volume;
    pool *threads;
    leafcast_camera camera;
    transfer_list points, opacities; /* those of VTK: see opacities_of() */
    leafcast_medium medium;
    leafcast_shown shown;
    double cell, opacity_off;
    size_t pixels;
    double *truth, *rgba, *offs;
    peer_field field;
    peer_vtk *vtk;
    contestant all[CONTESTANTS];
    int count;
} media_race;

/* ---- VTK's transfer function ---- */

static double opacity_at(double extinction, double cell) {
    return -expm1(-extinction * cell);
}

/* Between two points of ours: where the curve of opacities is taken for a line, that is off most in
 * the middle. */
static status add_between(media_race *r, const leafcast_transfer_point *a,
                          const leafcast_transfer_point *b, int parts) {
    status st = ST_OK;
    for (int i = 0; i < parts && st == ST_OK; i++) {
        const double w = (double)i / parts, step = (b->extinction - a->extinction) / parts;
        const double k = a->extinction + i * step;
        leafcast_transfer_point p = {.value = a->value + w * (b->value - a->value),
                                     .extinction = opacity_at(k, r->cell)};
        const double next = opacity_at(k + step, r->cell);
        r->opacity_off = fmax(r->opacity_off, fabs(0.5 * (p.extinction + next) -
                                                   opacity_at(k + 0.5 * step, r->cell)));
        for (int c = 0; c < 3; c++)
            p.rgb[c] = (1.0 - w) * a->rgb[c] + w * b->rgb[c];
        st = transfer_list_add(&r->opacities, p);
    }
    return st;
}

/* The points with opacities of a cell for extinctions, and many between. */
static status opacities_of(media_race *r) {
    const size_t last = r->points.count - 1;
    const int parts = (int)(LEAFCAST_TRANSFER_POINTS_MAX / (last + 2));
    status st = ST_OK;
    for (size_t i = 0; i < last && st == ST_OK; i++) {
        const leafcast_transfer_point *p = &r->points.points[i];
        st = add_between(r, p, p + 1, p[1].value > p->value ? parts : 1);
    }
    leafcast_transfer_point end = r->points.points[last];
    end.extinction = opacity_at(end.extinction, r->cell);
    return st == ST_OK ? transfer_list_add(&r->opacities, end) : st;
}

/* ---- VTK's view ---- */

/* Whether cells are equal boxes, not mirrored: VTK's frame is then ours, turned. */
static bool is_regular(const peer_field *f) {
    const double(*m)[4] = f->space.to_world;
    double turn = 0.0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        const uint32_t n = f->dims[a];
        double dot = 0.0;
        for (int k = 0; k < 3; k++)
            dot += m[k][a] * m[k][b];
        turn += m[0][a] * (m[1][b] * m[2][c] - m[2][b] * m[1][c]);
        if (fabs(dot) > 1e-9 * affine_unit(&f->space, a) * affine_unit(&f->space, b))
            return false;
        for (uint32_t i = 0; i < n; i++)
            if (fabs(f->axis[a][i] - i) > 1e-6)
                return false;
    }
    return turn > 0.0;
}

static void to_field(const peer_field *f, const double world[3], bool point, double out[3]) {
    if (point)
        affine_point_to_grid(&f->space, world, out);
    else
        affine_vector_to_grid(&f->space, world, out);
    for (int a = 0; a < 3; a++)
        out[a] *= affine_unit(&f->space, a);
}

static status fill_vtk(media_race *r, const char *type) {
    peer_vtk_scene s = {.type = type,
                        .points = r->opacities.points,
                        .count = (int)r->opacities.count,
                        .length = r->cell,
                        .camera = r->camera};
    to_field(&r->field, r->camera.eye, true, s.camera.eye);
    to_field(&r->field, r->camera.look_at, true, s.camera.look_at);
    to_field(&r->field, r->camera.up, false, s.camera.up);
    return peer_vtk_fill(r->vtk, &s);
}

/* ---- Pictures ---- */

static status draw_ours(media_race *r, double error, double *seconds) {
    leafcast_scene scene = r->o->view->scene;
    const leafcast_image image = {.size = sizeof image, .rgba = r->rgba};
    memset(scene.background, 0, sizeof scene.background);
    scene.error = error;
    scene.volumes = &r->shown;
    scene.volume_count = 1;
    scene.media = &r->medium;
    scene.media_count = 1;
    const double start = clock_seconds();
    status st = (status)leafcast_trace(r->volume, &scene, &r->camera, &image, NULL, NULL, NULL);
    *seconds = clock_seconds() - start;
    return st;
}

static status draw(media_race *r, const contestant *c, double *seconds) {
    return c->type ? peer_vtk_cast(r->vtk, c->type, c->cells * r->cell, seconds, r->rgba)
                   : draw_ours(r, c->error, seconds);
}

/* Of the rays that see anything, those that are beyond half a step of 8 bits. */
static double share_of_seeing(const media_race *r) {
    size_t seeing = 0, beyond = 0;
    for (size_t i = 0; i < r->pixels; i++) {
        double most = 0.0;
        for (size_t c = 4 * i; c < 4 * i + 4; c++)
            most = fmax(most, fabs(r->rgba[c] - r->truth[c]));
        seeing += r->truth[4 * i + 3] > 1e-4;
        beyond += most > 1.0 / 510.0;
    }
    return seeing > 0 ? (double)beyond / (double)seeing : 0.0;
}

static status race(media_race *r) {
    double ignored;
    status st = draw_ours(r, 1e-6, &ignored);
    memcpy(r->truth, r->rgba, 4 * r->pixels * sizeof *r->truth);
    for (int run = -1; run < r->o->runs && st == ST_OK; run++) {
        st = progress_step(r->o->progress, "drawing", (run + 1.0) / (r->o->runs + 1.0));
        for (int i = 0; i < r->count && st == ST_OK; i++) {
            contestant *c = &r->all[i];
            st = draw(r, c, run < 0 ? &ignored : &c->seconds[run]);
            if (run >= 0)
                continue;
            c->seeing = share_of_seeing(r);
            c->off = bench_media_judge(r->rgba, r->truth, r->pixels, r->offs);
        }
    }
    for (int i = 0; i < r->count && st == ST_OK; i++)
        r->all[i].median = bench_median(r->all[i].seconds, r->o->runs, &r->all[i].spread);
    return st;
}

/* ---- Who takes part ---- */

static status enter(media_race *r, contestant c) {
    c.seconds = mem_array(r->m, (size_t)r->o->runs, sizeof *c.seconds);
    r->all[r->count++] = c;
    return c.seconds ? ST_OK : ST_NOMEM;
}

static status enter_ours(media_race *r) {
    static const contestant list[OURS] = {
        {"leafcast", "1", .error = 1.0},         {"leafcast", "1/4", .error = 0x1p-2},
        {"leafcast", "1/16", .error = 0x1p-4},   {"leafcast", "1/64", .error = 0x1p-6},
        {"leafcast", "1/256", .error = 0x1p-8},  {"leafcast", "1/510", .error = 1.0 / 510.0},
        {"leafcast", "1/1024", .error = 0x1p-10}};
    status st = ST_OK;
    for (int i = 0; i < OURS && st == ST_OK; i++)
        st = enter(r, list[i]);
    return st;
}

static status enter_vtk(media_race *r, const char *name, const char *type) {
    static const char *const settings[DISTANCES] = {"1", "1/2", "1/4"};
    status st = fill_vtk(r, type);
    for (int i = 0; i < DISTANCES && st == ST_OK; i++)
        st = enter(r, (contestant){name, settings[i], .type = type, .cells = ldexp(1.0, -i)});
    return st;
}

/* The file's own type, where VTK has it, is what it is fastest with. */
static status enter_types(media_race *r) {
    static const char *const own[][3] = {{"u8", "uint8", "VTK fixed-point; u8"},
                                         {"i16", "int16", "VTK fixed-point; i16"},
                                         {"u16", "uint16", "VTK fixed-point; u16"}};
    const leafcast_info info = leafcast_describe(r->volume);
    status st = enter_vtk(r, "VTK fixed-point; f32", "float");
    for (int i = 0; i < 3 && st == ST_OK; i++)
        if (strcmp(info.sample_type, own[i][0]) == 0)
            st = enter_vtk(r, own[i][2], own[i][1]);
    return st;
}

static status set_up_vtk(media_race *r, peer_race_missing *missing) {
    status st = ST_UNSUPPORTED;
    if (leafcast_describe(r->volume).dims[0] == 0)
        st = status_describe(st, "VTK's fixed-point ray caster is for grids");
    else
        st = peer_field_load(r->m, r->o->path, r->threads, &r->field);
    if (st == ST_OK && !is_regular(&r->field))
        st = status_describe(ST_UNSUPPORTED, "VTK's fixed-point ray caster is for equal boxes");
    if (st == ST_OK)
        st = opacities_of(r);
    if (st == ST_OK)
        st = peer_vtk_start(r->m, &r->field, pool_threads(r->threads), &r->vtk);
    if (st == ST_OK)
        st = enter_types(r);
    if (st != ST_UNSUPPORTED)
        return st;
    snprintf(missing->vtk, sizeof missing->vtk, "%s", status_text());
    return ST_OK;
}

static status set_up(media_race *r, peer_race_missing *missing) {
    const leafcast_options options = {
        .size = sizeof options, .threads = r->o->threads, .memory = r->o->memory};
    status st = pool_create(r->m, r->o->threads, &r->threads);
    if (st == ST_OK)
        st = (status)leafcast_open(r->o->path, &options, &r->volume);
    if (st == ST_OK)
        st = bench_media_transfer(r->transfer, r->volume, &r->points);
    if (st != ST_OK)
        return st;
    r->medium = (leafcast_medium){r->points.points, (int)r->points.count};
    r->shown = (leafcast_shown){.volume = r->volume};
    r->camera = view_camera_of(r->o->view, r->volume);
    r->cell = leafcast_describe(r->volume).cell_size;
    r->pixels = (size_t)r->camera.width * r->camera.height;
    r->truth = mem_array(r->m, 4 * r->pixels, sizeof(double));
    r->rgba = mem_array(r->m, 4 * r->pixels, sizeof(double));
    r->offs = mem_array(r->m, 4 * r->pixels, sizeof(double));
    st = r->truth && r->rgba && r->offs ? enter_ours(r) : ST_NOMEM;
    return st == ST_OK ? set_up_vtk(r, missing) : st;
}

static void tear_down(media_race *r) {
    peer_vtk_stop(r->vtk);
    peer_field_release(&r->field);
    leafcast_close(r->volume);
    pool_destroy(r->threads);
    transfer_list_release(&r->points);
    transfer_list_release(&r->opacities);
    for (int i = 0; i < r->count; i++)
        mem_free(r->m, r->all[i].seconds);
    mem_free(r->m, r->truth);
    mem_free(r->m, r->rgba);
    mem_free(r->m, r->offs);
}

/* ---- The table ---- */

/* How many times the least time of ours that is no further off. */
static void add_ratio(bench_table *t, const media_race *r, const contestant *c, bool by_worst) {
    double least = INFINITY;
    for (int i = 0; i < r->count; i++) {
        const bench_media_error *off = &r->all[i].off;
        if (!r->all[i].type && (by_worst ? off->worst <= c->off.worst : off->p99 <= c->off.p99))
            least = fmin(least, r->all[i].median);
    }
    if (c->type && least < INFINITY)
        bench_table_add(t, "%.3g", c->median / least);
    else
        bench_table_add(t, "-");
}

static void add_row(bench_table *t, const media_race *r, const contestant *c) {
    bench_table_add(t, "%s", r->transfer);
    bench_table_add(t, "%s", c->name);
    bench_table_add(t, "%s", c->setting);
    bench_table_add(t, "%.2f", c->median * 1e3);
    bench_table_add(t, "%.2f", c->spread * 1e3);
    bench_table_add(t, "%.3f", (double)r->pixels * 1e-6 / c->median);
    bench_table_add(t, "%.3e", c->off.worst);
    bench_table_add(t, "%.3e", c->off.p99);
    bench_table_add(t, "%.3e", c->off.rms);
    bench_table_add(t, "%.3f", 100.0 * c->off.share);
    bench_table_add(t, "%.3f", 100.0 * c->seeing);
    add_ratio(t, r, c, true);
    add_ratio(t, r, c, false);
    if (c->type)
        bench_table_add(t, "%.1e", r->opacity_off);
    else
        bench_table_add(t, "-");
}

status peer_media_run(mem *m, const peer_race_options *o, const char *transfer, bench_table *t,
                      peer_race_missing *missing) {
    media_race r = {
        .m = m, .o = o, .transfer = transfer, .points = {.m = m}, .opacities = {.m = m}};
    status st = set_up(&r, missing);
    if (st == ST_OK)
        st = race(&r);
    for (int i = 0; i < r.count && st == ST_OK; i++)
        add_row(t, &r, &r.all[i]);
    tear_down(&r);
    return st;
}
