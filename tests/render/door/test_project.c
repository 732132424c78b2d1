/* test_project.c - maximum, minimum, mean and first value on rays: against brute force over all
 * cells in long double; the same bits however they are drawn; and treelets that do not matter are
 * not read.
 *
 *   test_project                      LEAFCAST_STRESS (1) pictures of each volume and projection
 *   test_project VOLUME KIND SEED     one picture, every pixel
 */
/* marks: threads, bits, long */
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
#include "render/door/leafcast_volume.h"
#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/leaf_files.h"
#include "tests/support/medium_lab.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_media.h"
#include "tests/support/watched.h"

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
    leafcast_camera view;
    double box[2][3];
    ref_clip clip; /* of the scene and the box */
    real near;     /* what values may be off by, */
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

static void ask(const shot *s, const ref_ray *way, truth *t) {
    t->count = medium_body_pieces(s->body, way, &s->clip, t->pieces, PIECES_MAX);
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

/* What a ray a hair beside, before or behind sees: along edges, in faces, or from a boundary on
 * that may be other cells. Where there is nothing (empty), it may be a piece as short as that. */
static bool is_right_beside(const shot *s, const ref_ray *way, bool empty, double value, double z) {
    static truth t;
    const real d[3] = {way->d[0], way->d[1], way->d[2]};
    double far = s->body->range.length;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fabs(way->o[a]));
    for (int n = 0; n < REF_SIDEWAYS + 2; n++) {
        ref_ray moved = *way;
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
    ref_ray way;
    leafcast_pixel_ray(&s->view, i % WIDTH + 0.5, i / WIDTH + 0.5, way.o, way.d);
    ask(s, &way, &t);
    v->rays++;
    v->seen += !isnan(s->value[i]);
    if (is_right(s, &t, s->value[i], s->z[i]))
        return;
    v->grazing++;
    if (is_right_beside(s, &way, t.count == 0, s->value[i], s->z[i]))
        return;
    v->faults++;
    const ref_extent e = ref_project(t.pieces, t.count);
    if (v->faults < 3 || s->tell_all)
        fprintf(
            stderr,
            "# pixel %d: %.17g at %.17g; truth: %.17Lg .. %.17Lg at %.17Lg, %.17Lg, mean %.17Lg, "
            "threshold %.17g; rerun: %s %s %d %llu\n",
            i, s->value[i], s->z[i], e.least, e.most, e.least_t, e.most_t, e.mean,
            s->scene.project_value, program, s->body->name, s->kind, (unsigned long long)s->seed);
}

/* ---- Pictures ---- */

/* How far values may be off: more where cells are narrow beside the distance to the eye. */
static real near_of(const shot *s) {
    const transfer_range *range = &s->body->range;
    const field *f = &s->body->field;
    real far = 0, narrowest = s->body->mesh.tet_count > 0 ? range->length : INFINITY;
    for (int a = 0; a < 3; a++) {
        far += fabsl((real)s->view.eye[a]) + fabsl((real)s->view.look_at[a]);
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
    s->view = pictures_view(s->body->volume, (int)field_random_below(&r, PICTURE_VIEWS), &r);
    s->view.width = WIDTH;
    s->view.height = HEIGHT;
    if (field_random_below(&r, 4) == 0)
        s->view.ortho_height = info.bounds[1][2] - info.bounds[0][2];
    s->clip = medium_body_clip(s->body, &r, &s->scene, s->box);
    s->scene.project = kinds[s->kind].project;
    s->scene.project_value =
        field_random_below(&r, 3) == 0
            ? range->some[field_random_below(&r, 4)]
            : range->least + (range->most - range->least) * field_random_unit(&r);
    s->shown = (leafcast_shown){.volume = s->body->volume};
    s->scene.volumes = &s->shown;
    s->scene.volume_count = 1;
    s->near = near_of(s);
}

static void shot_draw(shot *s) {
    const leafcast_image image = {
        .size = sizeof image, .value = s->value, .z = s->z, .rgba = s->rgba[0]};
    if (leafcast_trace(s->body->volume, &s->scene, &s->view, &image, &s->stats, NULL, NULL) !=
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
    skip_under_thread();
    verdict all = {0};
    for (int i = 0; i < medium_body_count(); i += EMULATED ? 5 : 1) {
        medium_body b;
        verdict v = {0};
        medium_body_make(&b, i, &two_threads);
        for (int kind = 0; kind < KINDS; kind++)
            for (uint64_t n = 0; n < (SLOW ? 1 : 3) * stress_count(); n++)
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

/* ---- The same bits ---- */

enum { SIDE = SLOW ? 24 : 40, MANY = SIDE * SIDE };

typedef struct projected {
    double value[MANY], z[MANY], rgba[MANY][4];
    uint8_t provisional[MANY];
    leafcast_stats stats;
} projected;

static leafcast_camera camera_of(const leafcast *v, double distance) {
    return leafcast_standard_view(v, distance, SIDE, SIDE);
}

static void project(leafcast *v, const leafcast_scene *scene, const leafcast_camera *view,
                    projected *out) {
    const leafcast_image image = {.size = sizeof image,
                                  .value = out->value,
                                  .z = out->z,
                                  .rgba = out->rgba[0],
                                  .provisional = out->provisional};
    memset(out, 0, sizeof *out);
    out->stats.size = sizeof out->stats;
    if (leafcast_trace(v, scene, view, &image, &out->stats, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void same_bits(const projected *a, const projected *b) {
    assert_memory_equal(a->value, b->value, sizeof a->value);
    assert_memory_equal(a->z, b->z, sizeof a->z);
    assert_memory_equal(a->rgba, b->rgba, sizeof a->rgba);
}

static leafcast_scene scene_of(int kind, double threshold) {
    leafcast_scene scene = leafcast_scene_default();
    scene.project = kinds[kind].project;
    scene.project_value = threshold;
    scene.background[1] = 0.5F;
    scene.background[3] = 0.25F;
    return scene;
}

/* One way to draw, beside a picture by one thread, without vectors, with room for everything. */
static void check_way(const char *path, const leafcast_scene *scene, double distance,
                      const leafcast_options *options, const projected *wanted) {
    static projected is;
    leafcast *v = fixture_open(path, options);
    const leafcast_camera view = camera_of(v, distance);
    project(v, scene, &view, &is);
    same_bits(wanted, &is);
    leafcast_close(v);
}

static void check_all_ways(const char *path, int kind, double threshold, double distance) {
    static projected wanted;
    const leafcast_scene scene = scene_of(kind, threshold);
    leafcast_options o = {.size = sizeof o, .threads = 1, .isa = "scalar"};
    leafcast *v = fixture_open(path, &o);
    const leafcast_camera view = camera_of(v, distance);
    project(v, &scene, &view, &wanted);
    assert_true(wanted.stats.covered_pixels > MANY / 20);
    leafcast_close(v);
    for (int isa = WATCHED_THREADS ? (int)cpu_best() : 0; isa <= (int)cpu_best(); isa++) {
        o = (leafcast_options){.size = sizeof o, .threads = 2, .isa = cpu_isa_name((cpu_isa)isa)};
        check_way(path, &scene, distance, &o, &wanted);
    }
    for (uint32_t limit = 1; limit < 40; limit += SLOW ? 26 : 13) {
        o = (leafcast_options){.size = sizeof o,
                               .threads = 3,
                               .backend =
                                   limit % 2 ? LEAFCAST_BACKEND_MAPPED : LEAFCAST_BACKEND_ARENA,
                               .experiments = EXPERIMENTS(.treelet_limit = limit)};
        check_way(path, &scene, distance, &o, &wanted);
    }
}

static void test_same_bits(void **state) {
    (void)state;
    static const char *const fields[] = {"noise-u8", "noise-f32", "rectilinear", "missing"};
    int drawn = 0;
    for (int i = 0; i < field_count(); i++) {
        bool wanted = false;
        for (size_t k = 0; k < sizeof fields / sizeof *fields; k++)
            wanted |= strcmp(field_name(i), fields[k]) == 0;
        if (!wanted)
            continue;
        field f;
        assert_true(field_make(&f, field_name(i), 37, 3));
        char path[512];
        snprintf(path, sizeof path, "%s", fixture_leaf(&f, 4, 1, false));
        for (int kind = 0; kind < KINDS; kind++)
            check_all_ways(path, kind, f.iso, kind % 2 ? 0.2 : 1.6);
        field_release(&f);
        drawn++;
    }
    assert_int_equal(drawn, sizeof fields / sizeof *fields);
}

static void test_same_bits_of_meshes(void **state) {
    (void)state;
    lab_mesh lab;
    assert_true(lab_mesh_make(&lab, "noise", 7, 5));
    char path[512];
    snprintf(path, sizeof path, "%s", lab_leaf_make(&lab, 80, false));
    for (int kind = 0; kind < KINDS; kind++)
        check_all_ways(path, kind, lab.iso, kind % 2 ? 0.2 : 1.6);
    lab_mesh_release(&lab);
}

/* ---- What is read ---- */

/* Whether the ray passes a treelet of level 0, moved out by `margin`. */
static bool passes(const leaf_layout *l, uint32_t t, const uint32_t dims[3], const ref_ray *r,
                   double margin) {
    double t0 = 0.0, t1 = (double)INFINITY;
    for (int a = 0; a < 3; a++) {
        const double first = (double)((uint32_t)l->place[t][a] << l->cells_log2);
        const double lo = first - margin,
                     hi = fmin(first + (1u << l->cells_log2), dims[a] - 1.0) + margin;
        const double p = (lo - r->o[a]) / r->d[a], q = (hi - r->o[a]) / r->d[a];
        t0 = fmax(t0, fmin(p, q));
        t1 = fmin(t1, fmax(p, q));
    }
    return t0 < t1;
}

/* Treelets that hold more than the final value of a ray through them, or (margin above 0) as much,
 * or nearly pass so. */
static uint32_t needed(const leafcast *v, const leafcast_camera *view, const projected *p,
                       bool least, double margin) {
    const leaf_layout *l = &v->file->layout;
    uint32_t count = 0;
    for (uint32_t t = l->level[0].first; t < l->treelets; t++) {
        bool is = false;
        for (int i = 0; i < MANY && !is; i++) {
            ref_ray r;
            const double own = (double)v->file->own[t][least ? 0 : 1];
            const double more = least ? p->value[i] - own : own - p->value[i];
            if (isnan(p->value[i]) || !(more > 0.0 || (more == 0.0 && margin > 0.0)))
                continue;
            leafcast_pixel_ray(view, i % SIDE + 0.5, i / SIDE + 0.5, r.o, r.d);
            is = passes(l, t, v->file->header.dims, &r, margin);
        }
        count += is;
    }
    return count;
}

static void check_reads(sample_type type, bool least) {
    static projected p;
    leaf_case c = leaf_files_case(131, 120, 97, type);
    void *samples = leaf_files_random(&c, 5, 0);
    c.samples = samples;
    c.options.file.cells_log2 = 4;
    leafcast *v = fixture_open(leaf_files_make(&c, "reads.leaf"), &two_threads);
    const leafcast_camera view = camera_of(v, 1.7);
    const leafcast_scene scene = scene_of(least ? 1 : 0, 0.0);
    project(v, &scene, &view, &p);
    const uint32_t surely = needed(v, &view, &p, least, -1e-9),
                   perhaps = needed(v, &view, &p, least, 1e-9);
    fprintf(stderr, "# %llu treelets read of %u; %u exceed a pixel, %u with those that equal it\n",
            (unsigned long long)p.stats.treelets_loaded, v->file->layout.level[0].count, surely,
            perhaps);
    assert_true(p.stats.treelets_loaded <= perhaps);
    assert_true(10 * p.stats.treelets_loaded <= 12 * surely);
    assert_true(p.stats.treelets_loaded < v->file->layout.level[0].count);
    leafcast_close(v);
    free(samples);
}

static void test_reads_what_exceeds(void **state) {
    (void)state;
    check_reads(SAMPLE_F32, false);
    check_reads(SAMPLE_F32, true);
    check_reads(SAMPLE_U16, false);
}

/* ---- Places, colours, refusals ---- */

/* A row of cells along x: 10 but for a plateau of 200 from 8 to 12, one from 20 to 22, data missing
 * from 14 to 16. */
static const char *make_row(void) {
    static float samples[5 * 5 * 33];
    leaf_case c = leaf_files_case(33, 5, 5, SAMPLE_F32);
    for (size_t i = 0; i < sizeof samples / sizeof *samples; i++) {
        const size_t x = i % 33;
        samples[i] = (x >= 8 && x <= 12) || (x >= 20 && x <= 22) ? 200.0F : x == 15 ? NAN : 10.0F;
    }
    c.samples = samples;
    c.options.file.cells_log2 = 4;
    return leaf_files_make(&c, "row.leaf");
}

/* One pixel, along +x from x = -2, or against it. */
static void look_along(leafcast *v, const leafcast_scene *scene, bool back, double out[3]) {
    const leafcast_camera view = {.size = sizeof view,
                                  .eye = {back ? 34 : -2, 2.3, 1.7},
                                  .look_at = {16, 2.3, 1.7},
                                  .up = {0, 0, 1},
                                  .width = 1,
                                  .height = 1,
                                  .ortho_height = 1e-3};
    const leafcast_image image = {
        .size = sizeof image, .value = &out[0], .z = &out[1], .rgba = NULL};
    if (leafcast_trace(v, scene, &view, &image, NULL, NULL, NULL) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
}

static void test_places(void **state) {
    (void)state;
    leafcast *v = fixture_open(make_row(), NULL);
    const leafcast_scene max = scene_of(0, 0), min = scene_of(1, 0), mean = scene_of(2, 0);
    double is[3];
    look_along(v, &max, false, is);
    assert_true(is[0] == 200.0 && is[1] == 10.0); /* the first of two plateaus */
    look_along(v, &max, true, is);
    assert_true(is[0] == 200.0 && is[1] == 12.0);
    look_along(v, &min, false, is);
    assert_true(is[0] == 10.0 && is[1] == 2.0);
    look_along(v, &mean, false, is);
    /* 10 over 30 cells with data, and 190 over 4 + 1 and 2 + 1. */
    assert_true(fabs(is[0] - (10.0 + 190.0 * 8.0 / 30.0)) < 1e-12 && is[1] == (double)INFINITY);
    leafcast_scene first = scene_of(3, 105.0);
    look_along(v, &first, false, is);
    assert_true(is[0] == 105.0 && fabs(is[1] - 9.5) < 1e-12);
    first.project_value = 10.0; /* data begins with it */
    look_along(v, &first, false, is);
    assert_true(is[0] == 10.0 && is[1] == 2.0);
    first.project_value = 200.0; /* that is reached, not passed */
    look_along(v, &first, false, is);
    assert_true(is[0] == 200.0 && fabs(is[1] - 10.0) < 1e-12);
    first.project_value = 201.0;
    look_along(v, &first, false, is);
    assert_true(isnan(is[0]) && is[1] == (double)INFINITY);
    /* A clip in a plateau, and one where data is missing. */
    first.project_value = 150.0;
    first.clip_plane_count = 1;
    first.clip_planes[0][0] = 1.0;
    first.clip_planes[0][3] = -11.0;
    look_along(v, &first, false, is);
    assert_true(is[0] == 200.0 && is[1] == 13.0);
    first = scene_of(3, 200.0); /* it is reached where the way ends */
    first.clip_box = true;
    memcpy(first.clip_min, (double[3]){-9, -9, -9}, sizeof first.clip_min);
    memcpy(first.clip_max, (double[3]){8, 9, 9}, sizeof first.clip_max);
    look_along(v, &first, false, is);
    assert_true(is[0] == 200.0 && is[1] == 10.0);
    leafcast_scene clipped = scene_of(0, 0);
    clipped.clip_box = true;
    memcpy(clipped.clip_min, (double[3]){14.5, -9, -9}, sizeof clipped.clip_min);
    memcpy(clipped.clip_max, (double[3]){15.5, 9, 9}, sizeof clipped.clip_max);
    look_along(v, &clipped, false, is);
    assert_true(isnan(is[0]) && is[1] == (double)INFINITY);
    leafcast_close(v);
}

static void test_long_way(void **state) {
    (void)state;
    leafcast *v = fixture_open(leaf_files_long("long.leaf"), NULL);
    const leafcast_scene max = scene_of(0, 0);
    double is[3];
    for (int again = 0; again < 2; again++) { /* with treelets absent, and with all there */
        look_along(v, &max, false, is);
        assert_true(is[0] == 5.0 && is[1] == LEAF_FILES_LONG);
    }
    leafcast_close(v);
}

static void test_colours(void **state) {
    (void)state;
    static const leafcast_transfer_point points[] = {
        {10, {0, 0.5F, 1}, 0}, {110, {1, 0.5F, 0}, 3}, {110, {0.25F, 0, 0}, 0}};
    const leafcast_medium medium = {points, 3};
    const leafcast_camera view = {.size = sizeof view,
                                  .eye = {-2, 2.3, 1.7},
                                  .look_at = {16, 2.3, 1.7},
                                  .up = {0, 0, 1},
                                  .width = 1,
                                  .height = 1,
                                  .ortho_height = 1e-3};
    leafcast *v = fixture_open(make_row(), NULL);
    double rgba[4], error = -1;
    float alpha = -1;
    const leafcast_image image = {.size = sizeof image, .rgba = rgba, .error = &error, .a = &alpha};
    leafcast_scene scene = scene_of(3, 60.0);
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    for (int c = 0; c < 3; c++)
        assert_true(fabs(rgba[c] - 50.0 / 190.0) < 1e-15);
    assert_true(rgba[3] == 1.0 && alpha == 1.0F && error == 0.0);
    scene.media = &medium;
    scene.media_count = 1;
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    assert_true(rgba[0] == 0.5 && rgba[1] == 0.5 && rgba[2] == 0.5 && rgba[3] == 1.0);
    scene.project = LEAFCAST_PROJECT_MAX;
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    assert_true(rgba[0] == 0.25 && rgba[1] == 0.0 && rgba[3] == 1.0);
    scene.project = LEAFCAST_PROJECT_FIRST;
    scene.project_value = 300.0; /* there is none: the background */
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_OK);
    assert_true(rgba[0] == 0.0 && rgba[1] == 0.125 && rgba[3] == 0.25 && alpha == 0.25F);
    scene.project_value = (double)NAN;
    assert_int_equal(leafcast_trace(v, &scene, &view, &image, NULL, NULL, NULL), LEAFCAST_USAGE);
    leafcast_close(v);
}

/* The same but for rounding: the rays of a preview are cut to the volume's box first. */
static bool is_nearly(double a, double b) {
    return isnan(a) ? isnan(b) : fabs(a - b) <= 1e-9 * (1.0 + fabs(a));
}

/* What a preview does not mark is exact. */
static void check_preview(const char *path, int kind, double threshold) {
    static projected exact, is;
    leafcast_options o = {
        .size = sizeof o, .threads = 2, .experiments = EXPERIMENTS(.treelet_limit = 30)};
    leafcast_scene scene = scene_of(kind, threshold);
    leafcast *v = fixture_open(path, NULL);
    const leafcast_camera view = camera_of(v, 1.2);
    project(v, &scene, &view, &exact);
    leafcast_close(v);
    v = fixture_open(path, &o);
    scene.preview = true;
    project(v, &scene, &view, &is);
    assert_true(is.stats.provisional_pixels > 0);
    for (int i = 0; i < MANY; i++)
        assert_true(is.provisional[i] || is_nearly(exact.value[i], is.value[i]));
    leafcast_close(v);
    v = fixture_open(path, NULL);
    for (int i = 0; i < 1000 && (i == 0 || is.stats.provisional_pixels > 0); i++)
        project(v, &scene, &view, &is);
    assert_int_equal(is.stats.provisional_pixels, 0);
    for (int i = 0; i < MANY; i++)
        assert_true(is_nearly(exact.value[i], is.value[i]));
    leafcast_close(v);
}

static void test_preview(void **state) {
    (void)state;
    field f;
    lab_mesh lab;
    char path[512];
    assert_true(field_make(&f, "noise-u8", 60, 3));
    snprintf(path, sizeof path, "%s", fixture_leaf(&f, 4, 1, false));
    for (int kind = 0; kind < KINDS; kind++)
        check_preview(path, kind, f.iso);
    field_release(&f);
    assert_true(lab_mesh_make(&lab, "noise", 7, 5));
    snprintf(path, sizeof path, "%s", lab_leaf_make(&lab, 40, false));
    for (int kind = 0; kind < KINDS; kind++)
        check_preview(path, kind, lab.iso);
    lab_mesh_release(&lab);
}

/* A grid and a mesh in one scene: of both together. */
static void test_several_volumes(void **state) {
    (void)state;
    static projected of[3];
    leafcast_device *device;
    leafcast_shown shown[2] = {{0}};
    field f;
    lab_mesh lab;
    assert_true(field_make(&f, "noise-f32", 20, 3));
    assert_true(lab_mesh_make(&lab, "noise", 5, 5));
    assert_int_equal(leafcast_device_create(NULL, &device), LEAFCAST_OK);
    const leafcast_options o = {.size = sizeof o, .device = device};
    shown[0].volume = fixture_open(fixture_leaf(&f, 4, 1, false), &o);
    shown[1].volume = fixture_open(lab_leaf_make(&lab, 80, false), &o);
    const leafcast_camera view = camera_of(shown[1].volume, 0.9);
    for (int kind = 0; kind < KINDS; kind++) {
        leafcast_scene scene = scene_of(kind, 0.3);
        for (int i = 0; i < 3; i++) {
            scene.volumes = &shown[i % 2];
            scene.volume_count = i < 2 ? 1 : 2;
            scene.volumes = i < 2 ? &shown[i] : shown;
            project(shown[i % 2].volume, &scene, &view, &of[i]);
        }
        for (int i = 0; i < MANY; i++) {
            const double a = of[0].value[i], b = of[1].value[i], both = of[2].value[i];
            const bool second = kinds[kind].project == LEAFCAST_PROJECT_MAX ? !(a >= b)
                                : kinds[kind].project == LEAFCAST_PROJECT_MIN
                                    ? !(a <= b)
                                    : of[1].z[i] < of[0].z[i];
            if (isnan(a) || isnan(b))
                assert_true(isnan(a) ? memcmp(&both, &b, sizeof b) == 0 : both == a);
            else if (kinds[kind].project == LEAFCAST_PROJECT_MEAN)
                assert_true(fmin(a, b) <= both && both <= fmax(a, b));
            else
                assert_true(both == (second ? b : a));
        }
    }
    leafcast_close(shown[0].volume);
    leafcast_close(shown[1].volume);
    leafcast_device_destroy(device);
    field_release(&f);
    lab_mesh_release(&lab);
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
        cmocka_unit_test(test_places),
        cmocka_unit_test(test_long_way),
        cmocka_unit_test(test_colours),
        cmocka_unit_test(test_against_brute_force),
        cmocka_unit_test(test_same_bits),
        cmocka_unit_test(test_same_bits_of_meshes),
        cmocka_unit_test(test_reads_what_exceeds),
        cmocka_unit_test(test_preview),
        cmocka_unit_test(test_several_volumes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
