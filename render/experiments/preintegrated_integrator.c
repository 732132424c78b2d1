#include "render/experiments/preintegrated_integrator.h"

#include "formats/base/portable_math.h"

typedef struct preintegrated_ray {
    stepping_ray way;
    bool running;          /* in a run of pieces without a gap, from: */
    double front_t, front; /* the last step's end, or the run's start, and the value there */
    double end_t, end;     /* end of the last piece, and the value there */
} preintegrated_ray;

static preintegrated_ray *preintegrated_ray_of(ray_record *r) {
    return (preintegrated_ray *)r;
}

static const preintegrated_look *look_of(const frame *f) {
    return f->look;
}

static void preintegrated_begin(const frame *f, uint32_t pixel, ray_record *r) {
    stepping_ray_begin(f, pixel, r);
    preintegrated_ray_of(r)->running = false;
}

/* Join part of a step, from the front to t. */
static void join_part(const preintegrated_look *look, preintegrated_ray *p, double t,
                      double value) {
    const preintegrated_table *table = &look->table;
    const double share = (t - p->front_t) / table->step;
    const preintegrated_entry e = preintegrated_look_up(table, preintegrated_place(table, p->front),
                                                        preintegrated_place(table, value));
    const double whole = (double)e[3],
                 through = whole > 0.0 ? portable_exp(portable_log(whole) * share) : 0.0,
                 dim = whole < 1.0 ? (1.0 - through) / (1.0 - whole) : share;
    const double rgb[3] = {dim * (double)e[0], dim * (double)e[1], dim * (double)e[2]};
    if (share > 0.0)
        (void)stepping_ray_join(&look->steps, &p->way, rgb, through);
    p->front_t = t;
    p->front = value;
}

/* Begin a run, behind a gap or at the start. */
static void begin_run(const preintegrated_look *look, preintegrated_ray *p, double t,
                      double value) {
    if (p->running)
        join_part(look, p, p->end_t, p->end);
    p->running = true;
    p->front_t = t;
    p->front = value;
}

/* A piece's polynomial by powers of s; missing powers are 0. */
static void powers_of(const segment_columns *c, unsigned i, double power[4]) {
    const double b0 = c->b[0][i], b1 = c->b[1][i];
    const bool cubic = c->degree == 3;
    const double b2 = cubic ? c->b[2][i] : 0.0, b3 = cubic ? c->b[3][i] : 0.0;
    power[0] = b0;
    power[1] = cubic ? 3.0 * (b1 - b0) : b1 - b0;
    power[2] = cubic ? 3.0 * ((b2 - b1) - (b1 - b0)) : 0.0;
    power[3] = cubic ? (b3 - b0) - 3.0 * (b2 - b1) : 0.0;
}

/* Join the steps that end in piece i. Returns whether nothing behind it counts. */
static bool take_piece(const preintegrated_look *look, preintegrated_ray *p,
                       const segment_columns *c, unsigned i) {
    const preintegrated_table *table = &look->table;
    const double step = table->step, from = p->way.from, t0 = c->t0[i], t1 = c->t1[i];
    const double shrink = 1.0 / (t1 - t0);
    double power[4];
    if (!p->running || p->end_t != t0)
        begin_run(look, p, t0, c->b[0][i]);
    p->end_t = t1;
    p->end = c->b[c->degree][i];
    double n = t0 > from ? (double)(int64_t)((t0 - from) / step) : 0.0;
    for (; from + n * step <= t0; n += 1.0)
        continue;
    if (from + n * step > t1)
        return false;
    powers_of(c, i, power);
    preintegrated_entry seen = {0.0f, 0.0f, 0.0f, 0.0f};
    float through = 1.0f, front = preintegrated_place(table, p->front);
    for (double t = from + n * step; t <= t1; n += 1.0, t = from + n * step) {
        const double s = (t - t0) * shrink;
        const double value = power[0] + s * (power[1] + s * (power[2] + s * power[3]));
        const float back = preintegrated_place(table, value);
        if (t - p->front_t < 0.999999 * step) {
            join_part(look, p, t, value); /* the first of the run */
        } else {
            const preintegrated_entry e = preintegrated_look_up(table, front, back);
            seen += through * e;
            through *= e[3];
            p->front_t = t;
            p->front = value;
        }
        front = back;
    }
    const double rgb[3] = {(double)seen[0], (double)seen[1], (double)seen[2]};
    return stepping_ray_join(&look->steps, &p->way, rgb, (double)through);
}

static void preintegrated_take(const frame *f, ray_record *const r[], const segment_columns *c,
                               bool stop[], void *scratch) {
    const preintegrated_look *look = look_of(f);
    (void)scratch;
    for (unsigned i = 0; i < c->count; i++)
        if (!stop[c->ray[i]])
            stop[c->ray[i]] = take_piece(look, preintegrated_ray_of(r[c->ray[i]]), c, i);
}

static bool preintegrated_ask(const frame *f, ray_record *r, ray_question *q,
                              ray_counters *counters) {
    preintegrated_ray *p = preintegrated_ray_of(r);
    if (stepping_ray_ask(f, &p->way, q))
        return true;
    if (p->running)
        join_part(look_of(f), p, p->end_t, p->end);
    stepping_ray_write(f, &p->way, counters);
    return false;
}

const integrator preintegrated_integrator = {.record_bytes = sizeof(preintegrated_ray),
                                             .begin = preintegrated_begin,
                                             .ask = preintegrated_ask,
                                             .answer = stepping_ray_answer,
                                             .take = preintegrated_take,
                                             .bundle = stepping_ray_bundle};
