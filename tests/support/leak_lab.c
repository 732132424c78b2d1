#include "tests/support/leak_lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "formats/base/cpu.h"
#include "tests/support/fixture.h"
#include "tests/support/ref_judge.h"
#include "tests/support/solids.h"

enum { CHUNK = 2000, SHOWN = 3, HITS_MAX = 512, ALONG = 64, CELLS_LOG2 = 4, EVERY = 7 };

/* A solid as a treelet file. */
typedef struct scene {
    const leak_lab_job *job;
    field f;
    ref_volume v;
    const char *path;
} scene;

static void scene_begin(scene *s, const leak_lab_job *job) {
    s->job = job;
    solid_make(&s->f, job->which, job->placing, job->seed);
    s->v = field_volume(&s->f);
    s->path = fixture_leaf(&s->f, CELLS_LOG2 + (uint32_t)(job->seed % 2), 1, false);
}

static void scene_end(scene *s) {
    (void)unlink(s->path);
    field_release(&s->f);
}

static status open_volume(const scene *s, const char *isa, int threads, leafcast **volume) {
    const leafcast_options options = {
        .size = sizeof(leafcast_options), .threads = threads, .isa = isa};
    const leafcast_surface surface = leafcast_surface_default(s->f.iso);
    if (leafcast_open(s->path, &options, volume) != LEAFCAST_OK)
        return status_describe(ST_FAILED, "%s", leafcast_error_text());
    if (leafcast_select(*volume, &surface, 1) != LEAFCAST_OK) {
        leafcast_close(*volume);
        return status_describe(ST_FAILED, "%s", leafcast_error_text());
    }
    return ST_OK;
}

/* ---- rays ---- */

typedef struct lab_ray {
    ref_ray line;      /* t = 1 is a point inside, unless it begins inside */
    bool from_outside; /* of the volume */
} lab_ray;

/* A direction of small whole numbers, in node coordinates. */
static void whole_direction(field_random *r, double d[3]) {
    do {
        for (int a = 0; a < 3; a++)
            d[a] = field_random_below(r, 3) ? (double)(field_random_below(r, 5) - 2) : 0;
    } while (d[0] == 0 && d[1] == 0 && d[2] == 0);
}

/* The index-th ray: towards a random point or a node inside, in any direction, or along grid
 * planes, edges and diagonals; or from there. False: the solid has no inside. */
static bool make_ray(const scene *s, uint64_t index, lab_ray *out) {
    field_random mix = {s->job->seed * 0x9e3779b97f4a7c15u + index};
    field_random r = {field_random_bits(&mix)};
    const bool exact = index & 2, whole = index & 4;
    double inside[3], d[3], outside[3], from[3], to[3];
    if (!solid_inside(&s->f, &s->v, &r, exact, inside))
        return false;
    out->from_outside = !(index & 1);
    if (whole) {
        whole_direction(&r, d);
        for (int a = 0; a < 3; a++)
            outside[a] = inside[a] - 128 * d[a];
    } else {
        /* From beyond the box on one axis, anywhere near it on the others. */
        const int beyond = (int)field_random_below(&r, 3);
        for (int a = 0; a < 3; a++) {
            const long last = s->v.dims[a] - 1;
            const double lo = s->v.axis[a] ? s->v.axis[a][0] : 0;
            const double hi = s->v.axis[a] ? s->v.axis[a][last] : (double)last;
            const double away = field_random_in(&r, 0.5, 30);
            outside[a] = a != beyond                 ? field_random_in(&r, lo - 20, hi + 20)
                         : field_random_below(&r, 2) ? lo - away
                                                     : hi + away;
        }
    }
    solid_to_world(&s->v, out->from_outside ? outside : inside, from);
    solid_to_world(&s->v, out->from_outside ? inside : outside, to);
    for (int a = 0; a < 3; a++) {
        out->line.o[a] = from[a];
        out->line.d[a] = to[a] - from[a];
    }
    return true;
}

typedef enum outcome { FINE, LEAK, DISORDER, EXCUSED } outcome;

static const char *const outcome_names[] = {"fine", "leak", "disorder", "excused"};

static outcome judge_hits(const scene *s, const lab_ray *r, const leafcast_hit *hits, int count) {
    if (count == 0 || (r->from_outside && hits[0].t > 1))
        return LEAK;
    /* Surfaces at one t come by cell index, not by the way of the ray: what counts is the side
     * behind all of them. */
    int side = r->from_outside ? 0 : 1, before = 0;
    bool ordered = count < HITS_MAX;
    for (int i = 0; i < count; i++) {
        side += hits[i].entering ? 1 : -1;
        before += hits[i].t < 1;
        if (i + 1 == count || hits[i + 1].t > hits[i].t)
            ordered &= side == 0 || side == 1;
    }
    ordered &= side == 0;
    if (ordered && (!r->from_outside || before % 2 == 1))
        return FINE;
    if (solid_kind(s->job->which) & SOLID_FILAMENTS)
        return EXCUSED;
    return ref_grazing(&s->v, &r->line, &s->f.iso, 1, NULL, 64) ? EXCUSED : DISORDER;
}

static status try_ray(const scene *s, leafcast *volume, uint64_t index, outcome *result,
                      leafcast_hit hits[HITS_MAX], int *count) {
    const leafcast_scene plain = leafcast_scene_default();
    lab_ray r;
    if (!make_ray(s, index, &r))
        return status_describe(ST_FAILED, "%s has no inside", s->f.name);
    if (leafcast_probe_ray(volume, &plain, r.line.o, r.line.d, hits, HITS_MAX, count) !=
        LEAFCAST_OK)
        return status_describe(ST_FAILED, "%s", leafcast_error_text());
    *result = judge_hits(s, &r, hits, *count);
    return ST_OK;
}

typedef struct chunk {
    leak_tally tally;
    uint64_t faults[SHOWN];
    outcome what[SHOWN];
    int noted;
} chunk;

typedef struct run_context {
    const scene *s;
    chunk *chunks;
} run_context;

static status run_chunk(void *ctx, size_t at, int worker) {
    (void)worker;
    const run_context *run = ctx;
    const uint64_t rays = run->s->job->rays;
    chunk *c = &run->chunks[at];
    leafcast *volume = NULL;
    status st = open_volume(run->s, NULL, 1, &volume);
    for (uint64_t i = at * CHUNK; st == ST_OK && i < rays && i < (at + 1) * CHUNK; i++) {
        leafcast_hit hits[HITS_MAX];
        outcome what = FINE;
        int count;
        st = try_ray(run->s, volume, i, &what, hits, &count);
        c->tally.rays++;
        c->tally.leaks += what == LEAK;
        c->tally.disorder += what == DISORDER;
        c->tally.excused += what == EXCUSED;
        if ((what == LEAK || what == DISORDER) && c->noted < SHOWN) {
            c->what[c->noted] = what;
            c->faults[c->noted++] = i;
        }
    }
    leafcast_close(volume);
    return st;
}

static void print_start(const leak_lab_job *job, const char *what) {
    fprintf(job->log, "%s; rerun: %s leak %s %s %llu ", what, job->rerun, solid_name(job->which),
            placing_name(job->placing), (unsigned long long)job->seed);
}

static status run_rays(pool *p, const scene *s, leak_tally *tally) {
    const size_t count = (size_t)((s->job->rays + CHUNK - 1) / CHUNK);
    run_context run = {s, calloc(count ? count : 1, sizeof(chunk))};
    if (!run.chunks)
        return status_describe(ST_NOMEM, "no room for %zu parts", count);
    status st = pool_run(p, count, run_chunk, &run);
    int shown = 0;
    for (size_t at = 0; at < count; at++) {
        const chunk *c = &run.chunks[at];
        leak_tally_add(tally, &c->tally);
        for (int n = 0; n < c->noted && shown < SHOWN; n++, shown++) {
            print_start(s->job, outcome_names[c->what[n]]);
            fprintf(s->job->log, "%llu\n", (unsigned long long)c->faults[n]);
        }
    }
    free(run.chunks);
    return st;
}

/* ---- pictures ---- */

typedef struct view {
    leafcast_camera camera;
    bool inside; /* the eye is */
} view;

/* Three from inside, wide; three from outside, towards a point inside. */
enum { VIEWS = 6 };

static bool make_view(const scene *s, int index, uint32_t side, view *out) {
    field_random r = {s->job->seed * 77 + (uint64_t)index};
    double p[3], q[3], middle[3];
    if (!solid_inside(&s->f, &s->v, &r, index == 2, p))
        return false;
    *out = (view){
        {.size = sizeof(leafcast_camera), .up = {0.1, 0.2, 1}, .width = side, .height = side},
        index < VIEWS / 2};
    out->camera.fov = out->inside ? 120 : 20;
    for (int a = 0; a < 3; a++) {
        const long last = s->v.dims[a] - 1;
        const double lo = s->v.axis[a] ? s->v.axis[a][0] : 0;
        const double hi = s->v.axis[a] ? s->v.axis[a][last] : (double)last;
        const double way = field_random_in(&r, 0.3, 1) * (field_random_below(&r, 2) ? 1 : -1);
        middle[a] = (lo + hi) / 2;
        q[a] = middle[a] + 2 * way * (hi - lo);
    }
    solid_to_world(&s->v, out->inside ? p : q, out->camera.eye);
    solid_to_world(&s->v, out->inside ? q : p, out->camera.look_at);
    return true;
}

/* The nearest t of points along the ray that lie inside; INFINITY: none was met. */
static double inside_along(const scene *s, const double o[3], const double d[3], double least) {
    const ref_ray ray = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
    long double g[3], gd[3], t0 = 0, t1 = INFINITY;
    ref_to_grid(&s->v, &ray, g, gd);
    for (int a = 0; a < 3; a++) {
        const long last = s->v.dims[a] - 1;
        const long double lo = s->v.axis[a] ? s->v.axis[a][0] : 0;
        const long double hi = s->v.axis[a] ? s->v.axis[a][last] : (long double)last;
        if (gd[a] == 0)
            continue;
        const long double x = (lo - g[a]) / gd[a], y = (hi - g[a]) / gd[a];
        t0 = fmaxl(t0, fminl(x, y));
        t1 = fminl(t1, fmaxl(x, y));
    }
    for (int i = 0; i < ALONG && t0 < t1; i++) {
        const long double t = t0 + (t1 - t0) * ((long double)i + 0.5L) / ALONG;
        const long double p[3] = {g[0] + t * gd[0], g[1] + t * gd[1], g[2] + t * gd[2]};
        if (ref_value(&s->v, p, s->f.iso) > least)
            return (double)t;
    }
    return INFINITY;
}

static status draw(const scene *s, const view *of, const char *isa, double *z) {
    leafcast *volume = NULL;
    const leafcast_scene plain = leafcast_scene_default();
    const leafcast_image image = {.size = sizeof(leafcast_image), .z = z};
    status st = open_volume(s, isa, 1, &volume);
    if (st != ST_OK)
        return st;
    if (leafcast_trace(volume, &plain, &of->camera, &image, NULL, NULL, NULL) != LEAFCAST_OK)
        st = status_describe(ST_FAILED, "%s", leafcast_error_text());
    leafcast_close(volume);
    return st;
}

/* Pixels of the picture that see through. */
static uint64_t count_leaks(const scene *s, const view *of, const double *z) {
    const double least = 1e-6 * solid_scale(&s->f);
    uint64_t leaks = 0;
    for (uint32_t at = 0; at < of->camera.width * of->camera.height; at++) {
        double o[3], d[3];
        if (of->inside) {
            leaks += !(z[at] < (double)INFINITY);
            continue;
        }
        if (at % EVERY != 0)
            continue;
        leafcast_pixel_ray(&of->camera, at % of->camera.width + 0.5, at / of->camera.width + 0.5, o,
                           d);
        const double t = inside_along(s, o, d, least);
        leaks += t < (double)INFINITY && !(z[at] <= t);
    }
    return leaks;
}

/* Pixels whose distance is not that of the single ray. */
static uint64_t count_unlike(const scene *s, const view *of, const double *z, uint64_t *unlike) {
    const leafcast_scene plain = leafcast_scene_default();
    leafcast *volume = NULL;
    if (open_volume(s, "scalar", 1, &volume) != ST_OK)
        return 0;
    uint64_t asked = 0;
    for (uint32_t at = 0; at < of->camera.width * of->camera.height; at += EVERY, asked++) {
        double o[3], d[3];
        leafcast_hit hit;
        int count = 0;
        leafcast_pixel_ray(&of->camera, at % of->camera.width + 0.5, at / of->camera.width + 0.5, o,
                           d);
        const leafcast_status st = leafcast_probe_ray(volume, &plain, o, d, &hit, 1, &count);
        *unlike += st != LEAFCAST_OK || (count ? hit.t : (double)INFINITY) != z[at];
    }
    leafcast_close(volume);
    return asked;
}

static status run_view(const scene *s, int index, leak_tally *tally) {
    const size_t pixels = (size_t)s->job->side * s->job->side;
    double *first = calloc(2 * pixels, sizeof *first);
    view v;
    if (!first)
        return status_describe(ST_NOMEM, "no room for %zu pixels", pixels);
    double *other = first + pixels;
    status st = make_view(s, index, s->job->side, &v)
                    ? draw(s, &v, "scalar", first)
                    : status_describe(ST_FAILED, "%s has no inside", s->f.name);
    if (st == ST_OK) {
        tally->pixels += pixels;
        tally->leaks += count_leaks(s, &v, first);
        (void)count_unlike(s, &v, first, &tally->unlike);
    }
    for (int isa = CPU_SCALAR + 1; st == ST_OK && isa <= (int)cpu_best(); isa++) {
        st = draw(s, &v, cpu_isa_name((cpu_isa)isa), other);
        tally->pixels += pixels;
        for (size_t i = 0; st == ST_OK && i < pixels; i++)
            tally->unlike += memcmp(&first[i], &other[i], sizeof first[i]) != 0;
    }
    free(first);
    return st;
}

static status run_pictures(const scene *s, leak_tally *tally) {
    status st = ST_OK;
    const leak_tally before = *tally;
    for (int i = 0; st == ST_OK && i < VIEWS; i++)
        st = run_view(s, i, tally);
    if (tally->leaks > before.leaks || tally->unlike > before.unlike) {
        print_start(s->job, tally->leaks > before.leaks ? "leak in a picture" : "unlike pictures");
        fprintf(s->job->log, "picture %u\n", (unsigned)s->job->side);
    }
    return st;
}

status leak_lab_run(pool *p, const leak_lab_job *job, leak_tally *tally) {
    scene s;
    *tally = (leak_tally){0};
    scene_begin(&s, job);
    status st = run_rays(p, &s, tally);
    if (st == ST_OK && job->side > 0)
        st = run_pictures(&s, tally);
    scene_end(&s);
    return st;
}

/* ---- tallies ---- */

void leak_tally_add(leak_tally *to, const leak_tally *from) {
    to->rays += from->rays;
    to->pixels += from->pixels;
    to->leaks += from->leaks;
    to->disorder += from->disorder;
    to->excused += from->excused;
    to->unlike += from->unlike;
}

uint64_t leak_tally_faults(const leak_tally *tally) {
    return tally->leaks + tally->disorder + tally->unlike;
}

void leak_tally_heading(FILE *out) {
    fprintf(out, "%-28s %10s %10s %8s %8s %8s %8s\n", "closed surfaces", "rays", "pixels", "leaks",
            "disorder", "excused", "unlike");
}

void leak_tally_row(FILE *out, const char *name, const leak_tally *t) {
    fprintf(out, "%-28s %10llu %10llu %8llu %8llu %8llu %8llu\n", name, (unsigned long long)t->rays,
            (unsigned long long)t->pixels, (unsigned long long)t->leaks,
            (unsigned long long)t->disorder, (unsigned long long)t->excused,
            (unsigned long long)t->unlike);
    fflush(out);
}

/* ---- again ---- */

static status show_ray(const scene *s, uint64_t index, outcome *what) {
    leafcast *volume = NULL;
    leafcast_hit hits[HITS_MAX];
    lab_ray r;
    int count = 0;
    status st = open_volume(s, NULL, 1, &volume);
    if (st == ST_OK)
        st = try_ray(s, volume, index, what, hits, &count);
    if (st == ST_OK && make_ray(s, index, &r)) {
        printf("o %.17g %.17g %.17g\nd %.17g %.17g %.17g\nfrom %s\n", r.line.o[0], r.line.o[1],
               r.line.o[2], r.line.d[0], r.line.d[1], r.line.d[2],
               r.from_outside ? "outside" : "inside");
        ref_hit truth[HITS_MAX];
        const size_t n = ref_trace(&s->v, &r.line, &s->f.iso, 1, NULL, truth, HITS_MAX);
        for (size_t i = 0; i < n && i < HITS_MAX; i++)
            printf("truth %.17g %s, cell %lld\n", truth[i].t,
                   truth[i].from_inside ? "leaving" : "entering", (long long)truth[i].cell);
        for (int i = 0; i < count; i++)
            printf("hit   %.17g %s, cell %llu\n", hits[i].t,
                   hits[i].entering ? "entering" : "leaving", (unsigned long long)hits[i].cell);
        puts(outcome_names[*what]);
    }
    leafcast_close(volume);
    return st;
}

int leak_lab_rerun(int argc, char **argv) {
    leak_lab_job job = {.rerun = "tool_stress", .log = stdout};
    if (argc < 4 || solid_find(argv[0]) < 0 || placing_find(argv[1]) < 0)
        return 2;
    const bool picture = strcmp(argv[3], "picture") == 0;
    if (argc != (picture ? 5 : 4))
        return 2;
    job.which = solid_find(argv[0]);
    job.placing = placing_find(argv[1]);
    job.seed = strtoull(argv[2], NULL, 10);
    job.side = picture ? (uint32_t)strtoull(argv[4], NULL, 10) : 0;
    scene s;
    leak_tally tally = {0};
    outcome what = FINE;
    scene_begin(&s, &job);
    const status st =
        picture ? run_pictures(&s, &tally) : show_ray(&s, strtoull(argv[3], NULL, 10), &what);
    scene_end(&s);
    if (picture)
        leak_tally_row(stdout, argv[0], &tally);
    if (st != ST_OK)
        printf("%s\n", status_text());
    return st != ST_OK || what == LEAK || what == DISORDER || leak_tally_faults(&tally) > 0;
}
