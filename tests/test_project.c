/* test_project.c - maximum, minimum, mean and first value on rays: against brute force over all
 * cells in long double; the same bits however they are drawn; and treelets that do not matter are
 * not read.
 *
 *   test_project                      LEAFCAST_STRESS (1) pictures of each volume and projection
 *   test_project VOLUME KIND SEED     one picture, every pixel
 */
/* marks: threads, bits */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "formats/base/cpu.h"
#include "formats/leaf/leaf_file.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/leaf_files.h"
#include "tests/support/medium_lab.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_media.h"

typedef long double real;

enum { SEED = 1, WIDTH = 9, HEIGHT = 7, PIXELS = WIDTH * HEIGHT, PIECES_MAX = 4096, KINDS = 4 };

static const struct {
    const char *name;
    leafcast_project project;
} kinds[KINDS] = {{"max", LEAFCAST_PROJECT_MAX},
                  {"min", LEAFCAST_PROJECT_MIN},
                  {"mean", LEAFCAST_PROJECT_MEAN},
                  {"first", LEAFCAST_PROJECT_FIRST}};

static const char *program;

/* ---- What is true ---- */

/* A picture of a volume, and what it must show. */
typedef struct shot {
    const medium_body *body;
    int kind;
    uint64_t seed;
    bool tell_all;
    leafcast_shown shown;
    leafcast_scene scene;
    leafcast_camera camera;
    double planes[LEAFCAST_CLIP_PLANES_MAX][4], box[2][3];
    ref_clip clip;
    real near; /* what values may be off by, */
    double value[PIXELS], z[PIXELS], rgba[PIXELS][4];
    leafcast_stats stats;
} shot;

/* How a pixel is judged. */
typedef struct verdict {
    uint64_t rays, seen, grazing, faults;
} verdict;

typedef struct truth {
    ref_piece pieces[PIECES_MAX];
    size_t count;
} truth;

static void ask(const shot *s, const ref_ray *ray, truth *t) {
    t->count = medium_body_pieces(s->body, ray, &s->clip, t->pieces, PIECES_MAX);
    assert_true(t->count < PIECES_MAX);
}

/* Whether the value is there near t. */
static bool is_at(const truth *t, double z, real value, real near) {
    for (size_t i = 0; i < t->count; i++) {
        const ref_piece *p = &t->pieces[i];
        const real slack = 1e-9L * (1.0L + fabsl(p->t1)), length = p->t1 - p->t0;
        if (z < p->t0 - slack || z > p->t1 + slack)
            continue;
        for (int k = -1; k <= 1; k++) {
            const real x = fminl(fmaxl(z - p->t0 + k * slack, 0.0L), length);
            if (fabsl(ref_piece_at(p->k, x) - value) <= near)
                return true;
        }
        /* As steep as that. */
        const real lo = ref_piece_at(p->k, fminl(fmaxl(z - p->t0 - slack, 0.0L), length)),
                   hi = ref_piece_at(p->k, fminl(fmaxl(z - p->t0 + slack, 0.0L), length));
        if ((lo <= value && value <= hi) || (hi <= value && value <= lo))
            return true;
    }
    return false;
}

static bool first_is_right(const shot *s, const truth *t, double value, double z) {
    const real v = (real)s->scene.project_value, near = s->near;
    real f;
    const real late = ref_first_at_least(t->pieces, t->count, v + near, &f),
               early = ref_first_at_least(t->pieces, t->count, v - near, &f);
    if (isnan(value))
        return isnan(late) && z == (double)INFINITY;
    const real slack = 1e-9L * (1.0L + fabsl((real)z));
    return early <= z + slack && !(late < z - slack) && value >= s->scene.project_value &&
           is_at(t, z, (real)value, near);
}

static bool is_right(const shot *s, const truth *t, double value, double z) {
    const ref_extent e = ref_project(t->pieces, t->count);
    if (kinds[s->kind].project == LEAFCAST_PROJECT_FIRST)
        return first_is_right(s, t, value, z);
    if (t->count == 0 || isnan(value))
        return t->count == 0 && isnan(value) && z == (double)INFINITY;
    if (kinds[s->kind].project == LEAFCAST_PROJECT_MEAN)
        return fabsl((real)value - e.mean) <= s->near && z == (double)INFINITY;
    const real wanted = kinds[s->kind].project == LEAFCAST_PROJECT_MAX ? e.most : e.least;
    return fabsl((real)value - wanted) <= s->near && is_at(t, z, wanted, 2 * s->near);
}

/* What a ray a hair beside, before or behind sees: along edges, in faces, or from a boundary on that
 * may be other cells. Where there is nothing (empty), it may be a piece as short as that. */
static bool is_right_beside(const shot *s, const ref_ray *ray, bool empty, double value, double z) {
    static truth t;
    const real d[3] = {ray->d[0], ray->d[1], ray->d[2]};
    double far = s->body->range.length;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fabs(ray->o[a]));
    for (int n = 0; n < REF_SIDEWAYS + 2; n++) {
        ref_ray moved = *ray;
        real shift[3];
        if (n < REF_SIDEWAYS)
            ref_sideways(d, n, shift);
        const double along = n < REF_SIDEWAYS ? 0.0 : n == REF_SIDEWAYS ? 1e-9 * far : -1e-9 * far;
        for (int a = 0; a < 3 && n >= REF_SIDEWAYS; a++)
            shift[a] = n == REF_SIDEWAYS ? -d[a] : d[a];
        for (int a = 0; a < 3; a++)
            moved.o[a] += (double)(1e-9L * far * shift[a]);
        ask(s, &moved, &t);
        if (is_right(s, &t, value, z + along) ||
            (empty && is_at(&t, (isfinite(z) ? z : 0.0) + along, (real)value, s->near)))
            return true;
    }
    return false;
}

static void judge(const shot *s, int i, verdict *v) {
    static truth t;
    ref_ray ray;
    leafcast_pixel_ray(&s->camera, i % WIDTH + 0.5, i / WIDTH + 0.5, ray.o, ray.d);
    ask(s, &ray, &t);
    v->rays++;
    v->seen += !isnan(s->value[i]);
    if (is_right(s, &t, s->value[i], s->z[i]))
        return;
    v->grazing++;
    if (is_right_beside(s, &ray, t.count == 0, s->value[i], s->z[i]))
        return;
    v->faults++;
    const ref_extent e = ref_project(t.pieces, t.count);
    if (v->faults < 3 || s->tell_all)
        fprintf(stderr,
                "# pixel %d: %.17g at %.17g; truth: %.17Lg .. %.17Lg at %.17Lg, %.17Lg, mean %.17Lg, "
                "threshold %.17g; rerun: %s %s %d %llu\n",
                i, s->value[i], s->z[i], e.least, e.most, e.least_t, e.most_t, e.mean,
                s->scene.project_value, program, s->body->name, s->kind,
                (unsigned long long)s->seed);
}

/* ---- Pictures ---- */

static void choose_clip(shot *s, field_random *r) {
    const leafcast_info info = leafcast_describe(s->body->volume);
    s->clip = (ref_clip){.t1 = (double)INFINITY};
    if (field_random_below(r, 3) > 0)
        return;
    s->scene.clip_box = field_random_below(r, 2);
    s->scene.clip_plane_count = (int)field_random_below(r, 3);
    for (int a = 0; a < 3; a++) {
        const double lo = info.bounds[0][a], size = info.bounds[1][a] - lo;
        s->box[0][a] = s->scene.clip_min[a] = lo + size * field_random_in(r, -0.1, 0.45);
        s->box[1][a] = s->scene.clip_max[a] = lo + size * field_random_in(r, 0.55, 1.1);
    }
    for (int i = 0; i < s->scene.clip_plane_count; i++) {
        double *p = s->planes[i];
        p[3] = 0.0;
        for (int a = 0; a < 3; a++) {
            p[a] = field_random_in(r, -1.0, 1.0);
            p[3] -= p[a] * field_random_in(r, info.bounds[0][a], info.bounds[1][a]);
        }
        memcpy(s->scene.clip_planes[i], p, sizeof s->planes[i]);
    }
    s->clip.planes = (const double(*)[4])s->planes;
    s->clip.plane_count = s->scene.clip_plane_count;
    s->clip.box = s->scene.clip_box ? (const double(*)[3])s->box : NULL;
}

/* How far values may be off: more where cells are narrow beside the distance to the eye. */
static real near_of(const shot *s) {
    const transfer_range *range = &s->body->range;
    const field *f = &s->body->field;
    real far = 0, narrowest = s->body->mesh.tet_count > 0 ? range->length : INFINITY;
    for (int a = 0; a < 3; a++) {
        far += fabsl((real)s->camera.eye[a]) + fabsl((real)s->camera.look_at[a]);
        for (long i = 0; s->body->mesh.tet_count == 0 && i + 1 < f->dims[a]; i++)
            narrowest = fminl(narrowest, fabsl((real)f->spacing[a]) *
                                             (f->axis[a] ? f->axis[a][i + 1] - f->axis[a][i] : 1));
    }
    return ((real)range->most - (real)range->least) * (1e-8L + 0x1p-45L * far / narrowest) +
           1e-14L * fmaxl(fabsl((real)range->most), fabsl((real)range->least));
}

static void shot_begin(shot *s) {
    const leafcast_info info = leafcast_describe(s->body->volume);
    const transfer_range *range = &s->body->range;
    field_random r = {s->seed};
    s->scene = leafcast_scene_default();
    s->stats.size = sizeof s->stats;
    s->camera = pictures_view(s->body->volume, (int)field_random_below(&r, PICTURE_VIEWS), &r);
    s->camera.width = WIDTH;
    s->camera.height = HEIGHT;
    if (field_random_below(&r, 4) == 0)
        s->camera.ortho_height = info.bounds[1][2] - info.bounds[0][2];
    choose_clip(s, &r);
    s->scene.project = kinds[s->kind].project;
    s->scene.project_value = field_random_below(&r, 3) == 0
                                 ? range->some[field_random_below(&r, 4)]
                                 : range->least + (range->most - range->least) *
                                                      field_random_unit(&r);
    s->shown = (leafcast_shown){.volume = s->body->volume};
    s->scene.volumes = &s->shown;
    s->scene.volume_count = 1;
    s->near = near_of(s);
}

static void shot_draw(shot *s) {
    const leafcast_image image = {
        .size = sizeof image, .value = s->value, .z = s->z, .rgba = s->rgba[0]};
    if (leafcast_trace(s->body->volume, &s->scene, &s->camera, &image, &s->stats, NULL, NULL) !=
        LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void check_shot(const medium_body *b, int kind, uint64_t seed, bool tell_all, verdict *v) {
    shot s = {.body = b, .kind = kind, .seed = seed, .tell_all = tell_all};
    shot_begin(&s);
    shot_draw(&s);
    for (int i = 0; i < PIXELS; i++)
        judge(&s, i, v);
}

static uint64_t stress_count(void) {
    const char *text = getenv("LEAFCAST_STRESS");
    return text ? strtoull(text, NULL, 10) : 1;
}

static const leafcast_options two_threads = {.size = sizeof two_threads, .threads = 2};

static void test_against_brute_force(void **state) {
    (void)state;
    verdict all = {0};
    for (int i = 0; i < medium_body_count(); i++) {
        medium_body b;
        verdict v = {0};
        medium_body_make(&b, i, &two_threads);
        for (int kind = 0; kind < KINDS; kind++)
            for (uint64_t n = 0; n < 3 * stress_count(); n++)
                check_shot(&b, kind, SEED + 1000 * n + (uint64_t)kind, false, &v);
        if (v.faults > 0)
            fprintf(stderr, "# %s: %llu of %llu rays\n", b.name, (unsigned long long)v.faults,
                    (unsigned long long)v.rays);
        medium_body_release(&b);
        all.rays += v.rays;
        all.seen += v.seen;
        all.grazing += v.grazing;
        all.faults += v.faults;
    }
    fprintf(stderr, "# %llu rays, %llu seen, %llu grazing, %llu wrong\n",
            (unsigned long long)all.rays, (unsigned long long)all.seen,
            (unsigned long long)all.grazing, (unsigned long long)all.faults);
    assert_int_equal(all.faults, 0);
    assert_true(all.seen > all.rays / 3);
    assert_true(all.grazing < all.rays / 50);
}

static int rerun(char **argv) {
    for (int i = 0; i < medium_body_count(); i++) {
        if (strcmp(medium_body_name(i), argv[0]) != 0)
            continue;
        medium_body b;
        verdict v = {0};
        medium_body_make(&b, i, &two_threads);
        check_shot(&b, atoi(argv[1]), strtoull(argv[2], NULL, 10), true, &v);
        medium_body_release(&b);
        return v.faults > 0;
    }
    return 2;
}

int main(int argc, char **argv) {
    program = argv[0];
    if (argc == 4)
        return rerun(argv + 1);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_against_brute_force),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
