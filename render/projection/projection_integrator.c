#include "render/projection/projection_integrator.h"

#include <math.h>
#include <string.h>

#include "render/ray/cubic.h"
#include "render/ray/kind.h"

typedef struct projected_ray {
    ray_record head; /* volume: being asked now */
    bool begun;      /* its search has begun */
    bool provisional;
    double value, t; /* of the first place that reaches the threshold; none: NaN, INFINITY */
    double integral, length; /* for the mean */
    extreme_state extreme;
    segments_state walk;
    segment kept[SEGMENTS_KEPT];
} projected_ray;

static projected_ray *projected_ray_of(ray_record *r) {
    return (projected_ray *)r;
}

static const projection_look *look_of(const frame *f) {
    return f->look;
}

static bool is_extreme(const frame *f) {
    const leafcast_project p = look_of(f)->project;
    return p == LEAFCAST_PROJECT_MAX || p == LEAFCAST_PROJECT_MIN;
}

static void projection_begin(const frame *f, uint32_t pixel, ray_record *r) {
    projected_ray *p = projected_ray_of(r);
    p->head = (ray_record){.pixel = pixel};
    p->begun = p->provisional = false;
    p->value = (double)NAN;
    p->t = (double)INFINITY;
    p->integral = p->length = 0.0;
    p->extreme = extreme_begin(look_of(f)->project == LEAFCAST_PROJECT_MIN);
}

/* ---- Pieces ---- */

/* Integrals and lengths of all pieces, column by column. */
static void integrate(const segment_columns *c, double *restrict integral,
                      double *restrict length) {
    const double(*b)[SEGMENT_COLUMNS] = c->b;
    for (unsigned i = 0; i < c->count; i++)
        length[i] = c->t1[i] - c->t0[i];
    if (c->degree == 3)
        for (unsigned i = 0; i < c->count; i++)
            integral[i] = 0.25 * (b[0][i] + b[1][i] + b[2][i] + b[3][i]) * length[i];
    else
        for (unsigned i = 0; i < c->count; i++)
            integral[i] = 0.5 * (b[0][i] + b[1][i]) * length[i];
}

static void take_mean(ray_record *const r[], const segment_columns *c) {
    _Alignas(64) double integral[SEGMENT_COLUMNS], length[SEGMENT_COLUMNS];
    integrate(c, integral, length);
    for (unsigned i = 0; i < c->count; i++) {
        projected_ray *p = projected_ray_of(r[c->ray[i]]);
        p->integral += integral[i];
        p->length += length[i];
    }
}

/* Bisect for the place where the value reaches the threshold, between `below`, where it does not,
 * and `at`, where it does. The piece's values count from the threshold. */
static double reach(const segment *piece, double below, double at) {
    for (double middle = 0.5 * (below + at); middle > below && middle < at;
         middle = 0.5 * (below + at)) {
        if (segment_at(piece, middle) >= 0.0)
            at = middle;
        else
            below = middle;
    }
    return at;
}

/* Find the first place of a piece that reaches the threshold; its start does not. Returns false if
 * none does. */
static bool find_first(const segment *piece, double *t) {
    double turn[3];
    int turns = piece->degree == 3 ? cubic_extrema(piece->b, turn) : 0;
    double below = 0.0;
    turn[turns++] = 1.0;
    for (int i = 0; i < turns; below = turn[i++]) {
        if (segment_at(piece, turn[i]) >= 0.0) {
            *t = segment_t(piece, reach(piece, below, turn[i]));
            return true;
        }
    }
    return false;
}

/* Take a piece, and keep its first place at the threshold if that comes before the place found so
 * far. Returns whether later pieces are still needed. */
static bool pass_first(projected_ray *p, const segment *piece, double v) {
    double t = piece->t0;
    const bool at_once = piece->b[0] >= 0.0;
    if (t >= p->t)
        return false;
    if (!at_once && !find_first(piece, &t))
        return true;
    if (t < p->t) {
        p->t = t;
        p->value = at_once ? v + piece->b[0] : v;
    }
    return false;
}

/* Piece i of the columns. */
static segment piece_of(const segment_columns *c, unsigned i) {
    segment piece = {.t0 = c->t0[i], .t1 = c->t1[i], .degree = (uint32_t)c->degree};
    for (int k = 0; k <= c->degree; k++)
        piece.b[k] = c->b[k][i];
    return piece;
}

static void take_first(const projection_look *look, ray_record *const r[], const segment_columns *c,
                       bool stop[]) {
    for (unsigned i = 0; i < c->count; i++) {
        const segment piece = piece_of(c, i);
        if (!stop[c->ray[i]])
            stop[c->ray[i]] = !pass_first(projected_ray_of(r[c->ray[i]]), &piece, look->value);
    }
}

static void projection_take(const frame *f, ray_record *const r[], const segment_columns *c,
                            bool stop[], void *scratch) {
    const projection_look *look = look_of(f);
    (void)scratch;
    if (look->project == LEAFCAST_PROJECT_MEAN)
        take_mean(r, c);
    else
        take_first(look, r, c, stop);
}

/* ---- Pixels ---- */

static void colour_of(const projection_look *look, double value, double rgb[3]) {
    const double *range = look->range;
    const double share = range[1] > range[0] ? (value - range[0]) / (range[1] - range[0]) : 0.0;
    if (!look->colour) {
        rgb[0] = rgb[1] = rgb[2] = fmin(fmax(share, 0.0), 1.0);
        return;
    }
    transfer_rgb(look->colour, value, rgb);
}

static void write_colour(const frame *f, size_t at, double value) {
    const leafcast_image *image = &f->image;
    const float *background = look_of(f)->background;
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    double rgba[4] = {0.0, 0.0, 0.0, 1.0};
    if (!isnan(value))
        colour_of(look_of(f), value, rgba);
    else
        for (int c = 0; c < 4; c++)
            rgba[c] = (double)background[3] * (c < 3 ? (double)background[c] : 1.0);
    for (int c = 0; c < 4; c++) {
        if (image->rgba)
            image->rgba[4 * at + (size_t)c] = rgba[c];
        if (planes[c])
            planes[c][at] = (float)rgba[c];
    }
}

/* Conclude the value and t when all volumes have been asked. */
static void conclude(const frame *f, projected_ray *p) {
    if (p->length > 0.0)
        p->value = p->integral / p->length;
    if (is_extreme(f) && extreme_found(&p->extreme)) {
        p->value = extreme_value(&p->extreme);
        p->t = p->extreme.t;
    }
}

/* Not exact where coarse levels were drawn or treelets were absent: the error is then unknown. */
static bool is_exact(const frame *f, const projected_ray *p) {
    return !p->provisional && !f->coarse;
}

static void write(const frame *f, const projected_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const size_t at = frame_plane(f, p->head.pixel);
    write_colour(f, at, p->value);
    if (image->value)
        image->value[at] = p->value;
    if (image->error)
        image->error[at] = is_exact(f, p) ? 0.0 : (double)INFINITY;
    if (image->z)
        image->z[at] = p->t;
    if (image->id)
        image->id[at] = -1;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][at] = 0.0f;
    if (image->provisional)
        image->provisional[at] = p->provisional;
    counters->covered_pixels += !isnan(p->value);
    counters->provisional_pixels += p->provisional;
}

/* ---- The machine ---- */

/* Begin to search a volume. */
static void begin_volume(projected_ray *p, const tracer *tr) {
    p->walk = segments_begin(p->kept, SEGMENTS_KEPT);
    extreme_go_on(&p->extreme, tr);
    p->begun = true;
}

static bool projection_ask(const frame *f, ray_record *record, ray_question *q,
                           ray_counters *counters) {
    projected_ray *p = projected_ray_of(record);
    double origin[3], direction[3];
    if (p->head.volume < f->volumes)
        camera_ray(&f->camera, p->head.pixel % f->width + 0.5, p->head.pixel / f->width + 0.5,
                   origin, direction);
    for (;; p->head.volume++) {
        if (p->head.volume < f->volumes)
            p->head.volume =
                (uint16_t)frame_object(f, origin, direction, 0.0, (double)INFINITY, p->head.volume);
        if (p->head.volume >= f->volumes)
            break;
        q->tracer = &f->tracer[p->head.volume];
        if (!tracer_ray(q->tracer, origin, direction, 0.0, (double)INFINITY, &q->ray))
            continue;
        if (!p->begun)
            begin_volume(p, q->tracer);
        p->walk.ahead = p->kept; /* records are copied */
        q->state = NULL;
        q->walk = is_extreme(f) ? NULL : &p->walk;
        q->kept = p->kept;
        q->extreme = &p->extreme;
        return true;
    }
    conclude(f, p);
    write(f, p, counters);
    return false;
}

static void projection_answer(const frame *f, ray_record *record, trace_result result) {
    projected_ray *p = projected_ray_of(record);
    (void)result;
    p->provisional |= is_extreme(f) ? p->extreme.provisional : p->walk.provisional;
    p->begun = false;
    p->head.volume++;
}

static ray_bundle projection_bundle(const frame *f, uint32_t leg) {
    (void)leg;
    return camera_bundle(&f->camera);
}

const integrator projection_integrator = {.record_bytes = sizeof(projected_ray),
                                          .begin = projection_begin,
                                          .ask = projection_ask,
                                          .answer = projection_answer,
                                          .take = projection_take,
                                          .bundle = projection_bundle};
