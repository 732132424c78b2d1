#include "render/medium/medium_lanes.h"

#include <string.h>

#include "render/medium/medium_overlay.h"
#include "render/ray/kind.h"

/* The rule for a lane's pieces. */
static medium_rule lane_rule(const frame *f, const medium_ray *p, const overlay_lane *l) {
    medium_rule rule = p->rule;
    rule.transfer = &medium_ray_look(f)->media[l->volume];
    rule.error = l->error;
    return rule;
}

/* What is seen of [t0, t1] of a stretch; light: NULL, or the factors of colours. */
static medium_stretch seen_of(const frame *f, const medium_ray *p, const overlay_stretch *s,
                              double t0, double t1, const double (*light)[3]) {
    const medium_overlay_rule all = {p->rule.share, p->rule.per_length, p->rule.drop,
                                     MEDIUM_SHARE_CUT * medium_ray_look(f)->error,
                                     medium_ray_look(f)->brightest};
    medium_layer layers[MEDIUM_LAYERS_MAX];
    for (int i = 0; i < s->count; i++) {
        const segment *piece = &s->lane[i]->piece;
        const medium_rule rule = lane_rule(f, p, s->lane[i]);
        const double length = piece->t1 - piece->t0;
        if (s->count == 1 && t0 == piece->t0 && t1 == piece->t1) {
            medium_stretch seen = medium_of_piece(&rule, piece);
            if (light)
                medium_ray_shade(&seen, light[0]);
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
    shaded_stretch lit = {.shade = medium_ray_look(f)->shade,
                          .ray = w,
                          .count = s->count,
                          .see = see_stretch,
                          .ctx = &all,
                          .most_rgb = medium_ray_look(f)->brightest};
    for (int i = 0; i < s->count; i++) {
        const overlay_lane *l = s->lane[i];
        const tracer *tr = &f->tracer[l->volume];
        const treelet *at = loader_lookup(tr->treelets, l->piece.treelet);
        ray r;
        *missed = (int)(l - p->lanes);
        if (!at && !tr->preview)
            return false;
        (void)tracer_ray(tr, w->origin, w->direction, w->t0, w->t1, &r);
        lit.of[i] = medium_ray_lit(f, l->volume, at, &r, &l->piece);
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

bool medium_lanes_pass(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters) {
    const world_ray w = medium_ray_way(f, p);
    const int count = medium_ray_look(f)->filled;
    overlay_stretch stretch;
    int missed;
    segments_result result = SEGMENTS_SOME;
    if (!p->begun) {
        overlay_begin(p->lanes, count);
        p->reached = p->from;
        p->begun = true;
    }
    while (result == SEGMENTS_SOME && !medium_ray_is_dark(f, p)) {
        result = overlay_next(f, &w, p->lanes, count, &p->reached, &stretch, &missed, counters);
        if (result == SEGMENTS_BLOCKED)
            return await(p, missed, p->lanes[missed].walk.blocked, q);
        if (result != SEGMENTS_SOME)
            break;
        medium_stretch seen;
        if (!medium_ray_look(f)->shade)
            seen = seen_of(f, p, &stretch, stretch.t0, stretch.t1, NULL);
        else if (!shade_stretch(f, p, &w, &stretch, &seen, &missed)) {
            p->reached = stretch.t0;
            return await(p, missed, p->lanes[missed].piece.treelet, q);
        }
        medium_join(&p->run, &seen, medium_ray_look(f)->brightest);
    }
    return false;
}

void medium_lanes_end(medium_ray *p, int count) {
    for (int i = 0; i < count; i++)
        p->unbounded |= p->lanes[i].walk.provisional;
    p->begun = false;
}
