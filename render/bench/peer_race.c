#include "render/bench/peer_race.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"
#include "render/bench/bench_layers.h"
#include "render/bench/peer_embree.h"
#include "render/bench/peer_surface.h"
#include "render/bench/peer_tets.h"
#include "render/bench/peer_vtk.h"

const char peer_race_headings[] =
    "contestant|BVH|extract ms|build ms|ms|+-|CPU ms|Mray/s|x Embree|x by CPU|triangles|MB|hits|"
    "surfaces|rays|median cells|p99 cells|worst cells|only peer|only ours|colour rms|far px";

enum { CONTESTANTS = 12, MEDIUM = 0, HIGH, ONE_PASS, BVHS };

typedef struct race race;
typedef struct contestant contestant;

struct contestant {
    const char *name;
    /* One turn; what it adds to lap is not in the time that is taken around it. */
    status (*turn)(race *r, contestant *c);
    bool embree, fresh, rays_alone; /* fresh: a new isovalue each time */
    int bvh;
    peer_way way;
    int turns; /* so far */
    /* Seconds: of every run, then their medians. */
    double *wall, *cpu, *extract, *build;
    double extract_now, build_now;
    double median, spread, cpu_median;
    uint64_t triangles;
    peer_counts counts; /* of the last picture */
};

struct race {
    mem *m;
    const peer_race_options *o;
    pool *threads;
    leafcast *steady, *changing;
    leafcast_stats stats;
    leafcast_camera camera;
    leafcast_image ours, peer; /* with z: to be compared */
    leafcast_image colours;    /* without: what is timed */
    float *alpha;
    peer_field field; /* of a grid */
    peer_tets tets;   /* of a mesh of tetrahedra; else without a file */
    bool given;       /* a surface itself: there is nothing to extract */
    peer_mesh mesh;
    peer_embree *bvh[BVHS];
    double extract_s, build_s[BVHS];
    double cell;       /* world length of one */
    uint64_t surfaces; /* that made our picture */
    peer_vtk *vtk;
    contestant all[CONTESTANTS];
    int count;
    peer_difference difference;
};

status peer_race_check(view_options *view) {
    const leafcast_scene *s = &view->scene;
    status st = view_options_check(view);
    if (st)
        return st;
    if (view->isos != 1)
        return status_describe(ST_USAGE, "peers draw one isosurface");
    if (s->shadows && view->surfaces[0].opacity < 1.0f)
        return status_describe(ST_USAGE, "peers draw shadows of an opaque isosurface");
    if (s->shading != LEAFCAST_SHADING_DIFFUSE || s->analytic_normals)
        return status_describe(ST_USAGE, "peers shade diffuse, with smooth normals");
    if (s->clip_box || s->clip_plane_count > 0 || s->lod != LEAFCAST_LOD_EXACT || s->preview)
        return status_describe(ST_USAGE, "peers draw all of the surface, at full resolution");
    for (int i = 0; i < s->light_count; i++)
        if (s->lights[i].radius > 0.0)
            return status_describe(ST_USAGE, "peers draw shadows without penumbras: no RADIUS");
    if (s->samples > 1)
        return status_describe(ST_USAGE, "peers trace one ray a pixel");
    return ST_OK;
}

/* ---- turns ---- */

/* Isovalues on both sides of the one asked for, each only once. */
static double next_isovalue(const race *r, const contestant *c) {
    const int away = c->turns / 2 + 1;
    return r->o->view->surfaces[0].isovalue + r->o->step * (c->turns % 2 ? -away : away);
}

static status turn_ours(race *r, contestant *c) {
    leafcast *volume = c->fresh ? r->changing : r->steady;
    status st = ST_OK;
    if (c->fresh) {
        leafcast_surface surface = r->o->view->surfaces[0];
        surface.isovalue = next_isovalue(r, c);
        st = (status)leafcast_select(volume, &surface, 1);
    }
    r->stats.size = sizeof r->stats;
    if (st == ST_OK)
        st = (status)leafcast_trace(volume, &r->o->view->scene, &r->camera, &r->colours, &r->stats,
                                    NULL, NULL);
    return st;
}

static status draw_embree(race *r, contestant *c, const peer_embree *bvh,
                          const leafcast_image *image) {
    const peer_view view = {&r->camera, &r->o->view->surfaces[0], &r->o->view->scene, r->cell};
    return peer_embree_frame(bvh, r->threads, &c->way, &view, image, &c->counts);
}

static status turn_embree(race *r, contestant *c) {
    const leafcast_image nothing = {.size = sizeof(leafcast_image)};
    return draw_embree(r, c, r->bvh[c->bvh], c->rays_alone ? &nothing : &r->colours);
}

static status extract(race *r, double isovalue, peer_mesh *mesh) {
    return r->tets.file ? peer_tets_extract(r->m, &r->tets, isovalue, r->threads, mesh)
                        : peer_mesh_extract(r->m, &r->field, isovalue, r->threads, mesh);
}

/* One of the BVHs. */
static status build(const race *r, const peer_mesh *mesh, int which, peer_embree **out) {
    const peer_build how = {.threads = r->o->threads,
                            .high = which == HIGH,
                            .one_pass = which == ONE_PASS,
                            .isa = r->o->isa};
    return peer_embree_create(r->m, mesh, &how, out);
}

/* A mesh and a BVH for a picture. */
static status turn_embree_fresh(race *r, contestant *c) {
    peer_mesh mesh = {.m = r->m};
    peer_embree *bvh = NULL;
    const double start = clock_seconds();
    status st = extract(r, next_isovalue(r, c), &mesh);
    const double extracted = clock_seconds();
    if (st == ST_OK)
        st = build(r, &mesh, MEDIUM, &bvh);
    c->extract_now = extracted - start;
    c->build_now = clock_seconds() - extracted;
    if (st == ST_OK)
        st = draw_embree(r, c, bvh, &r->colours);
    c->triangles = mesh.triangles;
    peer_embree_destroy(bvh);
    peer_mesh_release(&mesh);
    return st;
}

static status turn_vtk(race *r, contestant *c) {
    return peer_vtk_extract(r->vtk, r->o->view->surfaces[0].isovalue, &c->extract_now,
                            &c->triangles);
}

/* ---- who takes part ---- */

static status enter(race *r, contestant c) {
    const size_t runs = (size_t)r->o->runs;
    c.wall = mem_array(r->m, runs, sizeof *c.wall);
    c.cpu = mem_array(r->m, runs, sizeof *c.cpu);
    c.extract = mem_array(r->m, runs, sizeof *c.extract);
    c.build = mem_array(r->m, runs, sizeof *c.build);
    r->all[r->count++] = c; /* also when incomplete: released with the race */
    return c.wall && c.cpu && c.extract && c.build ? ST_OK : ST_NOMEM;
}

/* Rays that go on where others ended: to lights, or behind transparent surfaces. */
static bool is_transparent(const race *r) {
    return r->o->view->surfaces[0].opacity < 1.0f;
}

static bool goes_behind(const race *r) {
    return is_transparent(r) || r->o->view->scene.shadows;
}

static bool takes_part(const race *r, const contestant *c) {
    if (c->turn == turn_vtk)
        return r->vtk;
    if (c->fresh && r->given)
        return false;
    return !c->embree || (r->bvh[c->bvh] && (!c->way.incoherent || goes_behind(r)));
}

static status enter_all(race *r) {
    static const contestant list[CONTESTANTS] = {
        {.name = "leafcast", .turn = turn_ours},
        {.name = "leafcast; new isovalue", .turn = turn_ours, .fresh = true},
        {.name = "rtcIntersect16", .turn = turn_embree, .embree = true},
        {.name = "rtcIntersect16", .turn = turn_embree, .embree = true, .bvh = HIGH},
        {.name = "rtcIntersect16; incoherent",
         .turn = turn_embree,
         .embree = true,
         .way.incoherent = true},
        {.name = "rtcIntersect16; one pass",
         .turn = turn_embree,
         .embree = true,
         .bvh = ONE_PASS,
         .way.one_pass = true},
        {.name = "rtcIntersect8", .turn = turn_embree, .embree = true, .way.packet = PEER_PACKET_8},
        {.name = "rtcIntersect8; incoherent",
         .turn = turn_embree,
         .embree = true,
         .way = {.packet = PEER_PACKET_8, .incoherent = true}},
        {.name = "rtcIntersect1", .turn = turn_embree, .embree = true, .way.packet = PEER_PACKET_1},
        {.name = "rtcIntersect16; rays alone",
         .turn = turn_embree,
         .embree = true,
         .rays_alone = true},
        {.name = "rtcIntersect16; new isovalue",
         .turn = turn_embree_fresh,
         .embree = true,
         .fresh = true},
        {.name = "VTK flying edges", .turn = turn_vtk},
    };
    status st = ST_OK;
    for (int i = 0; i < CONTESTANTS && list[i].name && st == ST_OK; i++)
        if (takes_part(r, &list[i]))
            st = enter(r, list[i]);
    return st;
}

static status open_ours(race *r, leafcast **volume) {
    const leafcast_options options = {.size = sizeof(leafcast_options),
                                      .threads = r->o->threads,
                                      .memory = r->o->memory,
                                      .isa = r->o->isa ? cpu_isa_name(r->o->isa) : NULL};
    status st = (status)leafcast_open(r->o->path, &options, volume);
    return st == ST_OK ? (status)leafcast_select(*volume, r->o->view->surfaces, 1) : st;
}

static status make_planes(race *r) {
    const size_t pixels = (size_t)r->camera.width * r->camera.height;
    leafcast_image *images[2] = {&r->ours, &r->peer};
    for (int i = 0; i < 2; i++) {
        leafcast_image *p = images[i];
        p->size = sizeof *p;
        p->r = mem_array(r->m, 3 * pixels, sizeof *p->r);
        p->z = mem_array(r->m, pixels, sizeof *p->z);
        if (!p->r || !p->z)
            return ST_NOMEM;
        p->g = p->r + pixels;
        p->b = p->g + pixels;
    }
    r->colours = r->ours;
    r->colours.z = NULL;
    r->alpha = mem_array(r->m, pixels, sizeof *r->alpha);
    return r->alpha ? ST_OK : ST_NOMEM;
}

/* Whether all surfaces on a ray fit into a list. */
static bool passes_once(const race *r) {
    const float opacity = r->o->view->surfaces[0].opacity;
    return opacity < 1.0f &&
           peer_embree_layers(r->o->view->scene.layers_max, opacity) <= PEER_COLLECTED_MAX;
}

/* The mesh and each BVH, timed. */
static status set_up_embree(race *r, peer_race_missing *missing) {
    double start = clock_seconds();
    if (!peer_embree_present()) {
        const status st = build(r, &r->mesh, MEDIUM, &r->bvh[MEDIUM]);
        snprintf(missing->embree, sizeof missing->embree, "%s", status_text());
        return st == ST_UNSUPPORTED ? ST_OK : st;
    }
    status st = r->given ? peer_surface_load(r->m, r->o->path, r->threads, &r->mesh)
                         : extract(r, r->o->view->surfaces[0].isovalue, &r->mesh);
    r->extract_s = r->given ? 0.0 : clock_seconds() - start;
    if (st == ST_OK && r->mesh.triangles == 0)
        st = status_describe(ST_USAGE, "%s: the isovalue has no surface", r->o->path);
    for (int i = 0; i < BVHS && st == ST_OK; i++) {
        if (i == ONE_PASS && !passes_once(r))
            continue;
        start = clock_seconds();
        st = build(r, &r->mesh, i, &r->bvh[i]);
        r->build_s[i] = clock_seconds() - start;
    }
    return st;
}

static status set_up_vtk(race *r, peer_race_missing *missing) {
    if (r->tets.file || r->given) {
        snprintf(missing->vtk, sizeof missing->vtk, "VTK's flying edges are for grids");
        return ST_OK;
    }
    status st = peer_vtk_start(r->m, &r->field, r->o->threads, &r->vtk);
    if (st != ST_UNSUPPORTED)
        return st;
    snprintf(missing->vtk, sizeof missing->vtk, "%s", status_text());
    return ST_OK;
}

static status load(race *r) {
    const leafcast_info info = leafcast_describe(r->steady);
    r->given = info.abilities & LEAFCAST_ABILITY_GIVEN;
    if (r->given)
        return ST_OK; /* for Embree alone */
    return info.dims[0] == 0 ? peer_tets_load(r->m, r->o->path, r->threads, &r->tets)
                             : peer_field_load(r->m, r->o->path, r->threads, &r->field);
}

static status set_up(race *r, peer_race_missing *missing) {
    status st = pool_create(r->m, r->o->threads, &r->threads);
    if (st == ST_OK)
        st = open_ours(r, &r->steady);
    if (st == ST_OK)
        st = open_ours(r, &r->changing);
    if (st == ST_OK) {
        r->camera = view_camera_of(r->o->view, r->steady);
        r->cell = leafcast_describe(r->steady).cell_size;
        st = make_planes(r);
    }
    if (st == ST_OK)
        st = progress_step(r->o->progress, "loading", 0.0);
    if (st == ST_OK)
        st = load(r);
    if (st == ST_OK)
        st = set_up_embree(r, missing);
    if (st == ST_OK)
        st = set_up_vtk(r, missing);
    return st == ST_OK ? enter_all(r) : st;
}

static void tear_down(race *r) {
    for (int i = 0; i < r->count; i++) {
        mem_free(r->m, r->all[i].wall);
        mem_free(r->m, r->all[i].cpu);
        mem_free(r->m, r->all[i].extract);
        mem_free(r->m, r->all[i].build);
    }
    peer_vtk_stop(r->vtk);
    for (int i = 0; i < BVHS; i++)
        peer_embree_destroy(r->bvh[i]);
    peer_mesh_release(&r->mesh);
    peer_field_release(&r->field);
    peer_tets_release(&r->tets);
    mem_free(r->m, r->alpha);
    mem_free(r->m, r->ours.r);
    mem_free(r->m, r->ours.z);
    mem_free(r->m, r->peer.r);
    mem_free(r->m, r->peer.z);
    leafcast_close(r->changing);
    leafcast_close(r->steady);
    pool_destroy(r->threads);
}

/* ---- the race ---- */

/* run < 0: to warm up. */
static status take_turn(race *r, contestant *c, int run) {
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st = c->turn(r, c);
    c->turns++;
    if (run < 0 || st)
        return st;
    /* Another process measures itself. */
    const bool away = c->turn == turn_vtk;
    c->wall[run] = away ? c->extract_now : clock_seconds() - wall;
    c->cpu[run] = away ? 0.0 : clock_cpu_seconds() - cpu;
    c->extract[run] = c->extract_now;
    c->build[run] = c->build_now;
    return ST_OK;
}

static status take_turns(race *r) {
    status st = ST_OK;
    for (int run = -1; run < r->o->runs && st == ST_OK; run++) {
        st = progress_step(r->o->progress, "drawing", (run + 1.0) / (r->o->runs + 1.0));
        for (int i = 0; i < r->count && st == ST_OK; i++)
            st = take_turn(r, &r->all[i], run);
    }
    for (int i = 0; i < r->count && st == ST_OK; i++) {
        contestant *c = &r->all[i];
        c->median = bench_median(c->wall, r->o->runs, &c->spread);
        c->cpu_median = bench_median(c->cpu, r->o->runs, NULL);
        if (c->embree && !c->fresh) {
            c->extract_now = r->extract_s;
            c->build_now = r->build_s[c->bvh];
            c->triangles = r->mesh.triangles;
        } else {
            c->extract_now = bench_median(c->extract, r->o->runs, NULL);
            c->build_now = bench_median(c->build, r->o->runs, NULL);
        }
    }
    return st;
}

/* Ours once more, before nothing: its alpha tells how many surfaces made it. */
static status count_surfaces(race *r) {
    const size_t pixels = (size_t)r->camera.width * r->camera.height;
    leafcast_scene scene = r->o->view->scene;
    const leafcast_image image = {
        .size = sizeof image, .r = r->peer.r, .g = r->peer.g, .b = r->peer.b, .a = r->alpha};
    memset(scene.background, 0, sizeof scene.background);
    status st =
        (status)leafcast_trace(r->steady, &scene, &r->camera, &image, &r->stats, NULL, NULL);
    for (size_t i = 0; i < pixels && st == ST_OK; i++)
        r->surfaces += bench_layers(r->alpha[i], r->o->view->surfaces[0].opacity);
    return st;
}

/* The same picture once more, with distances. */
static status compare(race *r) {
    contestant with_16 = {.name = NULL};
    const size_t pixels = (size_t)r->camera.width * r->camera.height;
    leafcast_stats stats = {.size = sizeof stats};
    status st = count_surfaces(r);
    if (st == ST_OK)
        st = (status)leafcast_trace(r->steady, &r->o->view->scene, &r->camera, &r->ours, &stats,
                                    NULL, NULL);
    for (size_t i = 0; i < pixels && !r->bvh[MEDIUM]; i++)
        r->difference.only_ours += r->ours.z[i] < INFINITY;
    if (st || !r->bvh[MEDIUM])
        return st;
    st = draw_embree(r, &with_16, r->bvh[MEDIUM], &r->peer);
    if (st == ST_OK)
        st = peer_picture_compare(r->m, &r->ours, &r->peer, pixels, r->cell, &r->difference);
    if (st == ST_OK && r->o->picture)
        st = peer_picture_write(r->m, r->o->picture, r->o->force, r->camera.width, r->camera.height,
                                &r->ours, &r->peer, r->cell);
    return st;
}

/* ---- the table ---- */

/* A number, or nothing where there is none. */
static void add_number(bench_table *t, bool there, const char *fmt, double x) {
    char text[BENCH_TEXT];
    snprintf(text, sizeof text, fmt, x);
    bench_table_add(t, "%s", there ? text : "-");
}

/* Embree's fastest way to draw the whole picture: what the others are measured by. Seconds; 0 where
 * there is none. */
typedef struct yardstick {
    double wall, cpu;
} yardstick;

static double lesser(double known, double seconds) {
    return known == 0.0 || seconds < known ? seconds : known;
}

static yardstick yardstick_of(const race *r) {
    yardstick best = {0.0, 0.0};
    for (int i = 0; i < r->count; i++) {
        const contestant *c = &r->all[i];
        if (!c->embree || c->fresh || c->rays_alone)
            continue;
        best.wall = lesser(best.wall, c->median);
        best.cpu = lesser(best.cpu, c->cpu_median);
    }
    return best;
}

static double megabytes_of(const race *r, const contestant *c) {
    const peer_mesh *mesh = &r->mesh;
    if (!c->embree)
        return (double)r->stats.bytes_peak * 1e-6;
    return (24.0 * (double)mesh->vertices + 12.0 * (double)mesh->triangles +
            (double)peer_embree_bytes(r->bvh[c->bvh])) *
           1e-6;
}

static void add_row(bench_table *t, const race *r, const contestant *c) {
    const yardstick best = yardstick_of(r);
    const peer_difference *d = &r->difference;
    const double rays = (double)r->camera.width * r->camera.height;
    const bool ours = c->turn == turn_ours, picture = ours || c->embree;
    const bool counted = c->embree && !c->fresh;
    const bool compared = counted && !c->rays_alone && c->bvh == MEDIUM &&
                          c->way.packet == PEER_PACKET_16 && !c->way.incoherent;
    bench_table_add(t, "%s", c->name);
    bench_table_add(t, "%s", c->embree ? c->bvh == HIGH ? "high" : "medium" : "-");
    add_number(t, !ours, "%.1f", c->extract_now * 1e3);
    add_number(t, c->embree, "%.1f", c->build_now * 1e3);
    add_number(t, true, "%.2f", c->median * 1e3);
    add_number(t, true, "%.2f", c->spread * 1e3);
    add_number(t, picture, "%.2f", c->cpu_median * 1e3);
    add_number(t, picture, "%.2f", rays * 1e-6 / c->median);
    add_number(t, picture && best.wall > 0.0, "%.3f", best.wall / c->median);
    add_number(t, picture && best.cpu > 0.0, "%.3f", best.cpu / c->cpu_median);
    add_number(t, !ours, "%.0f", (double)c->triangles);
    add_number(t, picture && !(c->embree && c->fresh), "%.1f", picture ? megabytes_of(r, c) : 0.0);
    add_number(t, (ours && !c->fresh) || compared, "%.0f",
               (double)(d->both + (ours ? d->only_ours : d->only_peer)));
    add_number(t, (ours && !c->fresh) || counted, "%.0f",
               (double)(ours ? r->surfaces : c->counts.surfaces));
    add_number(t, (ours && !c->fresh) || counted, "%.0f",
               ours ? (double)r->stats.rays : rays + (double)c->counts.shadow_rays);
    add_number(t, compared, "%.2g", d->median);
    add_number(t, compared, "%.2g", d->p99);
    add_number(t, compared, "%.3g", d->worst);
    add_number(t, compared, "%.0f", (double)d->only_peer);
    add_number(t, compared, "%.0f", (double)d->only_ours);
    add_number(t, compared, "%.2g", d->colour);
    add_number(t, compared, "%.0f", (double)d->far);
}

status peer_race_run(mem *m, const peer_race_options *o, bench_table *t,
                     peer_race_missing *missing) {
    race r = {.m = m, .o = o};
    *missing = (peer_race_missing){0};
    status st = set_up(&r, missing);
    if (st == ST_OK)
        st = take_turns(&r);
    if (st == ST_OK)
        st = compare(&r);
    for (int i = 0; i < r.count && st == ST_OK; i++)
        add_row(t, &r, &r.all[i]);
    tear_down(&r);
    return st;
}
