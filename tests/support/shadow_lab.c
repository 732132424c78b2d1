#include "tests/support/shadow_lab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/support/fixture.h"
#include "tests/support/ref_judge.h"
#include "tests/support/solids.h"

enum { CELLS_LOG2 = 4, EVERY = 11 };

#define NEAR   1e-3 /* of a cell */
#define FACING 1e-5 /* cosine from which on a point faces the light: normals are floats */

typedef struct stage {
    const shadow_lab_job *job;
    field f;
    ref_volume v;
    leafcast *volume;
    leafcast_scene scene;
    leafcast_camera camera;
    double light[3]; /* towards it, unit */
    bool walled;     /* the eye is inside a wall */
    float *red, *normal[3];
    double *z;
    shadow_tally *tally;
} stage;

static void direction(field_random *r, double d[3]) {
    double length;
    do {
        length = 0;
        for (int a = 0; a < 3; a++) {
            d[a] = field_random_in(r, -1, 1);
            length += d[a] * d[a];
        }
    } while (length < 0.01 || length > 1);
    for (int a = 0; a < 3; a++)
        d[a] /= sqrt(length);
}

/* An eye outside, the whole solid in sight; or in the middle of a hollow one, looking anywhere. */
static void set_view(stage *s, int index) {
    field_random r = {s->job->seed * 1000 + (uint64_t)index};
    double d[3], longest = 0;
    const leafcast_info info = leafcast_describe(s->volume);
    s->walled = (solid_kind(s->job->which) & SOLID_HOLLOW) && index % 2 == 0;
    s->camera = (leafcast_camera){.size = sizeof(leafcast_camera),
                                  .up = {0.1, 0.2, 1},
                                  .fov = s->walled ? 110 : 35,
                                  .width = s->job->side,
                                  .height = s->job->side};
    direction(&r, d);
    direction(&r, s->light);
    for (int a = 0; a < 3; a++)
        longest = fmax(longest, info.bounds[1][a] - info.bounds[0][a]);
    for (int a = 0; a < 3; a++) {
        const double extent = info.bounds[1][a] - info.bounds[0][a];
        const double middle = info.bounds[0][a] + extent / 2;
        /* Into every shape of box alike: near on its short axes. */
        s->camera.eye[a] = middle + (s->walled ? 0.02 * d[a] : 1.7 * d[a]) * extent;
        s->camera.look_at[a] = s->walled ? middle + d[(a + 1) % 3] * longest : middle;
        s->scene.lights[0].vector[a] = s->light[a];
    }
}

static status draw(stage *s) {
    const leafcast_image image = {.size = sizeof(leafcast_image),
                                  .r = s->red,
                                  .z = s->z,
                                  .normal = {s->normal[0], s->normal[1], s->normal[2]}};
    leafcast_stats stats = {.size = sizeof stats};
    if (leafcast_trace(s->volume, &s->scene, &s->camera, &image, &stats, NULL, NULL) != LEAFCAST_OK)
        return status_describe(ST_FAILED, "%s", leafcast_error_text());
    s->tally->ill_conditioned += stats.ill_conditioned;
    return ST_OK;
}

/* ---- the reference's light ---- */

typedef enum verdict { LIT, SHADED, UNCLEAR } verdict;

/* Whether light reaches the nearest surface of a primary ray, on the side it is seen from. */
static verdict light_at(const stage *s, const ref_ray *primary) {
    ref_hit seen, met;
    if (ref_trace(&s->v, primary, &s->f.iso, 1, NULL, &seen, 1) == 0 ||
        ref_grazing(&s->v, primary, &s->f.iso, 1, NULL, 1))
        return UNCLEAR;
    ref_ray way;
    for (int a = 0; a < 3; a++) {
        way.o[a] = (double)(primary->o[a] + seen.t_exact * primary->d[a]);
        way.d[a] = s->light[a];
    }
    /* A cell's length on this way. */
    long double o[3], d[3];
    double cells = 0;
    ref_to_grid(&s->v, &way, o, d);
    for (int a = 0; a < 3; a++) {
        double width = 1;
        for (long i = 0; s->v.axis[a] && i + 1 < s->v.dims[a]; i++)
            if (s->v.axis[a][i] <= (double)o[a])
                width = s->v.axis[a][i + 1] - s->v.axis[a][i];
        cells += (double)(d[a] * d[a]) / (width * width);
    }
    const double step = NEAR / sqrt(cells);
    const ref_clip beyond = {.t0 = step, .t1 = INFINITY};
    const ref_clip near = {.t0 = step / 1e3, .t1 = step};
    if (ref_trace(&s->v, &way, &s->f.iso, 1, &near, &met, 1) > 0 ||
        ref_grazing(&s->v, &way, &s->f.iso, 1, &beyond, 1))
        return UNCLEAR;
    return ref_trace(&s->v, &way, &s->f.iso, 1, &beyond, &met, 1) > 0 ? SHADED : LIT;
}

/* ---- judging ---- */

static void judge_pixel(stage *s, size_t at) {
    shadow_tally *t = s->tally;
    if (!(s->z[at] < (double)INFINITY))
        return;
    double o[3], d[3], facing = 0, seen = 0;
    const uint32_t width = s->camera.width;
    leafcast_pixel_ray(&s->camera, (double)(at % width) + 0.5, (double)(at / width) + 0.5, o, d);
    for (int a = 0; a < 3; a++) {
        facing += (double)s->normal[a][at] * s->light[a];
        seen -= (double)s->normal[a][at] * d[a];
    }
    const bool lit = s->red[at] > 0;
    t->points++;
    if ((solid_kind(s->job->which) & SOLID_CONVEX) && placing_is_even(s->job->placing) &&
        facing > FACING && seen > FACING) {
        t->facing++;
        t->acne += !lit;
    }
    if (s->walled) {
        t->walled++;
        t->leaks += lit;
    }
    /* Light from behind the surface needs no ray. */
    if (at % EVERY != 0 || fabs(facing) < FACING * 100 || fabs(seen) < FACING * 100 ||
        facing * seen < 0)
        return;
    const ref_ray primary = {{o[0], o[1], o[2]}, {d[0], d[1], d[2]}};
    const verdict v = light_at(s, &primary);
    t->unclear += v == UNCLEAR;
    t->judged += v != UNCLEAR;
    t->shaded += v == SHADED;
    t->wrong += v != UNCLEAR && (v == LIT) != lit;
}

static status open_stage(stage *s, const char *path) {
    const leafcast_options options = {
        .size = sizeof(leafcast_options), .threads = 1, .isa = s->job->isa};
    leafcast_surface surface = leafcast_surface_default(s->f.iso);
    for (int c = 0; c < 3; c++)
        surface.rgb[c] = 1;
    if (leafcast_open(path, &options, &s->volume) != LEAFCAST_OK ||
        leafcast_select(s->volume, &surface, 1) != LEAFCAST_OK)
        return status_describe(ST_FAILED, "%s", leafcast_error_text());
    s->scene = leafcast_scene_default();
    s->scene.light_count = 1;
    s->scene.lights[0] = (leafcast_light){.rgb = {1, 1, 1}};
    s->scene.ambient = 0;
    s->scene.shadows = true;
    s->scene.analytic_normals = true;
    for (int c = 0; c < 4; c++)
        s->scene.background[c] = 0;
    return ST_OK;
}

status shadow_lab_run(const shadow_lab_job *job, shadow_tally *tally) {
    const size_t pixels = (size_t)job->side * job->side;
    stage s = {.job = job, .tally = tally};
    *tally = (shadow_tally){0};
    s.z = calloc(pixels, sizeof *s.z);
    s.red = calloc(4 * pixels, sizeof *s.red);
    if (!s.z || !s.red) {
        free(s.z);
        free(s.red);
        return status_describe(ST_NOMEM, "no room for %zu pixels", pixels);
    }
    for (size_t a = 0; a < 3; a++)
        s.normal[a] = s.red + (a + 1) * pixels;
    solid_make(&s.f, job->which, job->placing, job->seed);
    s.v = field_volume(&s.f);
    const char *path = fixture_leaf(&s.f, CELLS_LOG2 + (uint32_t)(job->seed % 2), 1, false);
    status st = open_stage(&s, path);
    for (int i = 0; st == ST_OK && i < job->views; i++) {
        set_view(&s, i);
        st = draw(&s);
        for (size_t at = 0; st == ST_OK && at < pixels; at++)
            judge_pixel(&s, at);
    }
    if (shadow_tally_faults(tally) > 0)
        fprintf(job->log, "%s; rerun: %s shadow %s %s %llu %d %u %s\n",
                tally->acne > 0    ? "acne"
                : tally->leaks > 0 ? "light leaks"
                                   : "wrong light",
                job->rerun, solid_name(job->which), placing_name(job->placing),
                (unsigned long long)job->seed, job->views, (unsigned)job->side, job->isa);
    leafcast_close(s.volume);
    (void)unlink(path);
    field_release(&s.f);
    free(s.z);
    free(s.red);
    return st;
}

/* ---- tallies ---- */

void shadow_tally_add(shadow_tally *to, const shadow_tally *from) {
    to->points += from->points;
    to->facing += from->facing;
    to->acne += from->acne;
    to->walled += from->walled;
    to->leaks += from->leaks;
    to->judged += from->judged;
    to->shaded += from->shaded;
    to->wrong += from->wrong;
    to->unclear += from->unclear;
    to->ill_conditioned += from->ill_conditioned;
}

uint64_t shadow_tally_faults(const shadow_tally *tally) {
    return tally->acne + tally->leaks + tally->wrong;
}

void shadow_tally_heading(FILE *out) {
    fprintf(out, "%-20s %9s %9s %7s %9s %7s %9s %8s %7s %8s %8s\n", "shadows", "points", "facing",
            "acne", "walled", "leaks", "judged", "shaded", "wrong", "unclear", "ill");
}

void shadow_tally_row(FILE *out, const char *name, const shadow_tally *t) {
    fprintf(out, "%-20s %9llu %9llu %7llu %9llu %7llu %9llu %8llu %7llu %8llu %8llu\n", name,
            (unsigned long long)t->points, (unsigned long long)t->facing,
            (unsigned long long)t->acne, (unsigned long long)t->walled,
            (unsigned long long)t->leaks, (unsigned long long)t->judged,
            (unsigned long long)t->shaded, (unsigned long long)t->wrong,
            (unsigned long long)t->unclear, (unsigned long long)t->ill_conditioned);
    fflush(out);
}

int shadow_lab_rerun(int argc, char **argv) {
    if (argc != 6 || solid_find(argv[0]) < 0 || placing_find(argv[1]) < 0)
        return 2;
    const shadow_lab_job job = {.which = solid_find(argv[0]),
                                .placing = placing_find(argv[1]),
                                .seed = strtoull(argv[2], NULL, 10),
                                .views = (int)strtol(argv[3], NULL, 10),
                                .side = (uint32_t)strtoull(argv[4], NULL, 10),
                                .isa = argv[5],
                                .rerun = "tool_stress",
                                .log = stdout};
    shadow_tally tally;
    if (shadow_lab_run(&job, &tally) != ST_OK) {
        printf("%s\n", status_text());
        return 1;
    }
    shadow_tally_heading(stdout);
    shadow_tally_row(stdout, argv[0], &tally);
    return shadow_tally_faults(&tally) > 0;
}
