#include "tests/support/cell_judge.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/pictures.h"
#include "tests/support/scratch.h"

/* Relative to the volume's extent, and to its values. */
static const double near_enough = 1e-10;

typedef struct bench {
    const cell_truth *truth;
    leafcast *v;
    leafcast_info info;
    uint32_t step;
    double size; /* of the volume */
} bench;

static int by_t(const void *a, const void *b) {
    const cell_chord *x = a, *y = b;
    return x->t0 < y->t0 ? -1 : x->t0 > y->t0;
}

/* Chords from t = 0 on, in order. */
static int chords_of(const bench *b, const double origin[3], const double direction[3],
                     cell_chord out[CELL_CHORDS_MAX], bool *grazing) {
    cell_chord all[CELL_CHORDS_MAX];
    int count = 0;
    const int n = b->truth->chords(b->truth->ctx, b->step, origin, direction, all, grazing);
    for (int i = 0; i < n; i++) {
        *grazing |= all[i].t0 < 0.0L && all[i].t1 > 0.0L;
        if (all[i].t0 >= 0.0L)
            out[count++] = all[i];
    }
    qsort(out, (size_t)count, sizeof *out, by_t);
    return count;
}

/* ---- Pieces ---- */

static void random_ray(const bench *b, field_random *r, int n, double origin[3],
                       double direction[3]) {
    for (int a = 0; a < 3; a++) {
        const double lo = b->info.bounds[0][a], hi = b->info.bounds[1][a];
        origin[a] = lo + (hi - lo) * (3.0 * field_random_unit(r) - 1.0);
        direction[a] = n % 7 == a ? 0.0 : lo + (hi - lo) * field_random_unit(r) - origin[a];
    }
}

static int judge_ray(const bench *b, const double origin[3], const double direction[3],
                     bool *grazing) {
    static leafcast_segment got[CELL_CHORDS_MAX];
    cell_chord want[CELL_CHORDS_MAX];
    const leafcast_scene scene = leafcast_scene_default();
    int count = 0;
    const int wanted = chords_of(b, origin, direction, want, grazing);
    assert_int_equal(
        leafcast_probe_segments(b->v, &scene, origin, direction, got, CELL_CHORDS_MAX, &count),
        LEAFCAST_OK);
    if (*grazing)
        return 0;
    assert_int_equal(count, wanted);
    for (int i = 0; i < count; i++) {
        assert_int_equal(got[i].cell, want[i].number);
        assert_true(fabs((double)(got[i].t0 - want[i].t0)) <= near_enough * 100.0);
        assert_true(fabs((double)(got[i].t1 - want[i].t1)) <= near_enough * 100.0);
        assert_true(fabs((double)(got[i].most - want[i].most)) <= near_enough * b->truth->most);
        assert_true(fabs((double)(got[i].least - want[i].least)) <= near_enough * b->truth->most);
        /* From cell to cell at one t. */
        if (i > 0 && fabsl(want[i].t0 - want[i - 1].t1) < 1e-15L)
            assert_true(got[i].t0 == got[i - 1].t1);
    }
    return count;
}

static void judge_pieces(const bench *b) {
    field_random r = {FIELD_SEED + b->step};
    int all = 0, grazes = 0;
    for (int n = 0; n < 500; n++) {
        double origin[3], direction[3];
        bool grazing = false;
        random_ray(b, &r, n, origin, direction);
        all += judge_ray(b, origin, direction, &grazing);
        grazes += grazing;
    }
    print_message("# step %u: %d pieces, %d grazing rays\n", b->step, all, grazes);
    assert_true(all > 400 && grazes < 50);
}

static double value_in(const leafcast_segment *s, double at) {
    double b[4];
    memcpy(b, s->control, sizeof b);
    for (int left = s->degree; left > 0; left--)
        for (int i = 0; i < left; i++)
            b[i] += at * (b[i + 1] - b[i]);
    return b[0];
}

/* Values along pieces that a clip has cut, against those at points. */
static void judge_clipped(const bench *b) {
    static leafcast_segment got[CELL_CHORDS_MAX];
    leafcast_scene scene = leafcast_scene_default();
    field_random r = {FIELD_SEED + 7 + b->step};
    int all = 0, cut = 0, wrong = 0;
    scene.clip_box = true;
    for (int a = 0; a < 3; a++) {
        const double lo = b->info.bounds[0][a], hi = b->info.bounds[1][a];
        scene.clip_min[a] = lo + 0.31 * (hi - lo);
        scene.clip_max[a] = lo + 0.77 * (hi - lo);
    }
    for (int n = 0; n < 1000; n++) {
        double origin[3], direction[3];
        int count = 0;
        random_ray(b, &r, n, origin, direction);
        assert_int_equal(
            leafcast_probe_segments(b->v, &scene, origin, direction, got, CELL_CHORDS_MAX, &count),
            LEAFCAST_OK);
        for (int k = 0; k < 3 * count; k++) {
            const leafcast_segment *s = &got[k / 3];
            const double at = (1 + k % 3) / 4.0, t = s->t0 + at * (s->t1 - s->t0);
            const double point[3] = {origin[0] + t * direction[0], origin[1] + t * direction[1],
                                     origin[2] + t * direction[2]};
            long double want = 0.0L;
            bool grazing = false;
            const bool any = b->truth->value(b->truth->ctx, b->step, point, &want, &grazing);
            wrong +=
                !grazing &&
                (!any || !(fabs((double)(value_in(s, at) - want)) <= near_enough * b->truth->most));
            all += !grazing;
            cut += fabs(value_in(s, 0.0)) > 0.01 || fabs(value_in(s, 1.0)) > 0.01;
        }
    }
    print_message("# step %u: %d values in clipped pieces, %d wrong\n", b->step, all, wrong);
    assert_true(all > 200 && cut > 50);
    assert_int_equal(wrong, 0);
}

/* ---- Pictures ---- */

/* What a pixel is to show. */
typedef struct expected {
    long double length, integral, most, least;
} expected;

static expected expected_of(const cell_chord chords[], int count) {
    expected e = {.most = -INFINITY, .least = INFINITY};
    for (int i = 0; i < count; i++) {
        const long double length = chords[i].t1 - chords[i].t0;
        e.length += length;
        e.integral += length * chords[i].mean;
        e.most = fmaxl(e.most, chords[i].most);
        e.least = fminl(e.least, chords[i].least);
    }
    return e;
}

/* Extinction is proportional to the value, so that the opacity is known in closed form. */
static const double density = 0.08;

static leafcast_scene filled(const bench *b, leafcast_medium *medium,
                             leafcast_transfer_point points[2]) {
    leafcast_scene s = leafcast_scene_default();
    points[0] = (leafcast_transfer_point){.value = 0.0, .rgb = {0.5, 0.25, 1.0}};
    points[1] = points[0];
    points[1].value = b->truth->most;
    points[1].extinction = density * b->truth->most;
    *medium = (leafcast_medium){points, 2};
    s.media = medium;
    s.media_count = 1;
    return s;
}

enum { OPACITY, MOST, LEAST, MEAN, QUESTIONS };

static leafcast_scene scene_of(const bench *b, int question, leafcast_medium *medium,
                               leafcast_transfer_point points[2]) {
    static const leafcast_project project[QUESTIONS] = {
        LEAFCAST_PROJECT_NONE, LEAFCAST_PROJECT_MAX, LEAFCAST_PROJECT_MIN, LEAFCAST_PROJECT_MEAN};
    leafcast_scene s = filled(b, medium, points);
    s.project = project[question];
    return s;
}

static double answer_of(const expected *e, int question) {
    switch (question) {
    case OPACITY: return (double)(1.0L - expl(-(long double)density * e->integral));
    case MOST: return (double)e->most;
    case LEAST: return (double)e->least;
    default: return (double)(e->integral / e->length);
    }
}

typedef struct plane_of {
    double rgba[4 * PICTURE_PIXELS], error[PICTURE_PIXELS], value[PICTURE_PIXELS];
} plane_of;

static void draw(leafcast *v, const leafcast_scene *s, plane_of *p) {
    const leafcast_camera c = leafcast_standard_view(v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    const leafcast_image image = {
        .size = sizeof image, .rgba = p->rgba, .error = p->error, .value = p->value};
    memset(p, 0, sizeof *p);
    assert_int_equal(leafcast_trace(v, s, &c, &image, NULL, NULL, NULL), LEAFCAST_OK);
}

static void judge_picture(const bench *b, int question) {
    static plane_of p;
    leafcast_medium medium;
    leafcast_transfer_point points[2];
    const leafcast_scene s = scene_of(b, question, &medium, points);
    const leafcast_camera c = leafcast_standard_view(b->v, 1.3, PICTURE_WIDTH, PICTURE_HEIGHT);
    int seen = 0, wrong = 0, grazes = 0;
    draw(b->v, &s, &p);
    for (uint32_t i = 0; i < PICTURE_PIXELS; i++) {
        double origin[3], direction[3];
        cell_chord chords[CELL_CHORDS_MAX];
        bool grazing = false;
        leafcast_pixel_ray(&c, i % PICTURE_WIDTH + 0.5, i / PICTURE_WIDTH + 0.5, origin, direction);
        const int count = chords_of(b, origin, direction, chords, &grazing);
        grazes += grazing;
        if (grazing)
            continue;
        if (count == 0) {
            wrong += question == OPACITY ? p.rgba[4 * i + 3] != 0.0 : !isnan(p.value[i]);
            continue;
        }
        const expected e = expected_of(chords, count);
        const double want = answer_of(&e, question);
        const double got = question == OPACITY ? p.rgba[4 * i + 3] : p.value[i];
        const double error =
            question == OPACITY ? p.error[i] : near_enough * fmax(b->truth->most, 1.0);
        seen++;
        wrong += !(fabs(got - want) <= error) || (question == OPACITY && !(error <= 1.0 / 510));
    }
    print_message("# step %u, question %d: %d pixels, %d wrong, %d grazing\n", b->step, question,
                  seen, wrong, grazes);
    assert_true(seen > PICTURE_PIXELS / 8 && grazes < PICTURE_PIXELS / 8);
    assert_int_equal(wrong, 0);
}

/* The same bits with one treelet at a time, and by any number of threads. */
static void judge_budget(const bench *b, const char *path) {
    static plane_of want, got;
    for (int question = 0; question < QUESTIONS; question++) {
        leafcast_medium medium;
        leafcast_transfer_point points[2];
        const leafcast_options one = {.size = sizeof one,
                                      .threads = 1 + question % 2,
                                      .experiments = EXPERIMENTS(.treelet_limit = 1)};
        leafcast *v = fixture_open(path, &one);
        leafcast_scene s = scene_of(b, question, &medium, points);
        s.shade_media = question == OPACITY && b->step == 0;
        assert_int_equal(leafcast_select_set(v, 0, b->step), LEAFCAST_OK);
        draw(b->v, &s, &want);
        draw(v, &s, &got);
        assert_memory_equal(&want, &got, sizeof want);
        leafcast_close(v);
    }
}

/* A preview says how far it may be off, while treelets are absent. */
static void judge_preview(const bench *b, const char *path) {
    static plane_of want, got;
    leafcast_medium medium;
    leafcast_transfer_point points[2];
    leafcast_scene s = filled(b, &medium, points);
    int off = 0, wrong = 0;
    draw(b->v, &s, &want);
    s.preview = true;
    for (uint32_t limit = 1; limit <= 4; limit++) {
        const leafcast_options few = {.size = sizeof few,
                                      .experiments = EXPERIMENTS(.treelet_limit = limit)};
        leafcast *v = fixture_open(path, &few);
        assert_int_equal(leafcast_select_set(v, 0, b->step), LEAFCAST_OK);
        draw(v, &s, &got);
        for (uint32_t i = 0; i < PICTURE_PIXELS * 4; i++) {
            const double by = fabs(got.rgba[i] - want.rgba[i]);
            off += by > want.error[i / 4] + near_enough;
            wrong += !(by <= got.error[i / 4] + want.error[i / 4]);
        }
        leafcast_close(v);
    }
    assert_true(off > 0);
    assert_int_equal(wrong, 0);
}

/* ---- Points ---- */

/* The gradient at points is that of the value: by differences, in the cell's inside. */
static void judge_gradients(const bench *b) {
    field_random r = {FIELD_SEED + 11 + b->step};
    const double h = 1e-4 * b->info.cell_size;
    int seen = 0, wrong = 0;
    for (int n = 0; n < 2000; n++) {
        leafcast_sample s;
        double point[3], off = 0.0, size = 0.0;
        bool grazing = false;
        for (int a = 0; a < 3; a++)
            point[a] = b->info.bounds[0][a] +
                       (b->info.bounds[1][a] - b->info.bounds[0][a]) * field_random_unit(&r);
        assert_int_equal(leafcast_probe_point(b->v, point, &s), LEAFCAST_OK);
        for (int a = 0; a < 3 && s.inside; a++) {
            long double value[2];
            for (int side = 0; side < 2; side++) {
                double at[3] = {point[0], point[1], point[2]};
                at[a] += side ? h : -h;
                grazing |= !b->truth->value(b->truth->ctx, b->step, at, &value[side], &grazing);
            }
            off = fmax(off, fabs((double)((value[1] - value[0]) / (2.0L * h)) - s.gradient[a]));
            size = fmax(size, fabs(s.gradient[a]));
        }
        if (!s.inside || grazing)
            continue;
        seen++;
        wrong += off > 1e-5 * fmax(size, b->truth->most);
    }
    print_message("# step %u: %d gradients, %d wrong\n", b->step, seen, wrong);
    assert_true(seen > 50);
    assert_true(wrong <= seen / 50); /* differences that reach into the next cell */
}

/* ---- Slices ---- */

static void judge_slice(const bench *b) {
    leafcast_slice_pixels s = {.size = sizeof s};
    double plane[4] = {0.6, 0.0, 0.8, 0.0};
    int seen = 0, wrong = 0;
    for (int a = 0; a < 3; a++)
        plane[3] -= plane[a] * (b->info.bounds[0][a] + b->info.bounds[1][a]) / 2.0;
    assert_int_equal(leafcast_plane_slice(b->v, plane, &s), LEAFCAST_OK);
    s.width *= 8; /* finer than cells */
    s.height *= 8;
    double *value = malloc(sizeof *value * s.width * s.height);
    assert_non_null(value);
    assert_int_equal(leafcast_sample_slice(b->v, &s, value, NULL, NULL, NULL), LEAFCAST_OK);
    for (uint32_t i = 0; i < s.width * s.height; i++) {
        const double x = (i % s.width + 0.5) / s.width, y = (i / s.width + 0.5) / s.height;
        double point[3];
        long double want = 0.0L;
        bool grazing = false;
        for (int a = 0; a < 3; a++)
            point[a] = s.origin[a] + x * s.u[a] + y * s.v[a];
        const bool any = b->truth->value(b->truth->ctx, b->step, point, &want, &grazing);
        seen += any;
        wrong +=
            !grazing && (any ? !(fabs((double)(value[i] - want)) <= near_enough * b->truth->most)
                             : !isnan(value[i]));
    }
    print_message("# step %u, slice of %u x %u: %d inside, %d wrong\n", b->step, s.width, s.height,
                  seen, wrong);
    assert_true(seen > 20);
    assert_int_equal(wrong, 0);
    free(value);
}

void cell_judge(const leaf_image *image, const cell_truth *truth) {
    const char *path = scratch_write("judged.leaf", image->bytes, image->size);
    bench b = {.truth = truth, .v = fixture_open(path, NULL)};
    b.info = leafcast_describe(b.v);
    assert_int_equal(b.info.steps, truth->steps);
    for (b.step = 0; b.step < truth->steps; b.step++) {
        assert_int_equal(leafcast_select_set(b.v, 0, b.step), LEAFCAST_OK);
        judge_pieces(&b);
        judge_clipped(&b);
        for (int question = 0; question < QUESTIONS; question++)
            judge_picture(&b, question);
        judge_budget(&b, path);
        judge_preview(&b, path);
        judge_gradients(&b);
        judge_slice(&b);
    }
    leafcast_close(b.v);
}
