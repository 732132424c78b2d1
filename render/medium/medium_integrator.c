#include "render/medium/medium_integrator.h"

#include <math.h>
#include <string.h>

#include "render/medium/medium_doubt.h"
#include "render/medium/medium_overlay.h"
#include "render/medium/medium_pixel.h"
#include "render/medium/medium_whole.h"
#include "render/medium/overlay_ray.h"
#include "render/ray/kind.h"
#include "render/surface/shade.h"
#include "render/surface/surface_ray.h"

/* Shares of the pixel's error: for the medium by its opacity, by its length, for the end, for light
 * left out inside a piece, which happens behind at most 64 spans or halvings and counts twice. */
static const double by_opacity = 0.5, by_length = 0.3, at_end = 0.1, in_piece = 0.04 / 128.0;

/* And beside a cut of overlaid media. */
static const double at_cut = 0x1p-18;

/* What a ray does: find the next surface, walk through the medium in front of it, meet it, be lit
 * there. */
typedef enum stage { FINDING, WALKING, MEETING, LIGHTING } stage;

typedef struct medium_ray {
    surface_ray way;
    stage stage;
    bool begun;     /* the walk has begun */
    bool doubted;   /* preview: it has come to a doubt */
    bool unbounded; /* preview: absent data may be anything */
    bool coarse;    /* it meets a volume that is drawn coarser than its data */
    double reached; /* t so far, through several media */
    medium_rule rule;
    uint32_t treelet; /* of the last piece */
    double from;      /* everything before this t is in `front` */
    medium_stretch front;
    medium_stretch run; /* behind front: pieces in one treelet */
    segments_state walk;
    segment kept[SEGMENTS_KEPT];
    overlay_lane lanes[]; /* of the filled volumes, if overlaid; or a doubt */
} medium_ray;

/* The doubt behind the run, in a preview of one filled volume, once `doubted`. */
static medium_doubt *doubt_of(medium_ray *p) {
    return (medium_doubt *)(void *)p->lanes;
}

/* Scratch of medium_take(). */
enum { DOUBTFUL = 64 };
typedef struct take_scratch {
    medium_batch batch;
    /* A cache: the last treelet with each number modulo DOUBTFUL. */
    uint32_t treelet[DOUBTFUL];
    medium_doubtful doubtful[DOUBTFUL];
} take_scratch;

static medium_ray *medium_ray_of(ray_record *r) {
    return (medium_ray *)r;
}

static const medium_look *look_of(const frame *f) {
    return f->look;
}

/* ---- The medium ---- */

/* The first filled volume from v on. */
static int filled_from(const frame *f, int v) {
    while (v < f->volumes && look_of(f)->media[v].spans == 0)
        v++;
    return v;
}

static bool overlaid(const frame *f) {
    return look_of(f)->overlaid;
}

/* The rule for pieces in a volume on the whole ray. Widens way[] by the ray's way through it. */
static medium_rule rule_of(const frame *f, uint32_t pixel, int v, double way[2]) {
    const medium_look *look = look_of(f);
    const tracer *tr = &f->tracer[v];
    const world_ray w = surface_ray_primary(f, pixel);
    medium_rule rule = {.transfer = &look->media[v],
                        .share = by_opacity * look->error,
                        .drop = in_piece * look->error};
    ray r;
    double t_in = w.t0, t_out = w.t1;
    if (!tracer_ray(tr, w.origin, w.direction, w.t0, w.t1, &r) ||
        !tracer_box(tr, &r, &t_in, &t_out))
        return rule;
    way[0] = fmin(way[0], t_in);
    way[1] = fmax(way[1], t_out);
    rule.error = segments_error_of(tr, &r, look->range[v]);
    return rule;
}

/* Whether the ray meets a volume that is drawn at a coarse level. */
static bool meets_coarse(const frame *f, uint32_t pixel) {
    for (int v = 0; v < f->volumes; v++) {
        const tracer *tr = &f->tracer[v];
        if (!tr->coarse)
            continue;
        const world_ray w = surface_ray_primary(f, pixel);
        ray r;
        double t_in = w.t0, t_out = w.t1;
        if (tracer_ray(tr, w.origin, w.direction, w.t0, w.t1, &r) &&
            tracer_box(tr, &r, &t_in, &t_out))
            return true;
    }
    return false;
}

/* The allowed error per length. */
static double per_length_of(const frame *f, const double way[2]) {
    return by_length * look_of(f)->error / fmax(way[1] - way[0], 1e-300);
}

static void medium_begin(const frame *f, uint32_t pixel, ray_record *r) {
    medium_ray *p = medium_ray_of(r);
    double way[2] = {INFINITY, 0.0};
    surface_ray_begin(pixel, &p->way);
    p->stage = FINDING;
    p->begun = p->doubted = false;
    p->unbounded = look_of(f)->unbounded;
    p->coarse = meets_coarse(f, pixel);
    p->from = 0.0;
    p->rule = rule_of(f, pixel, filled_from(f, 0), way);
    for (int i = 0, v = filled_from(f, 0); i < look_of(f)->filled && overlaid(f); i++) {
        p->lanes[i].volume = (uint16_t)v;
        p->lanes[i].error = rule_of(f, pixel, v, way).error;
        v = filled_from(f, v + 1);
    }
    p->rule.per_length = way[1] >= way[0] ? per_length_of(f, way) : 0.0;
    p->front = p->run = medium_nothing();
}

static void join(const frame *f, const medium_ray *p, medium_stretch *front,
                 const medium_stretch *behind) {
    if (p->doubted)
        medium_doubt_join(front, behind, look_of(f)->brightest);
    else
        medium_join(front, behind, look_of(f)->brightest);
}

static void end_run(const frame *f, medium_ray *p) {
    medium_pixel_limit(&p->run, look_of(f)->brightest);
    join(f, p, &p->front, &p->run);
    medium_pixel_limit(&p->front, look_of(f)->brightest);
    p->run = medium_nothing();
}

/* Whether nothing behind counts any more; leaving it out adds to the error. */
static bool is_dark(const frame *f, medium_ray *p) {
    const double through = p->front.through * p->run.through;
    return through * look_of(f)->brightest <= at_end * look_of(f)->error;
}

/* Leave out what is behind. */
static void leave_out_rest(const frame *f, medium_ray *p) {
    end_run(f, p);
    p->front.rgb_error += (p->front.through + p->front.through_error) * look_of(f)->brightest;
    p->front.through_error += p->front.through;
    p->front.through = 0.0;
}

/* Set each piece's rule. Pieces of one ray mostly follow each other. */
static void set_rules(const medium_look *look, ray_record *const r[], const segment_columns *c,
                      medium_batch *m) {
    m->share = by_opacity * look->error;
    m->drop = in_piece * look->error;
    for (unsigned i = 0; i < c->count;) {
        const unsigned number = c->ray[i];
        const medium_rule *rule = &medium_ray_of(r[number])->rule;
        const double per_length = rule->per_length, t = rule->error.t, value = rule->error.value;
        for (; i < c->count && c->ray[i] == number; i++) {
            m->per_length[i] = per_length;
            m->t_error[i] = t;
            m->value_error[i] = value;
        }
    }
}

static medium_stretch stretch_of(const medium_batch *m, unsigned i) {
    return (medium_stretch){{m->rgb[0][i], m->rgb[1][i], m->rgb[2][i]},
                            m->through[i],
                            m->rgb_error[i],
                            m->through_error[i]};
}

/* Join what is in doubt before t behind what has been seen. */
static void settle(const frame *f, medium_ray *p, double t) {
    medium_stretch seen;
    if (p->doubted && medium_doubt_take(doubt_of(p), &p->rule, t, &seen))
        join(f, p, &p->run, &seen);
}

static const medium_doubtful *doubtful_of(const frame *f, take_scratch *s, uint32_t t) {
    const int v = filled_from(f, 0);
    const unsigned i = t % DOUBTFUL;
    if (s->treelet[i] != t)
        s->doubtful[i] = medium_doubtful_of(&look_of(f)->media[v], &f->tracer[v], t);
    s->treelet[i] = t;
    return &s->doubtful[i];
}

static segment piece_of(const segment_columns *c, unsigned i) {
    segment piece = {.t0 = c->t0[i],
                     .t1 = c->t1[i],
                     .spread = c->spread[i],
                     .treelet = c->treelet[i],
                     .degree = (uint32_t)c->degree};
    for (int k = 0; k <= c->degree; k++)
        piece.b[k] = c->b[k][i];
    return piece;
}

/* Take piece i in a preview. Returns true if it is a doubt or a guess, or comes too late. */
static bool take_doubt(const frame *f, medium_ray *p, take_scratch *s, const segment_columns *c,
                       unsigned i, bool *stop) {
    const medium_batch *m = &s->batch;
    settle(f, p, c->t0[i]);
    *stop = *stop || is_dark(f, p);
    if (*stop)
        return true;
    if (c->spread[i] < 0.0) {
        const segment is = {
            .t0 = c->t0[i], .t1 = c->t1[i], .spread = c->spread[i], .treelet = c->treelet[i]};
        if (!p->doubted)
            *doubt_of(p) = (medium_doubt){0};
        p->doubted = true;
        medium_doubt_begin(doubt_of(p), &is, doubtful_of(f, s, c->treelet[i]));
        return true;
    }
    const bool bounded = p->doubted && medium_doubt_bounds(doubt_of(p), c->t0[i]);
    if (c->spread[i] >= SEGMENT_EXACT && !bounded)
        medium_batch_whole(&s->batch, c, i);
    if (!p->doubted)
        return false;
    medium_stretch seen = m->seen[i] ? stretch_of(m, i) : medium_nothing();
    if (bounded) {
        const segment piece = piece_of(c, i);
        medium_doubt_near(doubt_of(p), &p->rule, &piece, &seen);
        join(f, p, &p->run, &seen);
        return true;
    }
    return medium_doubt_guess(doubt_of(p), c->t1[i], &seen);
}

/* The ray's way from p->from to the surface. */
static world_ray way_of(const frame *f, const medium_ray *p) {
    world_ray w = surface_ray_primary(f, p->way.head.pixel);
    w.t0 = p->from;
    w.t1 = p->way.search.found.t;
    return w;
}

/* ---- Shaded ---- */

/* A piece to be shaded; not shaded if its treelet is absent, in a preview. */
static shaded_piece lit_piece(const frame *f, int v, const treelet *at, const ray *r,
                              const segment *s) {
    const tracer *tr = &f->tracer[v];
    shaded_piece p = {.t0 = s->t0, .t1 = s->t1};
    if (!at || s->spread >= SEGMENT_EXACT)
        return p;
    p.steepness = look_of(f)->shade->steepness[v];
    tr->kind->gradient(tr, at, r, s, &p.gradient);
    return p;
}

static void light_up(medium_stretch *seen, const double light[3]) {
    for (int c = 0; c < 3; c++)
        seen->rgb[c] *= light[c];
}

/* One volume's piece, and what is seen of the whole. */
typedef struct seen_piece {
    const medium_rule *rule;
    const segment *piece;
    medium_stretch whole;
} seen_piece;

static medium_stretch see_part(const void *ctx, double t0, double t1, const double light[][3]) {
    const seen_piece *s = ctx;
    const segment *piece = s->piece;
    medium_stretch seen = s->whole;
    if (t0 != piece->t0 || t1 != piece->t1) {
        const double length = piece->t1 - piece->t0;
        segment part = *piece;
        segment_part(piece, (t0 - piece->t0) / length, (t1 - piece->t0) / length, part.b);
        part.t0 = t0;
        part.t1 = t1;
        seen = medium_of_piece(s->rule, &part);
    }
    light_up(&seen, light[0]);
    return seen;
}

/* The ray of the current piece in a batch; pieces of one ray come together. */
typedef struct lit_ray {
    const medium_ray *of; /* NULL: none yet */
    world_ray in_world;
    ray in_volume;
} lit_ray;

/* Shade what is seen of piece i; *seen is unshaded on entry. */
static void shade_piece(const frame *f, const medium_ray *p, const segment_columns *c, unsigned i,
                        lit_ray *on, medium_stretch *seen) {
    const int v = filled_from(f, 0);
    const tracer *tr = &f->tracer[v];
    const segment piece = piece_of(c, i);
    if (on->of != p) {
        on->of = p;
        on->in_world = way_of(f, p);
        const world_ray *w = &on->in_world;
        (void)tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &on->in_volume);
    }
    const seen_piece all = {&p->rule, &piece, *seen};
    const treelet *at = loader_lookup(tr->treelets, piece.treelet);
    const shaded_stretch s = {.shade = look_of(f)->shade,
                              .ray = &on->in_world,
                              .count = 1,
                              .of = {lit_piece(f, v, at, &on->in_volume, &piece)},
                              .see = see_part,
                              .ctx = &all,
                              .most_rgb = look_of(f)->brightest};
    *seen = medium_shade_stretch(&s, piece.t0, piece.t1, p->front.through * p->run.through);
}

/* ---- Pieces ---- */

/* Join pieces i to `end` - 1, all of one ray in one treelet. on: NULL if not shaded. Returns
 * whether nothing behind counts any more. */
static bool join_pieces(const frame *f, medium_ray *p, const medium_batch *m,
                        const segment_columns *c, unsigned i, unsigned end, lit_ray *on) {
    const double most_rgb = look_of(f)->brightest, least = at_end * look_of(f)->error;
    while (i < end && !m->seen[i])
        i++;
    if (i == end)
        return false;
    if (c->treelet[i] != p->treelet)
        end_run(f, p);
    p->treelet = c->treelet[i];
    const double in_front = p->front.through;
    medium_stretch run = p->run; /* a copy stays in registers */
    bool dark = false;
    for (; i < end && !dark; i++) {
        if (!m->seen[i])
            continue;
        medium_stretch seen = stretch_of(m, i);
        if (on) {
            p->run = run;
            shade_piece(f, p, c, i, on, &seen);
        }
        medium_join(&run, &seen, most_rgb);
        dark = in_front * run.through * most_rgb <= least; /* is_dark() */
    }
    p->run = run;
    return dark;
}

/* Take pieces one by one, in a preview. */
static void take_doubted(const frame *f, ray_record *const r[], const segment_columns *c,
                         bool stop[], take_scratch *s) {
    for (int i = 0; i < DOUBTFUL; i++)
        s->treelet[i] = LEAF_NO_TREELET;
    for (unsigned i = 0; i < c->count; i++) {
        medium_ray *p = medium_ray_of(r[c->ray[i]]);
        if (take_doubt(f, p, s, c, i, &stop[c->ray[i]]) || !s->batch.seen[i] || stop[c->ray[i]])
            continue;
        const medium_stretch seen = stretch_of(&s->batch, i);
        if (c->treelet[i] != p->treelet)
            end_run(f, p);
        p->treelet = c->treelet[i];
        join(f, p, &p->run, &seen);
        stop[c->ray[i]] = is_dark(f, p);
    }
}

static void medium_take(const frame *f, ray_record *const r[], const segment_columns *c,
                        bool stop[], void *scratch) {
    const medium_look *look = look_of(f);
    take_scratch *s = scratch;
    medium_batch *m = &s->batch;
    lit_ray on = {.of = NULL};
    m->transfer = &look->media[filled_from(f, 0)];
    set_rules(look, r, c, m);
    medium_batch_kernels[f->isa](m, c);
    if (f->tracer[filled_from(f, 0)].doubts) {
        take_doubted(f, r, c, stop, s);
        return;
    }
    for (unsigned i = 0; i < c->count; i++)
        if (c->spread[i] >= SEGMENT_EXACT)
            medium_batch_whole(m, c, i);
    for (unsigned i = 0, end; i < c->count; i = end) {
        const unsigned number = c->ray[i];
        medium_ray *p = medium_ray_of(r[number]);
        for (end = i + 1;
             end < c->count && c->ray[end] == number && c->treelet[end] == c->treelet[i];)
            end++;
        if (!stop[number])
            stop[number] = join_pieces(f, p, m, c, i, end, look->shade ? &on : NULL);
    }
}

/* Ask for the pieces up to the surface, in one volume. */
static bool ask_for_pieces(const frame *f, medium_ray *p, ray_question *q) {
    const int v = filled_from(f, 0);
    const world_ray w = way_of(f, p);
    p->way.head.volume = (uint16_t)v;
    if (is_dark(f, p) || !tracer_ray(&f->tracer[v], w.origin, w.direction, w.t0, w.t1, &q->ray))
        return false;
    if (!p->begun) {
        p->walk = segments_begin(p->kept, SEGMENTS_KEPT);
        p->treelet = LEAF_NO_TREELET;
        p->begun = true;
    }
    p->walk.ahead = p->kept; /* records are copied */
    q->tracer = &f->tracer[v];
    q->state = NULL;
    q->walk = &p->walk;
    q->kept = p->kept;
    return true;
}

/* ---- Several media ---- */

/* The rule for a lane's pieces. */
static medium_rule lane_rule(const frame *f, const medium_ray *p, const overlay_lane *l) {
    medium_rule rule = p->rule;
    rule.transfer = &look_of(f)->media[l->volume];
    rule.error = l->error;
    return rule;
}

/* What is seen of [t0, t1] of a stretch; light: NULL, or the factors of colours. */
static medium_stretch seen_of(const frame *f, const medium_ray *p, const overlay_stretch *s,
                              double t0, double t1, const double (*light)[3]) {
    const medium_overlay_rule all = {p->rule.share, p->rule.per_length, p->rule.drop,
                                     at_cut * look_of(f)->error, look_of(f)->brightest};
    medium_layer layers[MEDIUM_LAYERS_MAX];
    for (int i = 0; i < s->count; i++) {
        const segment *piece = &s->lane[i]->piece;
        const medium_rule rule = lane_rule(f, p, s->lane[i]);
        const double length = piece->t1 - piece->t0;
        if (s->count == 1 && t0 == piece->t0 && t1 == piece->t1) {
            medium_stretch seen = medium_of_piece(&rule, piece);
            if (light)
                light_up(&seen, light[0]);
            return seen;
        }
        layers[i] =
            medium_layer_of(&rule, piece, (t0 - piece->t0) / length, (t1 - piece->t0) / length);
        if (light)
            memcpy(layers[i].light, light[i], sizeof layers[i].light);
    }
    return medium_of_layers(&all, layers, s->count, t1 - t0);
}

/* A stretch of several volumes, for shading. */
typedef struct seen_stretch {
    const frame *f;
    const medium_ray *p;
    const overlay_stretch *s;
} seen_stretch;

static medium_stretch see_stretch(const void *ctx, double t0, double t1, const double light[][3]) {
    const seen_stretch *s = ctx;
    return seen_of(s->f, s->p, s->s, t0, t1, light);
}

/* See a stretch, shaded. Returns false if the treelet of lane *missed is needed. */
static bool shade_stretch(const frame *f, const medium_ray *p, const world_ray *w,
                          const overlay_stretch *s, medium_stretch *seen, int *missed) {
    const seen_stretch all = {f, p, s};
    shaded_stretch lit = {.shade = look_of(f)->shade,
                          .ray = w,
                          .count = s->count,
                          .see = see_stretch,
                          .ctx = &all,
                          .most_rgb = look_of(f)->brightest};
    for (int i = 0; i < s->count; i++) {
        const overlay_lane *l = s->lane[i];
        const tracer *tr = &f->tracer[l->volume];
        const treelet *at = loader_lookup(tr->treelets, l->piece.treelet);
        ray r;
        *missed = (int)(l - p->lanes);
        if (!at && !tr->preview)
            return false;
        (void)tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &r);
        lit.of[i] = lit_piece(f, l->volume, at, &r, &l->piece);
    }
    *seen = medium_shade_stretch(&lit, s->t0, s->t1, p->front.through * p->run.through);
    return true;
}

/* Wait for a treelet of a lane's volume. */
static bool await(medium_ray *p, int lane, uint32_t missed, ray_question *q) {
    p->way.head.volume = p->lanes[lane].volume;
    q->state = NULL;
    q->walk = NULL;
    q->extreme = NULL;
    q->missed = missed;
    return true;
}

/* Pass all filled volumes up to the surface. Returns true if a treelet is missed. */
static bool pass_media(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters) {
    const world_ray w = way_of(f, p);
    const int count = look_of(f)->filled;
    overlay_stretch stretch;
    int missed;
    segments_result result = SEGMENTS_SOME;
    if (!p->begun) {
        overlay_begin(p->lanes, count);
        p->reached = p->from;
        p->begun = true;
    }
    while (result == SEGMENTS_SOME && !is_dark(f, p)) {
        result = overlay_next(f, &w, p->lanes, count, &p->reached, &stretch, &missed, counters);
        if (result == SEGMENTS_BLOCKED)
            return await(p, missed, p->lanes[missed].walk.blocked, q);
        if (result != SEGMENTS_SOME)
            break;
        medium_stretch seen;
        if (!look_of(f)->shade)
            seen = seen_of(f, p, &stretch, stretch.t0, stretch.t1, NULL);
        else if (!shade_stretch(f, p, &w, &stretch, &seen, &missed)) {
            p->reached = stretch.t0;
            return await(p, missed, p->lanes[missed].piece.treelet, q);
        }
        medium_join(&p->run, &seen, look_of(f)->brightest);
    }
    return false;
}

static void end_media(medium_ray *p, int count) {
    for (int i = 0; i < count; i++)
        p->unbounded |= p->lanes[i].walk.provisional;
    p->begun = false;
}

/* ---- Surfaces ---- */

/* Error of the depth at a surface: t is off, so more or less of the medium is in front of it. */
static double depth_error_at(const frame *f, const medium_ray *p) {
    const surface_point *at = &p->way.search.point;
    const world_ray w = surface_ray_primary(f, p->way.head.pixel);
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += at->gradient[a] * w.direction[a];
    double most_k = 0.0;
    for (int v = 0; v < f->volumes; v++)
        most_k += look_of(f)->media[v].most_k;
    if (most_k == 0.0)
        return 0.0;
    return slope != 0.0 ? fmin(at->error / fabs(slope) * most_k, 1.0) : 1.0;
}

/* Join the surface as a stretch. Returns false if nothing behind it counts. */
static bool composite(const frame *f, medium_ray *p) {
    const double opacity = (double)surface_ray_opacity(f, &p->way);
    medium_stretch s = {.through = 1.0 - opacity};
    for (int c = 0; c < 3; c++)
        s.rgb[c] = opacity * (double)p->way.rgb[c];
    s.rgb_error = depth_error_at(f, p) * look_of(f)->brightest;
    s.through_error = depth_error_at(f, p) * s.through;
    join(f, p, &p->front, &s);
    p->from = p->way.search.found.t;
    return surface_ray_pass(f, &p->way) && s.through > 0.0 && !is_dark(f, p);
}

/* ---- The pixel ---- */

/* Bound of the error of the pixel with channels x. Unknown surfaces may be anywhere. */
static double pixel_error(const frame *f, medium_ray *p, const double x[4],
                          ray_counters *counters) {
    const float *background = look_of(f)->surfaces.scene->background;
    const bool unbounded = p->unbounded || p->coarse || p->way.provisional;
    double error = medium_pixel_error(&p->front, background);
    if (unbounded || error > look_of(f)->error) {
        const double most = medium_pixel_most(look_of(f)->brightest, background, x);
        error = unbounded ? most : fmin(error, most);
    }
    p->way.provisional |= p->doubted || p->unbounded;
    if (look_of(f)->shade)
        error = (double)INFINITY;
    if (p->way.provisional && !look_of(f)->shade)
        ray_counters_doubt(counters, error);
    else
        counters->uncertified_pixels += error > look_of(f)->error;
    return error;
}

static void write(const frame *f, medium_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const float *background = look_of(f)->surfaces.scene->background;
    const size_t at = frame_plane(f, p->way.head.pixel);
    const medium_stretch *s = &p->front;
    const double rest = s->through * (double)background[3];
    double x[4];
    float rgba[4];
    for (int c = 0; c < 4; c++) {
        x[c] = c < 3 ? s->rgb[c] + rest * (double)background[c] : 1.0 - s->through + rest;
        if (image->rgba)
            image->rgba[4 * at + (size_t)c] = x[c];
        rgba[c] = (float)x[c];
    }
    const double error = pixel_error(f, p, x, counters);
    if (image->error)
        image->error[at] = error;
    surface_ray_write(f, &p->way, rgba, counters);
}

static void end(const frame *f, medium_ray *p, ray_counters *counters) {
    end_run(f, p);
    if (is_dark(f, p))
        leave_out_rest(f, p);
    write(f, p, counters);
}

/* ---- The machine ---- */

/* Meet the surface. Returns false if none can be seen: the pixel is done. */
static bool meet(const frame *f, medium_ray *p, ray_counters *counters) {
    end_run(f, p);
    p->way.head.volume = 0;
    return surface_ray_meet(f, &p->way, counters) && !is_dark(f, p);
}

/* Walk through the media in front of the surface. Returns whether it asks. */
static bool walk(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters) {
    if (!overlaid(f))
        return ask_for_pieces(f, p, q);
    if (pass_media(f, p, q, counters))
        return true;
    end_media(p, look_of(f)->filled);
    return false;
}

static bool medium_ask(const frame *f, ray_record *record, ray_question *q,
                       ray_counters *counters) {
    medium_ray *p = medium_ray_of(record);
    for (bool more = true; more;) {
        if (p->stage == FINDING) {
            if (surface_ray_find(f, &p->way, q))
                return true;
            p->stage = WALKING;
        }
        if (p->stage == WALKING && walk(f, p, q, counters))
            return true;
        if (p->stage != LIGHTING)
            more = meet(f, p, counters);
        p->stage = LIGHTING;
        if (more && surface_ray_light(f, &p->way, q, counters))
            return true;
        more = more && composite(f, p);
        p->stage = FINDING;
    }
    end(f, p, counters);
    return false;
}

static void medium_answer(const frame *f, ray_record *record, trace_result result) {
    medium_ray *p = medium_ray_of(record);
    if (p->stage != WALKING) {
        surface_ray_answer(f, &p->way, result);
        return;
    }
    settle(f, p, INFINITY);
    p->begun = false;
    p->stage = MEETING;
}

homogeneous medium_homogeneous(const medium_look *look, int v, double longest, bool integers,
                               double threshold) {
    const medium_whole_rule rule = {.transfer = &look->media[v],
                                    .share = by_opacity * look->error,
                                    .per_length = by_length * look->error /
                                                  fmax(longest * (1.0 + 0x1p-20), 1e-300),
                                    .brightest = look->brightest,
                                    .threshold = threshold};
    return medium_whole(&rule, look->range[v], integers);
}

size_t medium_record_more(const medium_look *look, bool preview) {
    if (look->overlaid)
        return (size_t)look->filled * sizeof(overlay_lane);
    return preview ? sizeof(medium_doubt) : 0;
}

const integrator medium_integrator = {.record_bytes = sizeof(medium_ray),
                                      .begin = medium_begin,
                                      .ask = medium_ask,
                                      .answer = medium_answer,
                                      .take_scratch = sizeof(take_scratch),
                                      .take = medium_take,
                                      .bundle = surface_ray_bundle};
