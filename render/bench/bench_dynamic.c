#include "render/bench/bench_dynamic.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/bench/bench_dynamic_scenes.h"
#include "render/experiments/bounded_kdtree.h"
#include "render/ray/open_volume.h"
#include "stream/moving_surface.h"

/* Columns, in the order of add_row():
 *   state      built; moved: POSES updates later; anew: built in the place of that
 *   build ms   by one thread; of boxes with all that opening does
 *   refit ms   an update, by one thread, CPU time, median over the poses; best: wall-clock time of
 *              the fastest, by job->threads
 *   ms         CPU time of a picture's depths, or of its rays, by one thread, median over runs
 *   nodes/ray  of boxes: eight children each are looked at; of the kd-tree two; of tiles "-"
 *   cost       how many boxes of nodes a random line meets (surfaces of boxes beside the whole's)
 *   MB         that rays look at, beside triangles
 *   differ     rays whose hit is not that of the boxes built anew, or is of another triangle */
const char bench_dynamic_headings[] = "scene|triangles|state|tree|build ms|refit ms|best|ms|+-|fps|"
                                      "nodes/ray|triangles/ray|cost|MB|hits|differ";

enum { POSES = 20, STATES = 3 };
enum { BUILT, MOVED, ANEW };
enum { TILES, RAYS, KDTREE, TREES };

static const char *const state_names[STATES] = {"built", "moved", "anew"};
static const char *const tree_names[TREES] = {"boxes/tiles", "boxes/rays", "bounded kd"};

typedef struct entrant {
    double build, refit, best, ms, spread, nodes, triangles, cost, bytes;
    uint64_t hits, differ;
} entrant;

typedef struct trial {
    bench_job *job;
    dynamic_scene scene;
    float (*positions)[3];
    leafcast *volume[2]; /* tiles; single rays */
    bounded_kdtree tree;
    size_t pixels;
    leafcast_ray *rays;
    leafcast_ray_hit *want, *hits;
    double *depth, *times;
} trial;

/* ---- Trees ---- */

static leafcast_triangles triangles_of(const trial *t) {
    return (leafcast_triangles){.size = sizeof(leafcast_triangles),
                                .vertex_count = t->scene.vertices,
                                .triangle_count = t->scene.triangles,
                                .vertices = (const float(*)[3])t->positions,
                                .triangles = (const uint32_t(*)[3])t->scene.rows};
}

static status open_one(const trial *t, const char *isa, leafcast **out) {
    const leafcast_options o = {.size = sizeof o, .threads = 1, .isa = isa};
    const leafcast_triangles of = triangles_of(t);
    const leafcast_surface surface = leafcast_surface_default(0.0);
    status st = (status)leafcast_open_triangles(&of, &o, out);
    return st == ST_OK ? (status)leafcast_select(*out, &surface, 1) : st;
}

static void close_all(trial *t) {
    for (int i = 0; i < 2; i++)
        leafcast_close(t->volume[i]);
    t->volume[0] = t->volume[1] = NULL;
    bounded_kdtree_release(&t->tree);
}

static status build(trial *t, entrant e[TREES]) {
    static const char *const isas[] = {"auto", "scalar"};
    status st = ST_OK;
    for (int i = 0; i < 2 && st == ST_OK; i++) {
        const double from = clock_cpu_seconds();
        st = open_one(t, isas[i], &t->volume[i]);
        e[i].build = 1e3 * (clock_cpu_seconds() - from);
    }
    const double from = clock_cpu_seconds();
    if (st == ST_OK)
        st = bounded_kdtree_build(&t->job->m, (const uint32_t(*)[3])t->scene.rows,
                                  t->scene.triangles, (const float(*)[3])t->positions, &t->tree);
    e[KDTREE].build = 1e3 * (clock_cpu_seconds() - from);
    return st;
}

/* ---- Updates ---- */

/* One of the trees, and how its update goes on so many threads. */
typedef struct refitter {
    moving_surface *surface; /* or NULL: the kd-tree */
    pool *threads;           /* of the kd-tree */
} refitter;

static status refit(trial *t, const refitter *r) {
    const float(*to)[3] = (const float(*)[3])t->positions;
    return r->surface ? moving_surface_put(r->surface, 1, to)
                      : bounded_kdtree_refit(&t->tree, to, r->threads);
}

/* Go from pose to pose, to the last one. wall: best time of all; else the median of CPU time. */
static status time_refits(trial *t, const refitter *r, bool wall, double *ms) {
    double times[POSES], best = INFINITY;
    status st = ST_OK;
    for (int k = 0; k < POSES && st == ST_OK; k++) {
        t->scene.pose(&t->scene, (k + 1.0) / POSES, t->positions);
        const double cpu = clock_cpu_seconds(), from = clock_seconds();
        st = refit(t, r);
        best = fmin(best, clock_seconds() - from);
        times[k] = clock_cpu_seconds() - cpu;
    }
    *ms = 1e3 * (wall ? best : bench_median(times, POSES, NULL));
    return st;
}

static moving_source source_of(const trial *t) {
    return (moving_source){.vertices = t->scene.vertices,
                           .triangles = t->scene.triangles,
                           .positions = (const float(*)[3])t->positions,
                           .rows = (const uint32_t(*)[3])t->scene.rows};
}

static status refit_all(trial *t, entrant e[TREES]) {
    status st = ST_OK;
    for (int many = 0; many < 2 && st == ST_OK; many++) {
        const int threads = many ? t->job->threads : 1;
        const moving_source of = source_of(t);
        refitter boxes = {NULL, NULL}, kd = {NULL, NULL};
        st = moving_surface_create(&t->job->m, &of, threads, &boxes.surface);
        if (st == ST_OK)
            st = pool_create(&t->job->m, threads, &kd.threads);
        if (st == ST_OK)
            st = time_refits(t, &boxes, many, many ? &e[TILES].best : &e[TILES].refit);
        if (st == ST_OK)
            st = time_refits(t, &kd, many, many ? &e[KDTREE].best : &e[KDTREE].refit);
        pool_destroy(kd.threads);
        if (boxes.surface)
            leaf_file_close(boxes.surface->file);
        moving_surface_destroy(boxes.surface);
    }
    for (int i = 0; i < 2 && st == ST_OK; i++)
        st = (status)leafcast_update_vertices(t->volume[i], (const float(*)[3])t->positions,
                                              t->scene.vertices);
    e[RAYS].refit = e[TILES].refit;
    e[RAYS].best = e[TILES].best;
    return st;
}

/* ---- What trees are like ---- */

static double half_surface(const float box[6]) {
    const double x = (double)box[3] - (double)box[0], y = (double)box[4] - (double)box[1],
                 z = (double)box[5] - (double)box[2];
    return x * y + y * z + z * x;
}

static double surfaces_of(const treelet_tree *tree) {
    double sum = 0.0;
    for (uint32_t level = 0; level < tree->levels; level++)
        for (uint32_t i = 0; i < tree->count[level]; i++)
            sum += half_surface(tree->bounds[level][i]);
    return sum;
}

/* Of the step that was drawn last. */
static void look_at_boxes(const leafcast *v, entrant *e) {
    const moving_surface *s = v->file->moving;
    const treelet_tree *all = v->treelets->tree;
    e->cost = surfaces_of(all);
    e->bytes = (double)treelet_tree_bytes(s->treelet_count);
    for (uint32_t t = 0; t < s->treelet_count; t++) {
        const triangle_blocks *b = &s->treelets[t].at[leaf_layout_step(&v->file->layout, v->set)];
        e->cost += surfaces_of(&b->tree);
        e->bytes += (double)triangle_blocks_bytes(&b->shape);
    }
    e->cost /= half_surface(all->bounds[all->levels - 1][0]);
}

/* ---- Rays ---- */

static leafcast_camera camera_of(const trial *t) {
    const leafcast_camera *size = &t->job->view.camera;
    return leafcast_standard_view(t->volume[TILES], 1.5, size->width, size->height);
}

static void aim(trial *t) {
    const leafcast_camera c = camera_of(t);
    for (uint32_t y = 0, i = 0; y < c.height; y++)
        for (uint32_t x = 0; x < c.width; x++, i++) {
            t->rays[i] = (leafcast_ray){.t1 = (double)INFINITY};
            leafcast_pixel_ray(&c, x + 0.5, y + 0.5, t->rays[i].origin, t->rays[i].direction);
        }
}

static status draw(trial *t, leafcast *v, leafcast_stats *stats) {
    const leafcast_scene scene = leafcast_scene_default();
    const leafcast_camera c = camera_of(t);
    const leafcast_image image = {.size = sizeof image, .z = t->depth};
    *stats = (leafcast_stats){.size = sizeof *stats};
    return (status)leafcast_trace(v, &scene, &c, &image, stats, NULL, NULL);
}

static status trace(trial *t, leafcast *v, leafcast_ray_hit *hits) {
    const leafcast_scene scene = leafcast_scene_default();
    return (status)leafcast_trace_rays(v, &scene, t->rays, t->pixels, hits);
}

static void walk(trial *t, bounded_counts *counts) {
    for (size_t i = 0; i < t->pixels; i++) {
        ray r = {.t1 = (double)INFINITY};
        hit found;
        for (int a = 0; a < 3; a++) {
            r.o[a] = r.held[a] = t->rays[i].origin[a];
            r.d[a] = t->rays[i].direction[a] + 0.0; /* no -0 */
        }
        (void)bounded_kdtree_first(&t->tree, &r, &found, counts);
        t->hits[i].t = found.t;
        t->hits[i].cell = found.cell;
    }
}

static void count(const trial *t, bool cells, entrant *e) {
    e->hits = e->differ = 0;
    for (size_t i = 0; i < t->pixels; i++) {
        const leafcast_ray_hit *is = &t->hits[i], *want = &t->want[i];
        const double at = cells ? is->t : t->depth[i];
        e->hits += !isinf(at);
        e->differ += at != want->t || (cells && !isinf(at) && is->cell != want->cell);
    }
}

/* first: count, too. */
static status run_once(trial *t, int tree, bool first, entrant *e, double *seconds) {
    leafcast_stats stats;
    bounded_counts counts = {0};
    const double from = clock_cpu_seconds();
    status st = ST_OK;
    if (tree == TILES)
        st = draw(t, t->volume[TILES], &stats);
    else if (tree == RAYS)
        st = trace(t, t->volume[RAYS], t->hits);
    else
        walk(t, &counts);
    *seconds = clock_cpu_seconds() - from;
    if (tree == RAYS && first && st == ST_OK)
        st = draw(t, t->volume[RAYS], &stats); /* rays of the caller's own are not counted */
    if (st != ST_OK || !first)
        return st;
    const double rays = (double)t->pixels;
    e->nodes = (double)(tree == KDTREE ? counts.nodes : stats.nodes) / rays;
    e->triangles = (double)(tree == KDTREE ? counts.triangles : stats.cells) / rays;
    count(t, tree != TILES, e);
    return ST_OK;
}

static status race(trial *t, entrant e[TREES]) {
    status st = ST_OK;
    for (int tree = 0; tree < TREES && st == ST_OK; tree++) {
        for (int n = 0; n < t->job->runs && st == ST_OK; n++)
            st = run_once(t, tree, n == 0, &e[tree], &t->times[n]);
        e[tree].ms = 1e3 * bench_median(t->times, t->job->runs, &e[tree].spread);
        e[tree].spread *= 1e3;
        if (tree != KDTREE && st == ST_OK)
            look_at_boxes(t->volume[tree], &e[tree]);
    }
    e[KDTREE].cost = bounded_kdtree_cost(&t->tree);
    e[KDTREE].bytes = (double)bounded_kdtree_bytes(&t->tree);
    return st;
}

/* What a volume that is opened in this place finds. */
static status judge(trial *t) {
    leafcast *fresh = NULL;
    status st = open_one(t, "auto", &fresh);
    aim(t);
    if (st == ST_OK)
        st = trace(t, fresh, t->want);
    leafcast_close(fresh);
    return st;
}

/* ---- Rows ---- */

static void add_row(const trial *t, int state, int tree, const entrant *e) {
    bench_table *table = &t->job->table;
    bench_table_add(table, "%s", t->scene.name);
    bench_table_add(table, "%u", t->scene.triangles);
    bench_table_add(table, "%s", state_names[state]);
    bench_table_add(table, "%s", tree_names[tree]);
    bench_table_add(table, "%.1f", e->build);
    bench_table_add(table, "%.3f", e->refit);
    bench_table_add(table, "%.3f", e->best);
    bench_table_add(table, "%.2f", e->ms);
    bench_table_add(table, "%.2f", e->spread);
    bench_table_add(table, "%.1f", 1e3 / e->ms);
    /* Counts of tiles depend on the width of vectors. */
    for (int i = 0; i < 2 && tree == TILES; i++)
        bench_table_add(table, "-");
    if (tree != TILES)
        bench_table_add(table, "%.2f", e->nodes);
    if (tree != TILES)
        bench_table_add(table, "%.2f", e->triangles);
    bench_table_add(table, "%.2f", e->cost);
    bench_table_add(table, "%.3f", 1e-6 * e->bytes);
    bench_table_add(table, "%llu", (unsigned long long)e->hits);
    bench_table_add(table, "%llu", (unsigned long long)e->differ);
}

static status run_states(trial *t) {
    entrant e[TREES];
    status st = ST_OK;
    memset(e, 0, sizeof e);
    for (int state = 0; state < STATES && st == ST_OK; state++) {
        t->scene.pose(&t->scene, state == BUILT ? 0.0 : 1.0, t->positions);
        if (state == ANEW)
            close_all(t);
        st = state == MOVED ? refit_all(t, e) : build(t, e);
        if (st == ST_OK)
            st = judge(t);
        if (st == ST_OK)
            st = race(t, e);
        for (int tree = 0; tree < TREES && st == ST_OK; tree++)
            add_row(t, state, tree, &e[tree]);
    }
    close_all(t);
    return st;
}

static status measure(bench_job *job, dynamic_scene scene) {
    trial t = {.job = job,
               .scene = scene,
               .pixels = (size_t)job->view.camera.width * job->view.camera.height};
    t.positions = mem_array(&job->m, scene.vertices, sizeof *t.positions);
    t.rays = mem_array(&job->m, t.pixels, sizeof *t.rays);
    t.want = mem_array(&job->m, t.pixels, sizeof *t.want);
    t.hits = mem_array(&job->m, t.pixels, sizeof *t.hits);
    t.depth = mem_array(&job->m, t.pixels, sizeof *t.depth);
    t.times = mem_array(&job->m, (size_t)job->runs, sizeof *t.times);
    const bool whole = t.positions && t.rays && t.want && t.hits && t.depth && t.times;
    const status st = whole ? run_states(&t) : ST_NOMEM;
    mem_free(&job->m, t.times);
    mem_free(&job->m, t.depth);
    mem_free(&job->m, t.hits);
    mem_free(&job->m, t.want);
    mem_free(&job->m, t.rays);
    mem_free(&job->m, t.positions);
    return st;
}

status bench_dynamic(bench_job *job) {
    status st = ST_OK;
    bench_table_init(&job->table,
                     "M08 5.3: triangles that move, refit by boxes and by bounded kd-tree, and "
                     "drawn as built, moved and built anew; one thread, medians of CPU time",
                     bench_dynamic_headings);
    if (job->target)
        return status_describe(ST_USAGE, "bench dynamic takes no file: it makes its own surfaces");
    for (int i = 0; st == ST_OK; i++) {
        dynamic_scene scene;
        st = dynamic_scene_make(&job->m, i, job->brief, &scene);
        if (st == ST_OK) {
            st = measure(job, scene);
            dynamic_scene_release(&job->m, &scene);
        }
    }
    return st == ST_AGAIN ? ST_OK : st;
}
