#include "render/bench/bench_behind.h"

#include <math.h>
#include <string.h>

#include "formats/base/clock.h"
#include "render/app/view_camera.h"
#include "render/bench/bench_layers.h"

static const char headings[] =
    "volume|draws|size|kernels|threads|ms|+-|CPU ms|x opaque|x by CPU|"
    "rays/px|hit px|surfaces/hit|one by one CPU ms|differ|colours differ";

static const float OPACITY = 0.3f;

enum { OPAQUE, SHADOWS, TWO_LAYERS, ALL_LAYERS, LOOKS };

/* One way to draw the volume, and what it took. */
typedef struct look {
    leafcast_surface surfaces[LEAFCAST_SURFACES_MAX];
    leafcast_shown shown;
    leafcast_scene scene;
    double *wall, *cpu; /* seconds, of every run */
    leafcast_stats stats;
    uint64_t hit_pixels, surfaces_met;
    uint64_t differ, colours_differ; /* pixels, from single rays */
    double single_s;                 /* CPU time by single rays */
} look;

/* Planes of a picture, one block of floats and one of doubles. */
typedef struct planes {
    leafcast_image image;
    size_t pixels;
} planes;

typedef struct heat {
    leafcast *volume, *singly; /* by the best kernels; by the scalar ones, which know single rays */
    leafcast_camera camera;
    look looks[LOOKS];
    planes ours, reference;
} heat;

/* ---- what is drawn ---- */

/* From above, to the side of the standard view. */
static void add_light(leafcast_scene *scene) {
    scene->lights[0] = (leafcast_light){.vector = {0.0, 1.0, 2.0}, .rgb = {1.0f, 1.0f, 1.0f}};
    scene->light_count = 1;
}

static void describe(const bench_subject *s, int which, look *l) {
    const float opacity = which >= TWO_LAYERS ? OPACITY : 1.0f;
    l->scene = s->view.scene;
    memset(l->scene.background, 0, sizeof l->scene.background); /* alpha counts surfaces */
    if (which != SHADOWS)
        l->scene.light_count = 0;
    else if (l->scene.light_count == 0)
        add_light(&l->scene);
    l->scene.shadows = which == SHADOWS;
    l->scene.layers_max = which == TWO_LAYERS ? 2 : 0;
    for (int i = 0; i < s->view.isos; i++) {
        l->surfaces[i] = s->view.surfaces[i];
        l->surfaces[i].opacity = opacity;
    }
    l->shown = (leafcast_shown){.surfaces = l->surfaces, .count = s->view.isos};
    l->scene.volumes = &l->shown;
    l->scene.volume_count = 1;
}

static status make_planes(mem *m, const leafcast_camera *c, planes *p) {
    p->pixels = (size_t)c->width * c->height;
    p->image = (leafcast_image){.size = sizeof p->image,
                                .r = mem_array(m, 4 * p->pixels, sizeof(float)),
                                .z = mem_array(m, p->pixels, sizeof(double))};
    if (!p->image.r || !p->image.z)
        return ST_NOMEM;
    p->image.g = p->image.r + p->pixels;
    p->image.b = p->image.g + p->pixels;
    p->image.a = p->image.b + p->pixels;
    return ST_OK;
}

static status open_volume(bench_job *job, const bench_subject *s, const char *isa, leafcast **out) {
    const leafcast_options options = {.size = sizeof options, .threads = job->threads, .isa = isa};
    return (status)leafcast_open(s->path, &options, out);
}

static status enter(bench_job *job, const bench_subject *s, heat *h) {
    status st = open_volume(job, s, "auto", &h->volume);
    if (st == ST_OK)
        st = open_volume(job, s, "scalar", &h->singly);
    if (st == ST_OK) {
        h->camera = view_camera_of(&s->view, h->volume);
        st = make_planes(&job->m, &h->camera, &h->ours);
    }
    if (st == ST_OK)
        st = make_planes(&job->m, &h->camera, &h->reference);
    for (int i = 0; i < LOOKS && st == ST_OK; i++) {
        look *l = &h->looks[i];
        describe(s, i, l);
        l->wall = mem_array(&job->m, (size_t)job->runs, sizeof *l->wall);
        l->cpu = mem_array(&job->m, (size_t)job->runs, sizeof *l->cpu);
        st = l->wall && l->cpu ? ST_OK : ST_NOMEM;
    }
    return st;
}

static void leave(bench_job *job, heat *h) {
    for (int i = 0; i < LOOKS; i++) {
        mem_free(&job->m, h->looks[i].wall);
        mem_free(&job->m, h->looks[i].cpu);
    }
    mem_free(&job->m, h->ours.image.r);
    mem_free(&job->m, h->ours.image.z);
    mem_free(&job->m, h->reference.image.r);
    mem_free(&job->m, h->reference.image.z);
    leafcast_close(h->singly);
    leafcast_close(h->volume);
}

/* ---- drawing ---- */

static status draw(heat *h, look *l, leafcast *volume, const leafcast_image *image) {
    l->shown.volume = volume;
    l->stats.size = sizeof l->stats;
    return (status)leafcast_trace(volume, &l->scene, &h->camera, image, &l->stats, NULL, NULL);
}

/* run < 0: to bring in what it needs. */
static status take_turn(heat *h, look *l, int run) {
    const double cpu = clock_cpu_seconds(), wall = clock_seconds();
    status st = draw(h, l, h->volume, &h->ours.image);
    if (run >= 0) {
        l->wall[run] = clock_seconds() - wall;
        l->cpu[run] = clock_cpu_seconds() - cpu;
    }
    return st;
}

static status race(bench_job *job, heat *h) {
    status st = ST_OK;
    for (int run = -1; run < job->runs && st == ST_OK; run++) {
        st = progress_step(job->progress, "drawing", (run + 1.0) / (job->runs + 1.0));
        for (int i = 0; i < LOOKS && st == ST_OK; i++)
            st = take_turn(h, &h->looks[i], run);
    }
    return st;
}

/* ---- beside single rays ---- */

static bool same_colour(const leafcast_image *a, const leafcast_image *b, size_t i) {
    return memcmp(&a->r[i], &b->r[i], sizeof *a->r) == 0 &&
           memcmp(&a->g[i], &b->g[i], sizeof *a->g) == 0 &&
           memcmp(&a->b[i], &b->b[i], sizeof *a->b) == 0 &&
           memcmp(&a->a[i], &b->a[i], sizeof *a->a) == 0;
}

static void count(const heat *h, look *l) {
    const leafcast_image *ours = &h->ours.image, *reference = &h->reference.image;
    for (size_t i = 0; i < h->ours.pixels; i++) {
        l->hit_pixels += isfinite(ours->z[i]);
        l->surfaces_met += bench_layers(ours->a[i], l->surfaces[0].opacity);
        l->differ += memcmp(&ours->z[i], &reference->z[i], sizeof *ours->z) != 0;
        l->colours_differ += !same_colour(ours, reference, i);
    }
}

/* The reference twice: the first time it brings in what it needs. */
static status compare(heat *h, look *l) {
    status st = draw(h, l, h->singly, &h->reference.image);
    const double start = clock_cpu_seconds();
    if (st == ST_OK)
        st = draw(h, l, h->singly, &h->reference.image);
    l->single_s = clock_cpu_seconds() - start;
    if (st == ST_OK)
        st = draw(h, l, h->volume, &h->ours.image);
    if (st == ST_OK)
        count(h, l);
    return st;
}

/* ---- the table ---- */

static void add_rows(bench_job *job, const char *label, heat *h) {
    static const char *const draws[LOOKS] = {"opaque", "shadows", "2 layers", "all layers"};
    bench_table *t = &job->table;
    double first_wall = 0.0, first_cpu = 0.0, spread;
    for (int i = 0; i < LOOKS; i++) {
        look *l = &h->looks[i];
        const double wall = bench_median(l->wall, job->runs, &spread);
        const double cpu = bench_median(l->cpu, job->runs, NULL);
        first_wall = i ? first_wall : wall;
        first_cpu = i ? first_cpu : cpu;
        bench_table_add(t, "%s", label);
        bench_table_add(t, "%s", draws[i]);
        bench_table_add(t, "%ux%u", h->camera.width, h->camera.height);
        bench_table_add(t, "%s", l->stats.isa);
        bench_table_add(t, "%d", l->stats.threads);
        bench_table_add(t, "%.2f", wall * 1e3);
        bench_table_add(t, "%.2f", spread * 1e3);
        bench_table_add(t, "%.2f", cpu * 1e3);
        bench_table_add(t, "%.3f", wall / first_wall);
        bench_table_add(t, "%.3f", cpu / first_cpu);
        bench_table_add(t, "%.4f", (double)l->stats.rays / (double)h->ours.pixels);
        bench_table_add(t, "%llu", (unsigned long long)l->hit_pixels);
        bench_table_add(t, "%.4f", (double)l->surfaces_met / fmax(1.0, (double)l->hit_pixels));
        bench_table_add(t, "%.1f", l->single_s * 1e3);
        bench_table_add(t, "%llu", (unsigned long long)l->differ);
        bench_table_add(t, "%llu", (unsigned long long)l->colours_differ);
    }
}

static status measure(bench_job *job, const bench_subject *s) {
    heat h = {0};
    status st = enter(job, s, &h);
    if (st == ST_OK)
        st = race(job, &h);
    for (int i = 0; i < LOOKS && st == ST_OK; i++)
        st = compare(&h, &h.looks[i]);
    if (st == ST_OK)
        add_rows(job, s->label, &h);
    leave(job, &h);
    return st;
}

status bench_behind(bench_job *job) {
    static const char *const names[] = {"bonsai",   "ml-256",     "engine", "ml-512",
                                        "bucky-32", "bucky-2x32", NULL};
    static const char *const brief[] = {"ml-32", "bucky-12", NULL};
    bench_table_init(
        &job->table,
        "Behind the first surface: shadows, and layers of opacity 0.3, beside the opaque "
        "frame of the same view; medians, runs interleaved",
        headings);
    return bench_suite_each(job, names, brief, measure);
}
