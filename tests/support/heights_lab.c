#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "prep/grid/convert.h"
#include "tests/support/heights_lab.h"
#include "tests/support/scratch.h"

/* ---- Terrains ---- */

static const struct {
    const char *name, *type;
    double scale; /* world z of a height of 1, in cells */
    double place; /* of node (0, 0), in cells */
} shapes[HEIGHTS_SHAPES] = {
    {"hills", "f32", 1.0, 0.0},    {"noise", "f32", 1.0, 0.0},       {"plateaus", "i16", 1.0, 0.0},
    {"needles", "i16", 0.01, 0.0}, {"holes", "f32", 1.0, 0.0},       {"far", "f32", 1.0, 1e6},
    {"tiny", "f32", 1e30, 0.0},    {"huge", "f32", 1e-30, 0.0},      {"flat", "u8", 1.0, 0.0},
    {"saddles", "i8", 0.05, 0.0},  {"mountains", "u16", 0.002, 0.0},
};

const char *heights_lab_name(int shape) {
    return shapes[shape].name;
}

static double height(int shape, int i, int j, field_random *r) {
    const double x = i * 0.37, y = j * 0.29, u = field_random_unit(r);
    switch (shape) {
    case 0: return 2.0 * sin(x) + 1.5 * cos(1.3 * y) + sin(0.4 * x * y);
    case 1: return 4.0 * u;
    case 2: return floor(3.0 * u) - 1.0;
    case 3: return u < 0.03 ? 2000.0 : 0.0;
    case 4: return u < 0.08 ? (double)NAN : 3.0 * field_random_unit(r);
    case 5: return 1e6 + 4.0 * u;
    case 6: return 4e-30 * u;
    case 7: return 4e30 * u;
    case 8: return 7.0;
    case 9: return (i + j) % 2 ? 100.0 : -100.0;
    default: return 1000.0 + 500.0 * sin(x) * sin(y) + 200.0 * u;
    }
}

void heights_lab_make(heights_terrain *t, int shape, long n, uint64_t seed) {
    field_random r = {seed};
    const double sizes[3] = {1.0, 0.25, 90.0};
    const double size = sizes[field_random_below(&r, 3)];
    *t = (heights_terrain){.type = shapes[shape].type, .holes = shape == 4};
    heights_truth *h = &t->truth;
    h->nx = 2 + (int)field_random_below(&r, n);
    h->ny = 2 + (int)field_random_below(&r, n);
    h->scale = shapes[shape].scale * size;
    for (int a = 0; a < 2; a++) {
        h->spacing[a] = size * (a && field_random_unit(&r) < 0.3 ? -1.0 : 1.0);
        h->origin[a] = size * shapes[shape].place;
    }
    t->heights = malloc((size_t)h->nx * (size_t)h->ny * sizeof *t->heights);
    assert_non_null(t->heights);
    for (int j = 0; j < h->ny; j++)
        for (int i = 0; i < h->nx; i++) {
            const double z = height(shape, i, j, &r);
            t->heights[i + h->nx * j] =
                (float)(strcmp(t->type, "f32") == 0 || !isfinite(z) ? z : floor(z));
        }
    h->heights = t->heights;
}

void heights_lab_release(heights_terrain *t) {
    free(t->heights);
}

static const char *nrrd_of(const heights_terrain *t) {
    const heights_truth *h = &t->truth;
    const field f = {.name = "terrain",
                     .type = t->type,
                     .dims = {h->nx, h->ny, 1},
                     .samples = t->heights,
                     .spacing = {h->spacing[0], h->spacing[1], 1.0},
                     .origin = {h->origin[0], h->origin[1], 0.0}};
    const char *path = scratch_path("terrain.nrrd");
    assert_true(field_write_nrrd(&f, path));
    return path;
}

const char *heights_lab_leaf(const heights_terrain *t, uint32_t cells_log2, uint32_t halo,
                             bool compressed) {
    const volume_hints hints = {.heights = true, .spacing = {0.0, 0.0, t->truth.scale}};
    const char *path = scratch_path("terrain.leaf");
    mem m;
    const char *from = nrrd_of(t);
    const grid_series series = {
        .of = {.paths = &from, .sets = {.fields = 1, .steps = 1, .names = &t->field}},
        .hints = hints};
    convert_options o = {.file = leaf_parameters_default(),
                         .memory = 1 << 30,
                         .threads = 2,
                         .force = true,
                         .series = t->field ? &series : NULL};
    convert_plan plan;
    convert_result result;
    volume *v = NULL;
    o.file.cells_log2 = cells_log2;
    o.file.halo = halo;
    o.file.deviations = true;
    if (compressed)
        leaf_parameters_compress(&o.file, 1);
    mem_init(&m, (size_t)o.memory);
    if (volume_open(&m, from, &hints, &v) != ST_OK ||
        convert_plan_make(&m, volume_grid(v), &o, &plan) != ST_OK ||
        convert_run(&m, v, path, &o, &plan, NULL, &result) != ST_OK)
        fail_msg("%s", status_text());
    volume_close(v);
    return path;
}

/* ---- Rays ---- */

/* The least and the greatest height; 0 and 1 where there is none. */
static void range_of(const heights_terrain *t, double range[2]) {
    const heights_truth *h = &t->truth;
    range[0] = (double)INFINITY;
    range[1] = -(double)INFINITY;
    for (int k = 0; k < h->nx * h->ny; k++)
        if (isfinite(t->heights[k])) {
            range[0] = fmin(range[0], (double)t->heights[k]);
            range[1] = fmax(range[1], (double)t->heights[k]);
        }
    if (!(range[0] <= range[1])) {
        range[0] = 0.0;
        range[1] = 1.0;
    }
}

/* A place in node coordinates. exact: on whole or half nodes. */
static void place(const heights_truth *h, bool exact, field_random *r, double at[2]) {
    const int dims[2] = {h->nx - 1, h->ny - 1};
    for (int a = 0; a < 2; a++)
        at[a] = exact ? (double)field_random_below(r, 2 * dims[a] + 1) * 0.5
                      : dims[a] * field_random_unit(r);
}

static void to_world(const heights_truth *h, const double at[2], double z, double world[3]) {
    for (int a = 0; a < 2; a++)
        world[a] = h->origin[a] + h->spacing[a] * at[a];
    world[2] = z * h->scale;
}

leafcast_ray heights_lab_ray(const heights_terrain *t, int sort, field_random *r, bool *through) {
    const heights_truth *h = &t->truth;
    const bool exact = sort >= 4;
    const double cell = fabs(h->spacing[0]), one = cell / h->scale; /* a cell, as a height */
    double range[2], from[2], to[2], length = 0.0, ends[2][3];
    leafcast_ray ray = {.t1 = (double)INFINITY};
    range_of(t, range);
    const double above = range[1] + one * (0.1 + field_random_unit(r));
    const double below = range[0] - one * (0.1 + field_random_unit(r));
    double z[2] = {above, below};
    place(h, exact, r, from);
    place(h, exact, r, to);
    *through = true;
    switch (sort & 3) {
    case 0: break;
    case 1: /* down, but for rounding or exactly */
        for (int a = 0; a < 2; a++)
            to[a] = from[a];
        break;
    case 2: /* nearly or exactly along the ground, from beyond */
        *through = false;
        z[0] = range[0] + (range[1] - range[0]) * field_random_unit(r);
        z[1] = exact ? z[0] : z[0] + 0.01 * one * field_random_in(r, -1.0, 1.0);
        if (exact)
            to[field_random_below(r, 2)] = from[0] = floor(from[0]);
        if (exact)
            to[0] = from[0];
        break;
    default: /* from anywhere */
        *through = false;
        for (int a = 0; a < 2; a++)
            from[a] += (a ? h->ny : h->nx) * field_random_in(r, -0.7, 0.7);
        z[0] = range[0] + (above - range[0]) * field_random_in(r, -0.5, 1.5);
        break;
    }
    to_world(h, from, z[0], ends[0]);
    to_world(h, to, z[1], ends[1]);
    for (int a = 0; a < 3; a++) {
        ray.origin[a] = ends[0][a];
        ray.direction[a] = ends[1][a] - ends[0][a];
        length += ray.direction[a] * ray.direction[a];
    }
    if (!(length > 0.0)) {
        ray.direction[2] = -1.0;
        length = 1.0;
    }
    length = sqrt(length);
    for (int a = 0; a < 3; a++)
        ray.direction[a] /= length;
    /* A ray that ends on the border may leave there by rounding. */
    for (int a = 0; a < 2; a++)
        for (int e = 0; e < 2; e++) {
            const double at = e ? to[a] : from[a];
            *through = *through && !t->holes && at > 0.0 && at < (a ? h->ny : h->nx) - 1.0;
        }
    return ray;
}

/* ---- Judgement ---- */

static double cell_of(const heights_truth *h) {
    return fmin(fabs(h->spacing[0]), fabs(h->spacing[1]));
}

/* Two cells may both tell of a meeting on their common edge. */
static int settle(const heights_truth *h, heights_meeting *m, int count) {
    const long double near = 1e-9L * (long double)cell_of(h);
    int kept = 0;
    for (int i = 0; i < count; i++)
        if (kept == 0 || m[i].entering != m[kept - 1].entering || m[i].t - m[kept - 1].t > near)
            m[kept++] = m[i];
    return kept;
}

/* Whether the answer changes when the ray is moved by 1e-6 of a cell, to any of its sides, or to
 * and fro: it may begin on the terrain. most: how many meetings matter. */
static bool grazes(const heights_truth *h, const leafcast_ray *r, const heights_meeting *truth,
                   int count, int most) {
    static heights_meeting moved[HEIGHTS_MEETINGS_MAX];
    const double cell = cell_of(h);
    for (int k = 0; k < 8; k++) {
        const double by = (k % 2 ? -1e-6 : 1e-6) * cell;
        double shift[3] = {0.0, 0.0, 0.0};
        for (int a = 0; a < 3; a++)
            shift[a] = k / 2 == a ? by : k / 2 == 3 ? by * r->direction[a] : 0.0;
        const int others =
            settle(h, moved,
                   heights_truth_meetings(h, r->origin, r->direction, shift, (long double)r->t0,
                                          (long double)r->t1, moved));
        if ((most == INT32_MAX || count == 0 || others == 0) && others != count)
            return true;
        for (int i = 0; i < count && i < most; i++)
            if (i >= others || fabsl(moved[i].t - truth[i].t) > 1e-4L * (long double)cell ||
                moved[i].entering != truth[i].entering)
                return true;
    }
    return false;
}

static int truth_of(const heights_truth *h, const leafcast_ray *r, heights_meeting *out) {
    const double still[3] = {0.0, 0.0, 0.0};
    return settle(h, out,
                  heights_truth_meetings(h, r->origin, r->direction, still, (long double)r->t0,
                                         (long double)r->t1, out));
}

static bool judge_hit(const heights_truth *h, const heights_meeting *truth, double t, bool entering,
                      heights_tally *tally) {
    const double off = fabs((double)((long double)t - truth->t)) / cell_of(h);
    tally->worst = fmax(tally->worst, off);
    tally->hits++;
    const bool wrong_t = !(off <= 1e-4 + fabs((double)truth->t) * 0x1p-52 / cell_of(h));
    tally->wrong_t += wrong_t;
    tally->wrong_side += entering != truth->entering;
    return !wrong_t && entering == truth->entering;
}

bool heights_lab_judge(const heights_terrain *t, leafcast *v, const leafcast_ray *r, bool through,
                       heights_tally *tally) {
    static heights_meeting truth[HEIGHTS_MEETINGS_MAX];
    static leafcast_hit hits[HEIGHTS_MEETINGS_MAX];
    const leafcast_scene scene = leafcast_scene_default();
    int found = 0;
    bool right = true;
    if (leafcast_probe_ray(v, &scene, r->origin, r->direction, hits, HEIGHTS_MEETINGS_MAX,
                           &found) != LEAFCAST_OK)
        fail_msg("%s", leafcast_error_text());
    tally->rays++;
    bool order = true;
    for (int i = 1; i < found; i++)
        order = order && hits[i].t >= hits[i - 1].t &&
                (t->holes || hits[i].entering != hits[i - 1].entering);
    tally->wrong_order += !order;
    const bool leaks = through && (found % 2 == 0 || !hits[0].entering);
    tally->leaks += leaks;
    right = order && !leaks;
    const int count = truth_of(&t->truth, r, truth);
    if (grazes(&t->truth, r, truth, count, INT32_MAX)) {
        tally->grazing++;
        return right;
    }
    tally->missed += found < count;
    tally->false_hits += found > count;
    right = right && found == count;
    for (int i = 0; i < count && i < found; i++)
        right = judge_hit(&t->truth, &truth[i], hits[i].t, hits[i].entering, tally) && right;
    return right;
}

bool heights_lab_judge_first(const heights_terrain *t, const leafcast_ray *r,
                             const leafcast_ray_hit *hit, heights_tally *tally) {
    static heights_meeting truth[HEIGHTS_MEETINGS_MAX];
    const int count = truth_of(&t->truth, r, truth);
    const bool found = hit->t < (double)INFINITY;
    tally->rays++;
    if (grazes(&t->truth, r, truth, count, 1)) {
        tally->grazing++;
        return true;
    }
    tally->missed += count > 0 && !found;
    tally->false_hits += count == 0 && found;
    if ((count > 0) != found)
        return false;
    return !found || judge_hit(&t->truth, &truth[0], hit->t, hit->entering, tally);
}

uint64_t heights_lab_faults(const heights_tally *t) {
    return t->missed + t->false_hits + t->wrong_t + t->wrong_side + t->wrong_order + t->leaks;
}
