#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"
#include "render/door/arguments.h"
#include "render/door/between_steps.h"
#include "render/door/leafcast_device.h"
#include "render/door/leafcast_volume.h"
#include "render/door/point_samples.h"
#include "render/ray/kind.h"

/* ---- The caller's points ---- */

typedef struct point_list {
    const double (*points)[3];
    leafcast_sample *samples;
} point_list;

static void listed_point(const void *ctx, size_t i, double point[3]) {
    const point_list *list = ctx;
    memcpy(point, list->points[i], sizeof list->points[i]);
}

static void listed_found(void *ctx, size_t i, const double point[3], const leafcast_sample *s) {
    const point_list *list = ctx;
    (void)point;
    list->samples[i] = *s;
}

/* Sample in the selected field and step. */
static leafcast_status sample(point_samples *p, leafcast_stats *stats) {
    leafcast *v = p->volume;
    live_hold h;
    volume_lock(v, &h);
    status st = between_steps_open(&p->volume, v->share);
    if (st == ST_OK) {
        p->set = between_steps_set(p->volume, v->field, v->step, v->share);
        st = volume_check_file(v, point_samples_run(p, stats));
    }
    volume_unlock(v, &h);
    return public_status(st);
}

leafcast_status leafcast_sample_points(leafcast *v, const double (*points)[3], size_t count,
                                       leafcast_sample *samples) {
    point_list list = {points, samples};
    status st = arguments_check_points(__func__, v);
    if (st == ST_OK && count > 0)
        st = public_needs(__func__, "points samples", (const void *[]){points, samples});
    if (st == ST_OK)
        st = public_in_range(__func__, "count", (double)count, 0,
                             (double)(SIZE_MAX / sizeof *samples));
    if (st != ST_OK)
        return public_status(st);
    point_samples p = {
        .volume = v, .count = count, .point = listed_point, .found = listed_found, .ctx = &list};
    return sample(&p, NULL);
}

/* ---- Pixels of a slice ---- */

/* Take pixels column by column in bands of BAND rows: successive points then share treelets and
 * cache lines. */
enum { BAND = 32 };

typedef struct slice_job {
    const leafcast_slice_pixels *slice;
    bool nearest; /* else linear */
    double *value;
    double *along; /* the line's length up to each of its points */
} slice_job;

static uint32_t rows_of(const leafcast_slice_pixels *s) {
    return s->rows > 0 ? s->rows : s->height;
}

/* Map point number i to its pixel. y counts from first_row on. */
static void pixel_of(const leafcast_slice_pixels *s, size_t i, uint32_t *x, uint32_t *y) {
    const size_t band = i / ((size_t)BAND * s->width), first = band * BAND;
    const size_t rows = rows_of(s) - first < BAND ? rows_of(s) - first : BAND;
    const size_t within = i - first * s->width;
    *x = (uint32_t)(within / rows);
    *y = (uint32_t)(first + within % rows);
}

/* Find the point of the line at a share (0 to 1) of its length. */
static void point_along(const slice_job *p, double share, double point[3]) {
    const leafcast_slice_pixels *s = p->slice;
    const double at = share * p->along[s->line_count - 1];
    uint32_t lo = 0, hi = s->line_count - 1;
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (p->along[middle] <= at)
            lo = middle;
        else
            hi = middle;
    }
    const double within = (at - p->along[lo]) / (p->along[lo + 1] - p->along[lo]);
    for (int a = 0; a < 3; a++)
        point[a] = s->line[lo][a] + within * (s->line[lo + 1][a] - s->line[lo][a]);
}

static void slice_point(const void *ctx, size_t i, double point[3]) {
    const slice_job *p = ctx;
    const leafcast_slice_pixels *s = p->slice;
    uint32_t x, y;
    pixel_of(s, i, &x, &y);
    const double right = (x + 0.5) / s->width, down = (s->first_row + y + 0.5) / s->height;
    if (s->line_count > 0)
        point_along(p, right, point);
    for (int a = 0; a < 3; a++)
        point[a] = (s->line_count > 0 ? point[a] : s->origin[a] + right * s->u[a]) + down * s->v[a];
}

static void slice_found(void *ctx, size_t i, const double point[3], const leafcast_sample *found) {
    const slice_job *p = ctx;
    uint32_t x, y;
    pixel_of(p->slice, i, &x, &y);
    const double value = p->nearest && found->inside ? found->nearest : found->value;
    (void)point;
    p->value[(size_t)y * p->slice->width + x] = isfinite(value) ? value : (double)NAN;
}

/* ---- Checking a slice ---- */

/* Fill along[i] with the line's length up to point i. */
static status measure_line(const leafcast_slice_pixels *s, double *along) {
    along[0] = 0.0;
    for (uint32_t i = 1; i < s->line_count; i++) {
        double step[3];
        vec3_sub(s->line[i], s->line[i - 1], step);
        along[i] = along[i - 1] + vec3_length(step);
    }
    const double length = along[s->line_count - 1];
    if (!(length > 0.0 && length < INFINITY))
        return status_describe(ST_USAGE, "a slice along a line of length %g", length);
    return ST_OK;
}

static status check_slice(const leafcast *v, const leafcast_slice_pixels *s) {
    status st = arguments_check_slice(s);
    return st == ST_OK ? leaf_file_check_level(v->file, s->level) : st;
}

static leafcast_status sample_pixels(slice_job *pixels, point_samples *p, leafcast_stats *stats) {
    const leafcast_slice_pixels *s = pixels->slice;
    const size_t line = s->line_count * sizeof *pixels->along;
    p->count = (size_t)s->width * rows_of(s);
    p->beside = p->count * sizeof *pixels->value + (size_t)s->beside + line;
    if (line == 0)
        return sample(p, stats);
    mem outside; /* counted in `beside` */
    mem_init(&outside, 0);
    pixels->along = mem_alloc(&outside, line);
    status st = pixels->along ? measure_line(s, pixels->along) : ST_NOMEM;
    const leafcast_status told = st == ST_OK ? sample(p, stats) : public_status(st);
    mem_free(&outside, pixels->along);
    return told;
}

leafcast_status leafcast_sample_slice(leafcast *v, const leafcast_slice_pixels *s, double *value,
                                      leafcast_stats *stats, bool (*watch)(void *ctx, double done),
                                      void *watch_ctx) {
    status st = arguments_check_values(__func__, v);
    if (st == ST_OK)
        st = public_needs(__func__, "slice value", (const void *[]){s, value});
    if (st == ST_OK)
        st = check_slice(v, s);
    if (st == ST_OK)
        st = arguments_check_stats(stats);
    if (st != ST_OK)
        return public_status(st);
    const bool nearest = s->interpolation == LEAFCAST_INTERPOLATION_NEAREST;
    slice_job pixels = {.slice = s, .nearest = nearest, .value = value};
    point_samples p = {.volume = v,
                       .level = s->level,
                       .point = slice_point,
                       .found = slice_found,
                       .ctx = &pixels,
                       .watch = watch,
                       .watch_ctx = watch_ctx};
    return sample_pixels(&pixels, &p, stats);
}

/* ---- Slices across the volume ---- */

enum { SIDE_MOST = 1 << 15 };

/* Returns the pixels along an edge of `length` world units, at `density` cells per world unit. */
static uint32_t side_of(const leafcast_slice_pixels *s, double length, double density) {
    const double pixels = ceil(rint(length * density) / (double)(1u << s->level));
    const uint32_t more = s->interpolation == LEAFCAST_INTERPOLATION_NEAREST;
    return pixels >= SIDE_MOST ? SIDE_MOST : pixels < 1.0 ? 1 : (uint32_t)pixels + more;
}

/* An edge of a slice: how long it is, and how many cells it passes. */
typedef struct edge {
    double length, cells;
} edge;

static void lengthen(edge *e, const leafcast *v, const double vector[3]) {
    e->length += vec3_length(vector);
    e->cells += v->kind->walks->cells_along(v, vector);
}

static edge upper_edge(const leafcast *v, const leafcast_slice_pixels *s) {
    edge e = {0};
    if (s->line_count == 0)
        lengthen(&e, v, s->u);
    for (uint32_t i = 1; i < s->line_count; i++) {
        double step[3];
        vec3_sub(s->line[i], s->line[i - 1], step);
        lengthen(&e, v, step);
    }
    return e;
}

static status fit_pixels(const leafcast *v, leafcast_slice_pixels *s) {
    const edge width = upper_edge(v, s);
    edge height = {0};
    lengthen(&height, v, s->v);
    if (!(width.length > 0.0 && width.length < INFINITY && height.length > 0.0 &&
          height.length < INFINITY))
        return status_describe(ST_USAGE, "a slice of %g by %g world units", width.length,
                               height.length);
    const double density = fmax(width.cells / width.length, height.cells / height.length);
    s->width = side_of(s, width.length, density);
    s->height = side_of(s, height.length, density);
    return ST_OK;
}

leafcast_status leafcast_fit_slice(const leafcast *v, leafcast_slice_pixels *s) {
    status st = public_needs(__func__, "volume slice", (const void *[]){v, s});
    if (st == ST_OK)
        st = public_size("leafcast_slice_pixels", s->size, sizeof *s);
    if (st != ST_OK)
        return public_status(st);
    s->width = s->height = 1;
    s->first_row = s->rows = 0;
    st = check_slice(v, s);
    return public_status(st == ST_OK ? fit_pixels(v, s) : st);
}

/* Reset *s, but for interpolation and level. */
static status begin_slice(const char *call, const leafcast *v, leafcast_slice_pixels *s) {
    status st = public_needs(call, "volume slice", (const void *[]){v, s});
    if (st == ST_OK)
        st = public_size("leafcast_slice_pixels", s->size, sizeof *s);
    if (st != ST_OK)
        return st;
    *s = (leafcast_slice_pixels){.size = sizeof *s,
                                 .interpolation = s->interpolation,
                                 .level = s->level,
                                 .width = 1,
                                 .height = 1};
    return check_slice(v, s);
}

/* A rectangle in a plane: two directions, and its extent along them. */
typedef struct rectangle {
    double right[3], up[3];
    double lo[2], hi[2];
} rectangle;

static rectangle rectangle_across(const double normal[3]) {
    rectangle r = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}};
    const bool along_z = fabs(normal[0]) + fabs(normal[1]) < 1e-6;
    const double up[3] = {0.0, along_z, !along_z};
    vec3_cross(up, normal, r.right);
    (void)vec3_unit(r.right, r.right);
    vec3_cross(normal, r.right, r.up);
    return r;
}

static void widen(rectangle *r, const double point[3]) {
    const double at[2] = {vec3_dot(point, r->right), vec3_dot(point, r->up)};
    for (int i = 0; i < 2; i++) {
        r->lo[i] = fmin(r->lo[i], at[i]);
        r->hi[i] = fmax(r->hi[i], at[i]);
    }
}

/* Widen r to hold the point where the plane cuts an edge a b of the volume's box, if it does. */
static void cut_edge(rectangle *r, const double a[3], const double b[3], const double plane[4]) {
    const double from = vec3_dot(plane, a) + plane[3], to = vec3_dot(plane, b) + plane[3];
    if (!(fmin(from, to) <= 0.0 && fmax(from, to) >= 0.0))
        return;
    const double share = from == to ? 0.0 : from / (from - to);
    double point[3];
    for (int i = 0; i < 3; i++)
        point[i] = share == 1.0 ? b[i] : a[i] + share * (b[i] - a[i]);
    widen(r, point);
}

static void cut_box(rectangle *r, const leafcast *v, const double plane[4]) {
    double corners[8][3];
    live_hold h;
    const uint32_t step = volume_hold(v, v->live ? 0 : v->step, &h);
    v->kind->walks->active_box(v, leaf_layout_set(&v->file->layout, v->field, step), NULL, 0,
                               corners);
    volume_let_go(v, &h);
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            if (!(i >> a & 1))
                cut_edge(r, corners[i], corners[i | 1 << a], plane);
}

static status plane_slice(const leafcast *v, const double given[4], leafcast_slice_pixels *s) {
    double plane[4];
    const double length = vec3_length(given);
    if (!(length > 0.0 && length < INFINITY && isfinite(given[3])))
        return status_describe(ST_USAGE, "no plane is %g x + %g y + %g z + %g = 0", given[0],
                               given[1], given[2], given[3]);
    for (int i = 0; i < 4; i++)
        plane[i] = given[i] / length;
    rectangle r = rectangle_across(plane);
    cut_box(&r, v, plane);
    if (!(r.lo[0] < r.hi[0] && r.lo[1] < r.hi[1]))
        return status_describe(ST_USAGE,
                               "the plane %g x + %g y + %g z + %g = 0 does not cut the "
                               "volume",
                               given[0], given[1], given[2], given[3]);
    for (int a = 0; a < 3; a++) {
        s->origin[a] = r.lo[0] * r.right[a] + r.hi[1] * r.up[a] - plane[3] * plane[a];
        s->u[a] = (r.hi[0] - r.lo[0]) * r.right[a];
        s->v[a] = 0.0 - (r.hi[1] - r.lo[1]) * r.up[a]; /* no -0 */
    }
    return fit_pixels(v, s);
}

leafcast_status leafcast_plane_slice(const leafcast *v, const double plane[4],
                                     leafcast_slice_pixels *s) {
    status st = begin_slice(__func__, v, s);
    if (st == ST_OK)
        st = public_needs(__func__, "plane", (const void *[]){plane});
    for (int i = 0; i < 4 && st == ST_OK; i++)
        st = public_in_range(__func__, "the plane", plane[i], -LEAFCAST_PLACE_MOST,
                             LEAFCAST_PLACE_MOST);
    if (st == ST_OK)
        st = plane_slice(v, plane, s);
    return public_status(st);
}

leafcast_status leafcast_layer_slice(const leafcast *v, int axis, uint32_t node,
                                     leafcast_slice_pixels *s) {
    double edges[2][3];
    status st = begin_slice(__func__, v, s);
    if (st == ST_OK && (axis < 0 || axis > 2))
        st = status_describe(ST_USAGE, "axis %d: 0 to 2 are possible", axis);
    if (st == ST_OK && !v->kind->layer)
        st = status_describe(ST_USAGE, "a %s has no planes of nodes", v->kind->name);
    if (st == ST_OK)
        st = v->kind->layer(v, axis, node, s->origin, edges);
    if (st != ST_OK)
        return public_status(st);
    for (int a = 0; a < 3; a++) {
        s->origin[a] += edges[1][a];
        s->u[a] = edges[0][a];
        s->v[a] = 0.0 - edges[1][a];
    }
    return public_status(fit_pixels(v, s));
}
