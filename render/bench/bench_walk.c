#include "render/bench/bench_walk.h"

#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"
#include "render/bench/experiment_filter.h"

const char bench_walk_headings[] = "file|kernel|ns/ray|+-|x masks|nodes/ray|cells/ray|roots/ray|"
                                   "active MB|peak MB";
const char bench_filter_headings[] = "file|ray-cells|surfaces %|fallbacks %|disagreements|"
                                     "double ns/16|filtered ns/16|filtered/double";

static const char *const KERNELS[] = {"scalar", "scalar-groups", "scalar-corners"};
enum { KERNEL_COUNT = 3, RECORD_MAX = 1 << 20 };

static const char *name_of(const char *path) {
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

typedef struct contestant {
    leafcast *volume;
    leafcast_stats stats;
    double *seconds; /* of a picture */
    double *depth;
} contestant;

static status open_volume(const char *path, const view_options *view, const char *isa,
                          leafcast **volume) {
    const leafcast_options options = {.size = sizeof(leafcast_options), .threads = 1, .isa = isa};
    status st = (status)leafcast_open(path, &options, volume);
    if (st == ST_OK)
        st = (status)leafcast_select(*volume, view->surfaces, view->isos);
    return st;
}

/* One picture; its time into *seconds. */
static status draw(contestant *c, const view_options *view, double *seconds) {
    const leafcast_camera camera = view_camera_of(view, c->volume);
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = c->depth};
    c->stats.size = sizeof c->stats;
    leafcast_scene_experiments e;
    const leafcast_scene scene = view_options_scene(view, &e);
    const double start = clock_cpu_seconds();
    status st = (status)leafcast_trace(c->volume, &scene, &camera, &image, &c->stats, NULL, NULL);
    *seconds = clock_cpu_seconds() - start;
    return st;
}

static status set_up(mem *m, const char *path, const view_options *view, int runs, int k,
                     contestant *c) {
    const size_t pixels = (size_t)view->camera.width * view->camera.height;
    double ignored;
    c->seconds = mem_array(m, (size_t)runs, sizeof *c->seconds);
    c->depth = mem_array(m, pixels, sizeof *c->depth);
    if (!c->seconds || !c->depth)
        return ST_NOMEM;
    status st = open_volume(path, view, KERNELS[k], &c->volume);
    return st == ST_OK ? draw(c, view, &ignored) : st;
}

static void add_row(bench_table *t, const char *path, int k, contestant *c, int runs,
                    double yardstick) {
    double spread;
    const double rays = (double)c->stats.rays;
    const double seconds = bench_median(c->seconds, runs, &spread);
    bench_table_add(t, "%s", name_of(path));
    bench_table_add(t, "%s", k == 0 ? "masks of cells" : k == 1 ? "2^3 groups" : "8 corners");
    bench_table_add(t, "%.1f", seconds / rays * 1e9);
    bench_table_add(t, "%.1f", spread / rays * 1e9);
    bench_table_add(t, "%.2f", seconds / yardstick);
    bench_table_add(t, "%.2f", (double)c->stats.nodes / rays);
    bench_table_add(t, "%.2f", (double)c->stats.cells / rays);
    bench_table_add(t, "%.2f", (double)c->stats.roots / rays);
    bench_table_add(t, "%.3f", (double)c->stats.bytes_active * 1e-6);
    bench_table_add(t, "%.3f", (double)c->stats.bytes_peak * 1e-6);
}

static status race(const view_options *view, int runs, contestant c[KERNEL_COUNT]) {
    const size_t bytes = (size_t)view->camera.width * view->camera.height * sizeof *c[0].depth;
    status st = ST_OK;
    for (int run = 0; run < runs; run++)
        for (int k = 0; k < KERNEL_COUNT && st == ST_OK; k++) {
            st = draw(&c[k], view, &c[k].seconds[run]);
            if (st == ST_OK && memcmp(c[k].depth, c[0].depth, bytes) != 0)
                st = status_describe(ST_FAILED, "%s draws another picture than %s", KERNELS[k],
                                     KERNELS[0]);
        }
    return st;
}

status bench_walk(mem *m, const char *path, const view_options *view, int runs, bench_table *t) {
    contestant c[KERNEL_COUNT] = {{0}};
    status st = ST_OK;
    for (int k = 0; k < KERNEL_COUNT && st == ST_OK; k++)
        st = set_up(m, path, view, runs, k, &c[k]);
    if (st == ST_OK)
        st = race(view, runs, c);
    if (st == ST_OK) {
        const double yardstick = bench_median(c[0].seconds, runs, NULL);
        for (int k = 0; k < KERNEL_COUNT; k++)
            add_row(t, path, k, &c[k], runs, yardstick);
    }
    for (int k = 0; k < KERNEL_COUNT; k++) {
        leafcast_close(c[k].volume);
        mem_free(m, c[k].depth);
        mem_free(m, c[k].seconds);
    }
    return st;
}

status bench_filter(const char *path, const view_options *view, bench_table *t) {
    leafcast *volume = NULL;
    experiment_filter_result r = {0};
    status st = open_volume(path, view, NULL, &volume);
    if (st == ST_OK) {
        const leafcast_camera camera = view_camera_of(view, volume);
        st = (status)experiment_filter(volume, &view->scene, &camera, RECORD_MAX, &r);
    }
    leafcast_close(volume);
    if (st == ST_OK && r.ray_cells == 0)
        st = status_describe(ST_USAGE, "no ray meets an active cell");
    if (st)
        return st;
    bench_table_add(t, "%s", name_of(path));
    bench_table_add(t, "%llu", (unsigned long long)r.ray_cells);
    bench_table_add(t, "%.2f", 100.0 * (double)r.surfaces / (double)r.ray_cells);
    bench_table_add(t, "%.2f", 100.0 * (double)r.fallbacks / (double)r.ray_cells);
    bench_table_add(t, "%llu", (unsigned long long)r.disagreements);
    bench_table_add(t, "%.0f", r.ns_double);
    bench_table_add(t, "%.0f", r.ns_filtered);
    bench_table_add(t, "%.2f", r.ns_filtered / r.ns_double);
    return ST_OK;
}
