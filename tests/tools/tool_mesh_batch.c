/* tool_mesh_batch.c - what a ray costs, alone and in batches, in microseconds of this thread: for
 * each kernel that this CPU has, rays of several sorts through an open volume.
 *
 *   mesh_batch F.leaf ISOVALUE [SIDE [ROUNDS [ISA [SORT]]]]
 *
 * Sorts: from what pixels of tiles show (SIDE x SIDE of them, the standard view) along a direction,
 * towards a point, whatever they meet first, mirrored; and rays at random. Batches and single rays
 * take turns; the median round counts. Where an answer differs, it says so, and fails.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "render/door/leafcast_volume.h"
#include "render/leafcast_experimental.h"
#include "render/ray/kind.h"
#include "tests/support/fields.h"

enum { ROUNDS_MAX = 99, TILE_SIDE = 32 };

typedef struct sort {
    const char *name;
    bool any;
    size_t count;
    ray *rays;
    trace_state *states;
    trace_result *want;
    trace_state *wanted;
} sort;

typedef struct lab {
    leafcast *v;
    tracer tr;
    camera camera;
    uint32_t side;
    double lo[3], hi[3];
    sort sorts[8];
    int count;
    ray_batch batch;
    void *scratch;
} lab;

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool open_lab(lab *l, const char *path, double iso) {
    const leafcast_options o = {.size = sizeof o, .threads = 1};
    const leafcast_surface surface = leafcast_surface_default(iso);
    static leafcast_scene scene;
    scene = leafcast_scene_default();
    if (leafcast_open(path, &o, &l->v) != LEAFCAST_OK ||
        leafcast_select(l->v, &surface, 1) != LEAFCAST_OK)
        return false;
    const leafcast_camera view = leafcast_standard_view(l->v, 2.2, l->side, l->side);
    volume_show(l->v, 0, 0, &surface, 1);
    if (camera_init(&l->camera, &view) != ST_OK ||
        volume_tracer(l->v, &scene, &l->camera, &l->tr) != ST_OK)
        return false;
    const uint32_t treelets = l->v->file->layout.treelets;
    loader_set_capacity(l->v->treelets, treelets, 0);
    for (uint32_t t = 0; t < treelets; t++) {
        const treelet *at;
        if (l->v->treelets->tree->active[0][t] && volume_treelet(l->v, t, &at) != ST_OK)
            return false;
    }
    const leafcast_info info = leafcast_describe(l->v);
    memcpy(l->lo, info.bounds[0], sizeof l->lo);
    memcpy(l->hi, info.bounds[1], sizeof l->hi);
    l->scratch = aligned_alloc(64, (kind_batch_scratch(l->v->kind) + 64) / 64 * 64);
    return l->scratch;
}

static sort *new_sort(lab *l, const char *name, bool any, size_t room) {
    sort *s = &l->sorts[l->count++];
    *s = (sort){.name = name, .any = any};
    s->rays = calloc(room, sizeof *s->rays);
    s->states = calloc(room, sizeof *s->states);
    s->want = calloc(room, sizeof *s->want);
    s->wanted = calloc(room, sizeof *s->wanted);
    return s;
}

static void add_ray(lab *l, sort *s, const double o[3], const double d[3], double t1, hit after) {
    if (!tracer_ray(&l->tr, o, d, 0.0, t1, &s->rays[s->count]))
        return;
    s->states[s->count] = trace_begin(&after);
    s->states[s->count++].any = s->any;
}

static double unit(double v[3]) {
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        v[a] /= length;
    return length;
}

static double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* A secondary ray, as the surface integrator begins it. */
static void add_secondary(lab *l, sort *s, const trace_state *from, const double at[3],
                          const double to[3], double t1, double side) {
    const double slope = dot3(from->point.gradient, to);
    if (from->best.entering ? slope * side > 0.0 : slope * side < 0.0)
        return;
    const double error = from->point.error / fabs(slope);
    add_ray(l, s, at, to, t1, hit_behind(error <= from->point.span ? error : from->point.span));
}

static void secondary_of(lab *l, sort s[], const ray *r, const trace_state *state) {
    static const double along[3] = {0.36, -0.48, 0.8};
    double at[3], to[3], mirrored[3], normal[3];
    for (int a = 0; a < 3; a++) {
        at[a] = r->o[a] + state->best.t * r->d[a];
        to[a] = l->hi[a] + 0.5 * (l->hi[a] - l->lo[a]) - at[a];
        normal[a] = (double)state->point.normal[a];
    }
    const double distance = unit(to), back = 2.0 * dot3(normal, r->d);
    for (int a = 0; a < 3; a++)
        mirrored[a] = r->d[a] - back * normal[a];
    add_secondary(l, &s[0], state, at, along, INFINITY, 1.0);
    add_secondary(l, &s[1], state, at, to, distance, 1.0);
    add_secondary(l, &s[2], state, at, r->d, INFINITY, -1.0);
    add_secondary(l, &s[3], state, at, mirrored, INFINITY, 1.0);
}

static void pixels_of_tile(lab *l, sort s[], uint32_t x0, uint32_t y0) {
    ray_counters counters = {0};
    for (uint32_t i = 0; i < TILE_SIDE * TILE_SIDE; i++) {
        const double x = x0 + i % TILE_SIDE + 0.5, y = y0 + i / TILE_SIDE + 0.5;
        double origin[3], direction[3];
        ray r;
        camera_ray(&l->camera, x, y, origin, direction);
        const hit before = hit_before_all();
        trace_state state = trace_begin(&before);
        if (tracer_ray(&l->tr, origin, direction, 0.0, INFINITY, &r) &&
            tracer_next(&l->tr, &r, &state, &counters) == TRACE_HIT)
            secondary_of(l, s, &r, &state);
    }
}

static void make_sorts(lab *l) {
    const size_t pixels = (size_t)l->side * l->side;
    sort *s = new_sort(l, "direction", true, pixels);
    new_sort(l, "point", true, pixels);
    new_sort(l, "behind", false, pixels);
    new_sort(l, "mirrored", false, pixels);
    for (uint32_t y = 0; y < l->side; y += TILE_SIDE)
        for (uint32_t x = 0; x < l->side; x += TILE_SIDE)
            pixels_of_tile(l, s, x, y);
    field_random random = {5};
    const size_t count = pixels / 8;
    sort *some = new_sort(l, "random any", true, count);
    sort *first = new_sort(l, "random first", false, count);
    for (size_t i = 0; i < count; i++) {
        double o[3], d[3];
        for (int a = 0; a < 3; a++) {
            o[a] = field_random_in(&random, l->lo[a], l->hi[a]);
            d[a] = field_random_in(&random, -1.0, 1.0);
        }
        unit(d);
        add_ray(l, some, o, d, INFINITY, hit_before_all());
        add_ray(l, first, o, d, INFINITY, hit_before_all());
    }
}

static double time_single(lab *l, sort *s) {
    ray_counters counters = {0};
    const double begun = seconds();
    for (size_t i = 0; i < s->count; i++) {
        s->wanted[i] = s->states[i];
        s->want[i] = tracer_next(&l->tr, &s->rays[i], &s->wanted[i], &counters);
    }
    return seconds() - begun;
}

static bool same(const sort *s, size_t i, const ray_batch *b, unsigned k) {
    const trace_state *want = &s->wanted[i], *got = &b->states[k];
    return s->want[i] == b->results[k] &&
           (s->any || (want->best.t == got->best.t && want->best.cell == got->best.cell &&
                       want->best.iso == got->best.iso &&
                       memcmp(&want->point, &got->point, sizeof want->point) == 0));
}

static double time_batches(lab *l, const ray_kernels *k, sort *s, size_t *wrong) {
    ray_counters counters = {0};
    double sum = 0.0;
    l->tr.kernels = k;
    for (size_t i = 0; i < s->count; i += l->batch.count) {
        l->batch.count = (unsigned)(s->count - i < RAY_BATCH ? s->count - i : RAY_BATCH);
        memcpy(l->batch.rays, &s->rays[i], l->batch.count * sizeof(ray));
        memcpy(l->batch.states, &s->states[i], l->batch.count * sizeof(trace_state));
        const double begun = seconds();
        ray_batch_next(&l->tr, &l->batch, l->scratch, &counters);
        sum += seconds() - begun;
        for (unsigned c = 0; c < l->batch.count; c++)
            *wrong += !same(s, i + c, &l->batch, c);
    }
    return sum;
}

static int by_size(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *t, int n) {
    qsort(t, (size_t)n, sizeof *t, by_size);
    return t[n / 2];
}

/* only: of this ISA; NULL: of all. */
static size_t race(lab *l, sort *s, int rounds, const char *only) {
    static double spent[CPU_ISAS + 1][ROUNDS_MAX];
    const int best = (int)cpu_best();
    size_t wrong = 0;
    for (int round = 0; round < rounds; round++) {
        spent[0][round] = round == 0 || !only ? time_single(l, s) : spent[0][0];
        for (int isa = 1; isa <= best; isa++) {
            if (only && strcmp(only, cpu_isa_name((cpu_isa)isa)) != 0)
                continue;
            const ray_kernels k = ray_kernels_of(l->tr.kind, (cpu_isa)isa);
            spent[isa][round] = time_batches(l, &k, s, &wrong);
        }
    }
    size_t hits = 0;
    for (size_t i = 0; i < s->count; i++)
        hits += s->want[i] == TRACE_HIT;
    printf("%-14s %8zu rays %5.1f%% hit  single %6.3f us", s->name, s->count,
           100.0 * (double)hits / (double)s->count,
           1e6 * median(spent[0], rounds) / (double)s->count);
    for (int isa = 1; isa <= best; isa++)
        printf("  %s %6.3f", cpu_isa_name((cpu_isa)isa),
               1e6 * median(spent[isa], rounds) / (double)s->count);
    printf(wrong ? "  %zu WRONG\n" : "\n", wrong);
    return wrong;
}

int main(int argc, char **argv) {
    static lab l;
    l.side = argc > 3 ? (uint32_t)atoi(argv[3]) / TILE_SIDE * TILE_SIDE : 512;
    const int rounds = argc > 4 ? atoi(argv[4]) : 5;
    if (argc < 3 || argc > 7 || l.side == 0 || rounds < 1 || rounds > ROUNDS_MAX) {
        fprintf(stderr, "mesh_batch F.leaf ISOVALUE [SIDE [ROUNDS [ISA [SORT]]]]\n");
        return 2;
    }
    if (!open_lab(&l, argv[1], strtod(argv[2], NULL))) {
        fprintf(stderr, "mesh_batch: %s\n", leafcast_error_text());
        return 1;
    }
    size_t wrong = 0;
    make_sorts(&l);
    for (int i = 0; i < l.count; i++)
        if (argc < 7 || strcmp(argv[6], l.sorts[i].name) == 0)
            wrong += race(&l, &l.sorts[i], rounds, argc > 5 ? argv[5] : NULL);
    return wrong > 0;
}
