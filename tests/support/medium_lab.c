#include "tests/support/medium_lab.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/support/fixture.h"
#include "tests/support/lab_leaf.h"
#include "tests/support/pictures.h"
#include "tests/support/ref_judge.h"
#include "tests/support/tet_judge.h"

typedef long double real;

enum {
    NODES = 19,
    CUBES = 4,
    TREELET_TETS = 60,
    WIDTH = MEDIUM_WIDTH,
    HEIGHT = MEDIUM_HEIGHT,
    PIXELS = MEDIUM_PIXELS,
    PIECES_MAX = 4096,
    HITS_MAX = 512,
    TOLD_MAX = 12
};

/* ---- Volumes ---- */

/* Tets that overlap have no order, and tets that are there twice count once. */
static bool is_plain(const char *mesh) {
    static const char *const others[] = {"flat",    "flat-steps", "slivers",  "collapsed",
                                         "tangled", "apart-flat", "repeated", "farthest"};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        if (strcmp(mesh, others[i]) == 0)
            return false;
    return true;
}

static int plain_meshes(int wanted, const char **name) {
    int count = 0;
    for (int i = 0; i < lab_mesh_count(); i++)
        if (is_plain(lab_mesh_name(i)) && count++ == wanted)
            *name = lab_mesh_name(i);
    return count;
}

int medium_body_count(void) {
    return field_count() + FIELD_RETYPED + plain_meshes(-1, NULL);
}

static bool is_mesh_index(int index) {
    return index >= field_count() + FIELD_RETYPED;
}

static const char *plain_name(int index) {
    const char *name = NULL;
    if (index < field_count())
        return field_name(index);
    index -= field_count();
    if (index < FIELD_RETYPED)
        return field_retyped_name(index);
    plain_meshes(index - FIELD_RETYPED, &name);
    return name;
}

const char *medium_body_name(int index) {
    static char name[40];
    snprintf(name, sizeof name, "%s%s", is_mesh_index(index) ? "tets-" : "", plain_name(index));
    return name;
}

static void make_field(medium_body *b, int index, const leafcast_options *options) {
    const int other = index - field_count();
    field *f = &b->field;
    if (other >= 0)
        field_make_retyped(f, other, NODES, 3);
    else
        assert_true(field_make(f, field_name(index), NODES, 3));
    b->as_grid = field_volume(f);
    b->path = fixture_leaf(f, 4, 1, index % 2 > 0);
    b->volume = fixture_open(b->path, options);
}

static void make_mesh(medium_body *b, const char *name, int cubes,
                      const leafcast_options *options) {
    assert_true(lab_mesh_make(&b->mesh, name, cubes, 5));
    b->as_mesh = lab_mesh_reference(&b->mesh);
    b->path = lab_leaf_make(&b->mesh, TREELET_TETS, false);
    b->volume = fixture_open(b->path, options);
}

static void find_range(medium_body *b, field_random *r) {
    const leafcast_info info = leafcast_describe(b->volume);
    const long *n = b->field.dims;
    double length = 0.0;
    for (int a = 0; a < 3; a++)
        length = hypot(length, info.bounds[1][a] - info.bounds[0][a]);
    b->range = b->mesh.tet_count > 0
                   ? transfer_range_of(b->mesh.values, b->mesh.point_count, length, r)
                   : transfer_range_of(b->field.samples, (size_t)(n[0] * n[1] * n[2]), length, r);
}

void medium_body_make(medium_body *b, int index, const leafcast_options *options) {
    static const char *const wild[] = {"tiny",      "huge",          "wild",
                                       "tets-wild", "tets-denormal", "tets-minute",
                                       "tets-huge", "tets-raised",   "constant"};
    field_random r = {(uint64_t)index};
    *b = (medium_body){.tame = true};
    snprintf(b->name, sizeof b->name, "%s", medium_body_name(index));
    for (size_t i = 0; i < sizeof wild / sizeof *wild; i++)
        b->tame = b->tame && strcmp(b->name, wild[i]) != 0;
    if (is_mesh_index(index))
        make_mesh(b, plain_name(index), CUBES, options);
    else
        make_field(b, index, options);
    find_range(b, &r);
}

void medium_body_of_mesh(medium_body *b, const char *name, int cubes) {
    field_random r = {1};
    *b = (medium_body){.tame = true};
    snprintf(b->name, sizeof b->name, "tets-%s", name);
    make_mesh(b, name, cubes, NULL);
    find_range(b, &r);
}

void medium_body_of_bytes(medium_body *b, const char *name, const long dims[3],
                          const uint8_t *samples) {
    const size_t count = (size_t)(dims[0] * dims[1] * dims[2]);
    field_random r = {1};
    *b = (medium_body){.tame = true, .field = {.name = "bytes", .type = "u8"}};
    snprintf(b->name, sizeof b->name, "%s", name);
    field *f = &b->field;
    f->samples = malloc(count * sizeof *f->samples);
    assert_non_null(f->samples);
    for (size_t i = 0; i < count; i++)
        f->samples[i] = (float)samples[i];
    for (int a = 0; a < 3; a++) {
        f->dims[a] = dims[a];
        f->spacing[a] = 1.0;
    }
    b->as_grid = field_volume(f);
    b->path = fixture_leaf(f, 4, 1, false);
    b->volume = fixture_open(b->path, NULL);
    find_range(b, &r);
}

void medium_body_release(medium_body *b) {
    leafcast_close(b->volume);
    if (b->mesh.tet_count > 0)
        lab_mesh_release(&b->mesh);
    else
        field_release(&b->field);
}

ref_clip medium_body_clip(const medium_body *b, field_random *r, leafcast_scene *scene,
                          double box[2][3]) {
    const leafcast_info info = leafcast_describe(b->volume);
    ref_clip clip = {.t1 = (double)INFINITY};
    if (field_random_below(r, 3) > 0)
        return clip;
    scene->clip_box = field_random_below(r, 2);
    scene->clip_plane_count = (int)field_random_below(r, 3);
    for (int a = 0; a < 3; a++) {
        const double lo = info.bounds[0][a], size = info.bounds[1][a] - lo;
        box[0][a] = scene->clip_min[a] = lo + size * field_random_in(r, -0.1, 0.45);
        box[1][a] = scene->clip_max[a] = lo + size * field_random_in(r, 0.55, 1.1);
    }
    for (int i = 0; i < scene->clip_plane_count; i++) {
        double *p = scene->clip_planes[i];
        p[3] = 0.0;
        for (int a = 0; a < 3; a++) {
            p[a] = field_random_in(r, -1.0, 1.0);
            p[3] -= p[a] * field_random_in(r, info.bounds[0][a], info.bounds[1][a]);
        }
    }
    clip.planes = (const double(*)[4])scene->clip_planes;
    clip.plane_count = scene->clip_plane_count;
    clip.box = scene->clip_box ? (const double(*)[3])box : NULL;
    return clip;
}

leafcast_status medium_body_reopen(medium_body *b, const leafcast_options *options) {
    leafcast_close(b->volume);
    b->volume = NULL;
    return leafcast_open(b->path, options, &b->volume);
}

size_t medium_body_pieces(const medium_body *b, const ref_ray *ray, const ref_clip *clip,
                          ref_piece *out, size_t room) {
    return b->mesh.tet_count > 0 ? ref_mesh_pieces(&b->as_mesh, ray, clip, out, room)
                                 : ref_grid_pieces(&b->as_grid, ray, clip, out, room);
}

/* ---- Pictures ---- */

/* A picture and what it must show. */
typedef struct shot {
    const medium_job *job;
    int bodies; /* 1 or 2 */
    leafcast_transfer_point points[2][HOSTILE_POINTS_MAX];
    leafcast_medium media[2];
    leafcast_surface surface;
    leafcast_shown shown[2];
    leafcast_scene scene;
    leafcast_camera camera;
    double box[2][3];
    ref_clip clip; /* of the scene and the box */
    double asked;  /* the bound */
    int told;
    double rgba[PIXELS][4], error[PIXELS], value[PIXELS], z[PIXELS];
    leafcast_stats stats;
} shot;

static const medium_body *body_of(const shot *s, int i) {
    return i == 0 ? s->job->body : s->job->beside;
}

static void choose_camera(shot *s, field_random *r) {
    const leafcast_info info = leafcast_describe(s->job->body->volume);
    s->camera = pictures_view(s->job->body->volume, (int)field_random_below(r, PICTURE_VIEWS), r);
    s->camera.width = WIDTH;
    s->camera.height = HEIGHT;
    if (field_random_below(r, 4) == 0)
        s->camera.ortho_height = info.bounds[1][2] - info.bounds[0][2];
}

static void choose_background(shot *s, field_random *r) {
    for (int c = 0; c < 4; c++)
        s->scene.background[c] = (float)field_random_unit(r);
    if (field_random_below(r, 3) == 0)
        s->scene.background[3] = (float)field_random_below(r, 2);
}

/* All but what is looked for. */
static field_random shot_begin(shot *s, const medium_job *job) {
    field_random r = {job->seed};
    *s = (shot){.job = job};
    s->scene = leafcast_scene_default();
    s->stats.size = sizeof s->stats;
    s->bodies = job->beside ? 2 : 1;
    for (int i = 0; i < s->bodies; i++)
        s->shown[i].volume = body_of(s, i)->volume;
    choose_camera(s, &r);
    s->clip = medium_body_clip(s->job->body, &r, &s->scene, s->box);
    choose_background(s, &r);
    return r;
}

/* The planes of floats are the doubles, rounded. */
static void check_planes(const shot *s, float planes[4][MEDIUM_PIXELS]) {
    for (int i = 0; i < MEDIUM_PIXELS; i++)
        for (int c = 0; c < 4; c++)
            if (planes[c][i] != (float)s->rgba[i][c])
                fail_msg("pixel %d, channel %d: %a, not %a rounded", i, c, (double)planes[c][i],
                         s->rgba[i][c]);
}

static leafcast_status shot_draw(shot *s) {
    float planes[4][MEDIUM_PIXELS];
    const leafcast_image image = {.size = sizeof image,
                                  .r = planes[0],
                                  .g = planes[1],
                                  .b = planes[2],
                                  .a = planes[3],
                                  .rgba = s->rgba[0],
                                  .error = s->error,
                                  .value = s->value,
                                  .z = s->z};
    s->scene.volumes = s->shown;
    s->scene.volume_count = s->bodies;
    s->scene.media = s->media;
    s->scene.media_count = s->bodies;
    const leafcast_status st =
        leafcast_trace(s->shown[0].volume, &s->scene, &s->camera, &image, &s->stats, NULL, NULL);
    if (st == LEAFCAST_OK)
        check_planes(s, planes);
    return st;
}

static ref_ray shot_ray(const shot *s, int pixel) {
    ref_ray r;
    leafcast_pixel_ray(&s->camera, pixel % WIDTH + 0.5, pixel / WIDTH + 0.5, r.o, r.d);
    return r;
}

/* ---- Grazing ---- */

static real length_of(const medium_body *b, const ref_ray *ray, const ref_clip *clip) {
    static ref_piece pieces[PIECES_MAX];
    const size_t count = medium_body_pieces(b, ray, clip, pieces, PIECES_MAX);
    return ref_project(pieces, count).length;
}

/* Whether a ray a hair beside sees much more data of a body, or less. */
static bool grazes_body(const shot *s, const medium_body *b, const ref_ray *ray) {
    const real d[3] = {ray->d[0], ray->d[1], ray->d[2]}, own = length_of(b, ray, &s->clip);
    double far = b->range.length;
    for (int a = 0; a < 3; a++)
        far = fmax(far, fabs(ray->o[a]));
    if (own <= 1e-12L * far) /* it begins in the last face, and nothing but rounding is behind */
        return true;
    for (int n = 0; n < REF_SIDEWAYS; n++) {
        ref_ray moved = *ray;
        real shift[3];
        ref_sideways(d, n, shift);
        for (int a = 0; a < 3; a++)
            moved.o[a] += (double)(1e-9L * far * shift[a]);
        if (!(fabsl(length_of(b, &moved, &s->clip) - own) <= 1e-4L * b->range.length))
            return true;
    }
    return false;
}

static bool grazes_data(const shot *s, const ref_ray *ray) {
    return grazes_body(s, body_of(s, 0), ray) ||
           (s->bodies == 2 && grazes_body(s, body_of(s, 1), ray));
}

static bool grazes_surface(const shot *s, const ref_ray *ray) {
    const medium_body *b = s->job->body;
    if (s->shown[0].count == 0)
        return false;
    if (b->mesh.tet_count == 0)
        return ref_grazing(&b->as_grid, ray, &s->surface.isovalue, 1, &s->clip, 64);
    tet_ref *of = tet_ref_create(&b->as_mesh);
    const bool grazes = tet_judge_grazing(of, ray, &s->surface.isovalue, 1, &s->clip, 64);
    tet_ref_destroy(of);
    return grazes;
}

/* ---- The judge ---- */

static void tell(shot *s, int pixel, const char *what, real is, real bound) {
    const medium_job *j = s->job;
    if (s->told++ > 0 && !j->tell_all)
        return;
    fprintf(stderr, "# %s: error %.3Lg, bound %.3Lg, asked %.3g; pixel %d; rerun: %s %s %d %llu\n",
            what, is, bound, s->asked, pixel, j->rerun, j->body->name, j->kind,
            (unsigned long long)j->seed);
}

static size_t surfaces_of(const shot *s, const ref_ray *ray, ref_surface out[HITS_MAX]) {
    static ref_hit hits[HITS_MAX];
    const medium_body *b = s->job->body;
    size_t count = 0;
    if (s->shown[0].count == 0)
        return 0;
    if (b->mesh.tet_count > 0) {
        tet_ref *of = tet_ref_create(&b->as_mesh);
        count = tet_ref_trace(of, ray, &s->surface.isovalue, 1, &s->clip, hits, HITS_MAX);
        tet_ref_destroy(of);
    } else {
        count = ref_trace(&b->as_grid, ray, &s->surface.isovalue, 1, &s->clip, hits, HITS_MAX);
    }
    assert_true(count < HITS_MAX);
    for (size_t i = 0; i < count; i++) {
        out[i] = (ref_surface){.t = hits[i].t_exact, .opacity = s->surface.opacity};
        memcpy(out[i].rgb, s->surface.rgb, sizeof out[i].rgb);
    }
    return count;
}

static ref_colour truth_of(const shot *s, const ref_ray *ray, size_t *pieces_seen) {
    static ref_piece pieces[2][PIECES_MAX];
    static ref_surface surfaces[HITS_MAX];
    ref_medium of[2];
    const ref_media m = {.of = of,
                         .count = s->bodies,
                         .surfaces = surfaces,
                         .surface_count = (int)surfaces_of(s, ray, surfaces),
                         .background = {s->scene.background[0], s->scene.background[1],
                                        s->scene.background[2], s->scene.background[3]}};
    *pieces_seen = 0;
    for (int i = 0; i < s->bodies; i++) {
        const size_t count =
            medium_body_pieces(body_of(s, i), ray, &s->clip, pieces[i], PIECES_MAX);
        of[i] = (ref_medium){pieces[i], count, s->points[i], s->media[i].count};
        *pieces_seen += count;
    }
    return ref_media_colour(&m);
}

static real error_of(const double rgba[4], const ref_colour *truth) {
    real most = fabsl(rgba[3] - truth->alpha);
    for (int c = 0; c < 3; c++) {
        const real off = fabsl(rgba[c] - truth->rgb[c]);
        most = off <= most ? most : off; /* NaN is worst of all */
    }
    return most;
}

/* What doubles cannot tell apart, though the reference can. */
static const real SLACK = 4e-15L;

static bool is_in_world_space(const medium_body *b) {
    bool same = true;
    for (int a = 0; a < 3; a++)
        same = same &&
               (b->mesh.tet_count > 0 || (b->field.spacing[a] == 1 && b->field.origin[a] == 0));
    return same;
}

/* How much the truth changes when the ray is moved by what its way into the volume's own space may
 * round off; 0 where that is the world. */
static real moved_by_rounding(const shot *s, const ref_ray *ray, const ref_colour *truth) {
    real most = 0;
    for (int n = 0; n < 6 * s->bodies; n++) {
        const int a = n % 6 / 2;
        const medium_body *b = body_of(s, n / 6);
        const double by =
            8 * 0x1p-53 * (fabs(ray->o[a]) + fabs(b->field.origin[a]) + b->range.length);
        ref_ray moved = *ray;
        size_t seen;
        if (is_in_world_space(b))
            continue;
        moved.o[a] += n % 2 ? by : -by;
        const ref_colour c = truth_of(s, &moved, &seen);
        const double rgba[4] = {(double)c.rgb[0], (double)c.rgb[1], (double)c.rgb[2],
                                (double)c.alpha};
        most = fmaxl(most, error_of(rgba, truth));
    }
    return 3 * most;
}

/* What the renderer's own probes say of the ray, beside the reference. */
static void tell_way(const shot *s, const ref_ray *ray, int pixel) {
    static leafcast_segment own[PIECES_MAX];
    static leafcast_hit hits[HITS_MAX];
    static ref_surface surfaces[HITS_MAX];
    int pieces = 0, found = 0;
    double length = 0.0;
    (void)leafcast_probe_segments(s->shown[0].volume, &s->scene, ray->o, ray->d, own, PIECES_MAX,
                                  &pieces);
    for (int i = 0; i < pieces; i++)
        length += own[i].t1 - own[i].t0;
    if (s->shown[0].count > 0)
        (void)leafcast_probe_ray(s->shown[0].volume, &s->scene, ray->o, ray->d, hits, HITS_MAX,
                                 &found);
    fprintf(stderr, "# %d: length %.17g, not %.17Lg; %d surfaces, not %zu\n", pixel, length,
            length_of(s->job->body, ray, &s->clip), found, surfaces_of(s, ray, surfaces));
    for (int i = 0; i < found; i++)
        fprintf(stderr, "#   surface at %.17g, not %.17Lg\n", hits[i].t, surfaces[i].t);
}

static void judge(shot *s, int pixel, medium_tally *sum, uint64_t *refused) {
    const ref_ray ray = shot_ray(s, pixel);
    size_t seen;
    const ref_colour truth = truth_of(s, &ray, &seen);
    const real error = error_of(s->rgba[pixel], &truth), bound = s->error[pixel];
    sum->rays++;
    sum->seen += seen > 0;
    if (bound > s->asked)
        ++*refused;
    if (!(bound >= 0)) {
        sum->loose++;
        tell(s, pixel, "the bound is no number", error, bound);
    }
    if (s->job->tell_all)
        fprintf(stderr,
                "# %d: %.17g %.17g %.17g %.17g, not %.17Lg %.17Lg %.17Lg %.17Lg; error %.3Lg, "
                "bound %.3Lg\n",
                pixel, s->rgba[pixel][0], s->rgba[pixel][1], s->rgba[pixel][2], s->rgba[pixel][3],
                truth.rgb[0], truth.rgb[1], truth.rgb[2], truth.alpha, error, bound);
    if (error <= bound + truth.error + SLACK) {
        sum->worst = bound > 1e-12L ? fmax(sum->worst, (double)(error / bound)) : sum->worst;
    } else if (error <= bound + moved_by_rounding(s, &ray, &truth)) {
        sum->rounded++;
    } else if (grazes_data(s, &ray) || grazes_surface(s, &ray)) {
        sum->grazing++;
    } else {
        sum->outside++;
        tell(s, pixel, "outside", error, bound);
        if (s->job->tell_all)
            tell_way(s, &ray, pixel);
    }
}

/* All that a picture of a medium shows. */
static void shot_of_medium(shot *s, const medium_job *job) {
    static const double asked[] = {0.0, 1.0 / 16, 1.0 / 510, 1.0 / 4096, 1e-6, 1e-9};
    const medium_body *b = job->body;
    field_random r = shot_begin(s, job);
    s->scene.error = asked[field_random_below(&r, 6)];
    s->asked = s->scene.error > 0.0 ? s->scene.error : 1.0 / 510;
    s->media[0] =
        (leafcast_medium){s->points[0], hostile_transfer(job->kind, &b->range, &r, s->points[0])};
    s->surface = leafcast_surface_default(b->mesh.tet_count > 0 ? b->mesh.iso : b->field.iso);
    s->surface.opacity = field_random_below(&r, 2) ? 1.0F : 0.3F;
    s->scene.shading = LEAFCAST_SHADING_FLAT;
    s->shown[0].surfaces = &s->surface;
    s->shown[0].count = field_random_below(&r, 4) == 0 && b->tame;
    if (job->beside)
        s->media[1] = (leafcast_medium){
            s->points[1], hostile_transfer((int)field_random_below(&r, hostile_transfer_kinds()),
                                           &job->beside->range, &r, s->points[1])};
}

leafcast_status medium_lab_planes(const medium_job *job, medium_planes *planes) {
    static shot s;
    shot_of_medium(&s, job);
    const leafcast_status st = shot_draw(&s);
    memcpy(planes->rgba, s.rgba, sizeof s.rgba);
    memcpy(planes->error, s.error, sizeof s.error);
    return st;
}

leafcast_status medium_lab_ask(const medium_job *job, double asked, const leafcast_medium *medium,
                               medium_planes *planes, double off[MEDIUM_PIXELS]) {
    static shot s;
    shot_of_medium(&s, job);
    s.scene.error = asked;
    s.shown[0].count = 0;
    if (medium) {
        memcpy(s.points[0], medium->points, (size_t)medium->count * sizeof *medium->points);
        s.media[0].count = medium->count;
    }
    const leafcast_status st = shot_draw(&s);
    memcpy(planes->rgba, s.rgba, sizeof s.rgba);
    memcpy(planes->error, s.error, sizeof s.error);
    for (int i = 0; i < PIXELS && st == LEAFCAST_OK; i++) {
        const ref_ray ray = shot_ray(&s, i);
        size_t seen;
        const ref_colour truth = truth_of(&s, &ray, &seen);
        const real error = fmaxl(error_of(s.rgba[i], &truth) - truth.error - SLACK, 0);
        off[i] = error > s.error[i] && grazes_data(&s, &ray) ? NAN : (double)error;
    }
    return st;
}

void medium_lab_draw(const medium_job *job, medium_tally *sum) {
    static shot s;
    uint64_t refused = 0;
    shot_of_medium(&s, job);
    if (shot_draw(&s) != LEAFCAST_OK) {
        sum->loose++;
        tell(&s, -1, leafcast_error_text(), NAN, NAN);
        return;
    }
    for (int i = 0; i < PIXELS; i++)
        judge(&s, i, sum, &refused);
    sum->refused += refused;
    /* Where a surface is flat, its place is not known. */
    sum->needless += s.asked > 1e-4 && s.shown[0].count == 0 ? refused : 0;
    if (refused != s.stats.uncertified_pixels) {
        sum->loose++;
        tell(&s, -1, "pixels above the bound that was asked for, and counted ones", refused,
             s.stats.uncertified_pixels);
    }
}

/* ---- Projections ---- */

/* How far a value may be off: what a double keeps of it, and the slope times what it keeps of a
 * place. */
static real value_slack(const shot *s, const ref_ray *ray) {
    const medium_body *b = s->job->body;
    const leafcast_info info = leafcast_describe(b->volume);
    double far = b->range.length, narrow = INFINITY;
    for (int a = 0; a < 3; a++) {
        far = fmax(far, fabs(ray->o[a]) + fabs(info.bounds[0][a]) + fabs(info.bounds[1][a]));
        const long cells = b->mesh.tet_count > 0 ? CUBES : b->field.dims[a] - 1;
        narrow = fmin(narrow, (info.bounds[1][a] - info.bounds[0][a]) / (double)cells);
    }
    /* Cells of rectilinear grids, and tets of meshes, are narrower than most. */
    const double cells_far = 100.0 + far / (narrow / 100.0), range = b->range.most - b->range.least,
                 largest = fmax(fabs(b->range.least), fabs(b->range.most));
    return 1e-15L * (range * cells_far + largest);
}

/* The value at t of the ray, NaN: there is none. */
static real value_at(const ref_piece *pieces, size_t count, real t, real slack) {
    real most = NAN;
    for (size_t i = 0; i < count; i++)
        if (t >= pieces[i].t0 - slack && t <= pieces[i].t1 + slack)
            most = fmaxl(most, ref_piece_at(pieces[i].k, t - pieces[i].t0));
    return most;
}

/* Of a maximum or minimum: the extreme, and that the value is so at z. */
static bool is_extreme(const shot *s, int pixel, const ref_piece *pieces, size_t count,
                       real extreme, real slack) {
    const real there = value_at(pieces, count, s->z[pixel], 1e-9L * s->job->body->range.length);
    const real sign = s->scene.project == LEAFCAST_PROJECT_MIN ? -1 : 1;
    /* Beside the end of a piece it may have been left out. */
    const real steep = 1e-6L * (s->job->body->range.most - s->job->body->range.least);
    return fabsl(s->value[pixel] - extreme) <= slack && sign * (there - extreme) >= -slack - steep;
}

static bool is_first(const shot *s, int pixel, const ref_piece *pieces, size_t count, real slack) {
    const real wanted = s->scene.project_value, t = s->z[pixel];
    const real far = 1e-9L * s->job->body->range.length;
    real f[2];
    const real soonest = ref_first_at_least(pieces, count, wanted - slack, &f[0]),
               latest = ref_first_at_least(pieces, count, wanted + slack, &f[1]);
    if (isnan(s->value[pixel]))
        return isnan(latest) && t == INFINITY;
    return s->value[pixel] >= wanted - slack && t >= soonest - far &&
           (isnan(latest) || t <= latest + far) &&
           fabsl(value_at(pieces, count, t, far) - s->value[pixel]) <=
               slack + 1e-6L * (s->job->body->range.most - s->job->body->range.least);
}

static bool is_true(const shot *s, int pixel, const ref_ray *ray, const ref_piece *pieces,
                    size_t count) {
    const ref_extent e = ref_project(pieces, count);
    const real slack = value_slack(s, ray);
    if (s->scene.project == LEAFCAST_PROJECT_FIRST)
        return is_first(s, pixel, pieces, count, slack);
    if (count == 0 || isnan(s->value[pixel]))
        return count == 0 && isnan(s->value[pixel]) && s->z[pixel] == INFINITY;
    switch (s->scene.project) {
    case LEAFCAST_PROJECT_MAX: return is_extreme(s, pixel, pieces, count, e.most, slack);
    case LEAFCAST_PROJECT_MIN: return is_extreme(s, pixel, pieces, count, e.least, slack);
    default: return fabsl(s->value[pixel] - e.mean) <= slack && s->z[pixel] == INFINITY;
    }
}

void medium_lab_project(const medium_job *job, medium_tally *sum) {
    static ref_piece pieces[PIECES_MAX];
    static shot s;
    const medium_body *b = job->body;
    field_random r = shot_begin(&s, job);
    s.scene.project = (leafcast_project)job->kind;
    s.scene.project_value = field_random_below(&r, 3)
                                ? field_random_in(&r, b->range.least, b->range.most)
                                : b->range.some[field_random_below(&r, 4)];
    if (shot_draw(&s) != LEAFCAST_OK) {
        sum->loose++;
        tell(&s, -1, leafcast_error_text(), NAN, NAN);
        return;
    }
    for (int i = 0; i < PIXELS; i++) {
        const ref_ray ray = shot_ray(&s, i);
        const size_t count = medium_body_pieces(b, &ray, &s.clip, pieces, PIECES_MAX);
        sum->rays++;
        sum->seen += count > 0;
        if (is_true(&s, i, &ray, pieces, count))
            continue;
        if (grazes_data(&s, &ray) || length_of(b, &ray, &s.clip) < 1e-6L * b->range.length) {
            sum->grazing++;
            continue;
        }
        const ref_extent e = ref_project(pieces, count);
        sum->outside++;
        tell(&s, i, "outside", s.value[i], s.z[i]);
        if (job->tell_all)
            fprintf(stderr,
                    "#   of %.17Lg at %.17Lg, %.17Lg at %.17Lg, mean %.17Lg; wanted %.17g, slack "
                    "%.3Lg\n",
                    e.least, e.least_t, e.most, e.most_t, e.mean, s.scene.project_value,
                    value_slack(&s, &ray));
    }
}

/* ---- Tallies ---- */

void medium_tally_add(medium_tally *to, const medium_tally *from) {
    to->rays += from->rays;
    to->seen += from->seen;
    to->outside += from->outside;
    to->loose += from->loose;
    to->refused += from->refused;
    to->needless += from->needless;
    to->rounded += from->rounded;
    to->grazing += from->grazing;
    to->worst = fmax(to->worst, from->worst);
}

uint64_t medium_tally_faults(const medium_tally *t) {
    return t->outside + t->loose;
}

void medium_tally_print(const char *name, const char *kind, const medium_tally *t) {
    fprintf(stderr,
            "# %-22s %-10s %6llu rays, %6llu seen; outside %llu, loose %llu; refused %llu, grazing "
            "%llu; worst %.3g of the bound\n",
            name, kind, (unsigned long long)t->rays, (unsigned long long)t->seen,
            (unsigned long long)t->outside, (unsigned long long)t->loose,
            (unsigned long long)t->refused, (unsigned long long)t->grazing, t->worst);
}
