#include "render/medium/medium_take.h"

#include "render/medium/medium_whole.h"
#include "render/ray/kind.h"

/* Set each piece's rule. Pieces of one ray mostly follow each other. */
static void set_rules(const medium_look *look, ray_record *const r[], const segment_columns *c,
                      medium_batch *m) {
    m->share = MEDIUM_SHARE_OPACITY * look->error;
    m->drop = MEDIUM_SHARE_PIECE * look->error;
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

void medium_take_settle(const frame *f, medium_ray *p, double t) {
    medium_stretch seen;
    if (p->doubted && medium_doubt_take(medium_ray_doubt(p), &p->rule, t, &seen))
        medium_ray_join(f, p, &p->run, &seen);
}

static const medium_doubtful *doubtful_of(const frame *f, medium_take_scratch *s, uint32_t t) {
    const int v = medium_ray_filled(f, 0);
    const unsigned i = t % MEDIUM_DOUBTFUL;
    if (s->treelet[i] != t)
        s->doubtful[i] = medium_doubtful_of(&medium_ray_look(f)->media[v], &f->tracer[v], t);
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

/* Take piece i of a ray in a preview, if it is a doubt or a guess. Returns true if nothing is left
 * to do for the piece; also when the ray has become dark. */
static bool take_doubt(const frame *f, medium_ray *p, medium_take_scratch *s,
                       const segment_columns *c, unsigned i, bool *stop) {
    const medium_batch *m = &s->batch;
    medium_take_settle(f, p, c->t0[i]);
    *stop = *stop || medium_ray_is_dark(f, p);
    if (*stop)
        return true;
    if (c->spread[i] < 0.0) {
        const segment is = {
            .t0 = c->t0[i], .t1 = c->t1[i], .spread = c->spread[i], .treelet = c->treelet[i]};
        if (!p->doubted)
            *medium_ray_doubt(p) = (medium_doubt){0};
        p->doubted = true;
        medium_doubt_begin(medium_ray_doubt(p), &is, doubtful_of(f, s, c->treelet[i]));
        return true;
    }
    const bool bounded = p->doubted && medium_doubt_bounds(medium_ray_doubt(p), c->t0[i]);
    if (c->spread[i] >= SEGMENT_EXACT && !bounded)
        medium_batch_whole(&s->batch, c, i);
    if (!p->doubted)
        return false;
    medium_stretch seen = m->seen[i] ? stretch_of(m, i) : medium_nothing();
    if (bounded) {
        const segment piece = piece_of(c, i);
        medium_doubt_near(medium_ray_doubt(p), &p->rule, &piece, &seen);
        medium_ray_join(f, p, &p->run, &seen);
        return true;
    }
    return medium_doubt_guess(medium_ray_doubt(p), c->t1[i], &seen);
}

/* A piece of the one filled volume. whole: what is seen of all of it, unshaded. */
typedef struct seen_piece {
    const medium_rule *rule;
    const segment *piece;
    medium_stretch whole;
} seen_piece;

static medium_stretch integrate_part(const void *ctx, double t0, double t1,
                                     const double light[][3]) {
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
    medium_ray_shade(&seen, light[0]);
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
    const int v = medium_ray_filled(f, 0);
    const tracer *tr = &f->tracer[v];
    const segment piece = piece_of(c, i);
    if (on->of != p) {
        on->of = p;
        on->in_world = medium_ray_way(f, p);
        const world_ray *w = &on->in_world;
        (void)tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &on->in_volume);
    }
    const seen_piece all = {&p->rule, &piece, *seen};
    const treelet *at = loader_lookup(tr->treelets, piece.treelet);
    const shaded_stretch s = {.shade = medium_ray_look(f)->shade,
                              .ray = &on->in_world,
                              .count = 1,
                              .of = {medium_ray_lit(f, v, at, &on->in_volume, &piece)},
                              .see = integrate_part,
                              .ctx = &all,
                              .most_rgb = medium_ray_look(f)->brightest};
    *seen = medium_shade_stretch(&s, piece.t0, piece.t1, p->front.through * p->run.through);
}

/* Join pieces i to `end` - 1, all of one ray in one treelet. on: NULL if not shaded. Returns
 * whether the ray has become dark. */
static bool join_pieces(const frame *f, medium_ray *p, const medium_batch *m,
                        const segment_columns *c, unsigned i, unsigned end, lit_ray *on) {
    const double most_rgb = medium_ray_look(f)->brightest,
                 least = MEDIUM_SHARE_END * medium_ray_look(f)->error;
    while (i < end && !m->seen[i])
        i++;
    if (i == end)
        return false;
    if (c->treelet[i] != p->treelet)
        medium_ray_end_run(f, p);
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
        dark = in_front * run.through * most_rgb <= least; /* medium_ray_is_dark() */
    }
    p->run = run;
    return dark;
}

/* Take pieces one by one, in a preview. */
static void take_doubted(const frame *f, ray_record *const r[], const segment_columns *c,
                         bool stop[], medium_take_scratch *s) {
    for (int i = 0; i < MEDIUM_DOUBTFUL; i++)
        s->treelet[i] = LEAF_NO_TREELET;
    for (unsigned i = 0; i < c->count; i++) {
        medium_ray *p = medium_ray_of(r[c->ray[i]]);
        if (take_doubt(f, p, s, c, i, &stop[c->ray[i]]) || !s->batch.seen[i] || stop[c->ray[i]])
            continue;
        const medium_stretch seen = stretch_of(&s->batch, i);
        if (c->treelet[i] != p->treelet)
            medium_ray_end_run(f, p);
        p->treelet = c->treelet[i];
        medium_ray_join(f, p, &p->run, &seen);
        stop[c->ray[i]] = medium_ray_is_dark(f, p);
    }
}

void medium_take(const frame *f, ray_record *const r[], const segment_columns *c, bool stop[],
                 void *scratch) {
    const medium_look *look = medium_ray_look(f);
    medium_take_scratch *s = scratch;
    medium_batch *m = &s->batch;
    lit_ray on = {.of = NULL};
    m->transfer = &look->media[medium_ray_filled(f, 0)];
    set_rules(look, r, c, m);
    medium_batch_kernels[f->isa](m, c);
    if (f->tracer[medium_ray_filled(f, 0)].doubts) {
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
