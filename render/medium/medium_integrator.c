#include "render/medium/medium_integrator.h"

#include <math.h>

#include "render/medium/medium_lanes.h"
#include "render/medium/medium_pixel.h"
#include "render/medium/medium_take.h"
#include "render/medium/medium_whole.h"
#include "render/ray/kind.h"
#include "render/surface/shade.h"

/* ---- The medium ---- */

static bool overlaid(const frame *f) {
    return medium_ray_look(f)->overlaid;
}

/* Returns the rule for all pieces of a ray in volume v. Widens way[] by the interval of t in which
 * the ray passes the volume. */
static medium_rule rule_of(const frame *f, uint32_t pixel, int v, double way[2]) {
    const medium_look *look = medium_ray_look(f);
    const tracer *tr = &f->tracer[v];
    const world_ray w = surface_ray_primary(f, pixel);
    medium_rule rule = {.transfer = &look->media[v],
                        .share = MEDIUM_SHARE_OPACITY * look->error,
                        .drop = MEDIUM_SHARE_PIECE * look->error};
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
    for (int v = 0; v < f->volumes && f->coarse; v++) {
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
    return MEDIUM_SHARE_LENGTH * medium_ray_look(f)->error / fmax(way[1] - way[0], 1e-300);
}

static void medium_begin(const frame *f, uint32_t pixel, ray_record *r) {
    medium_ray *p = medium_ray_of(r);
    double way[2] = {INFINITY, 0.0};
    surface_ray_begin(f, pixel, &p->way);
    p->stage = FINDING;
    p->begun = p->doubted = false;
    p->unbounded = medium_ray_look(f)->unbounded;
    p->coarse = meets_coarse(f, pixel);
    p->from = 0.0;
    p->rule = rule_of(f, pixel, medium_ray_filled(f, 0), way);
    for (int i = 0, v = medium_ray_filled(f, 0); i < medium_ray_look(f)->filled && overlaid(f);
         i++) {
        p->lanes[i].volume = (uint16_t)v;
        p->lanes[i].error = rule_of(f, pixel, v, way).error;
        v = medium_ray_filled(f, v + 1);
    }
    p->rule.per_length = way[1] >= way[0] ? per_length_of(f, way) : 0.0;
    p->front = p->run = medium_nothing();
}

/* Ask for the pieces of the one filled volume up to the surface. Returns false if there are none to
 * ask for. */
static bool ask_for_pieces(const frame *f, medium_ray *p, ray_question *q) {
    const int v = medium_ray_filled(f, 0);
    const world_ray w = medium_ray_way(f, p);
    p->way.head.volume = (uint16_t)v;
    if (medium_ray_is_dark(f, p) ||
        !tracer_ray(&f->tracer[v], w.origin, w.direction, w.t0, w.t1, &q->ray))
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

/* Leave out the rest of the ray: its light becomes error. */
static void leave_out_rest(const frame *f, medium_ray *p) {
    medium_ray_end_run(f, p);
    p->front.rgb_error +=
        (p->front.through + p->front.through_error) * medium_ray_look(f)->brightest;
    p->front.through_error += p->front.through;
    p->front.through = 0.0;
}

/* ---- Surfaces ---- */

/* Returns a bound of the error of the optical depth in front of a surface. t of the surface has an
 * error, so more or less of the medium may be in front of it. */
static double depth_error_at(const frame *f, const medium_ray *p) {
    const surface_point *at = &p->way.search.point;
    const world_ray w = surface_ray_primary(f, p->way.head.pixel);
    double slope = 0.0;
    for (int a = 0; a < 3; a++)
        slope += at->gradient[a] * w.direction[a];
    double most_k = 0.0;
    for (int i = 0; i < medium_ray_look(f)->filled; i++)
        most_k += medium_ray_look(f)->media[medium_ray_look(f)->filled_by[i]].most_k;
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
    s.rgb_error = depth_error_at(f, p) * medium_ray_look(f)->brightest;
    s.through_error = depth_error_at(f, p) * s.through;
    medium_ray_join(f, p, &p->front, &s);
    p->from = p->way.search.found.t;
    return surface_ray_pass(f, &p->way) && s.through > 0.0 && !medium_ray_is_dark(f, p);
}

/* ---- The pixel ---- */

/* Bound of the error of the pixel with channels x. Unknown surfaces may be anywhere. */
static double pixel_error(const frame *f, medium_ray *p, const double x[4],
                          ray_counters *counters) {
    const float *background = medium_ray_look(f)->surfaces.scene->background;
    const bool unbounded = p->unbounded || p->coarse || p->way.provisional;
    double error = medium_pixel_error(&p->front, background);
    if (unbounded || error > medium_ray_look(f)->error) {
        const double most = medium_pixel_most(medium_ray_look(f)->brightest, background, x);
        error = unbounded ? most : fmin(error, most);
    }
    p->way.provisional |= p->doubted || p->unbounded;
    if (medium_ray_look(f)->shade)
        error = (double)INFINITY;
    if (p->way.provisional && !medium_ray_look(f)->shade)
        ray_counters_doubt(counters, error);
    else
        counters->uncertified_pixels += error > medium_ray_look(f)->error;
    return error;
}

static void write(const frame *f, medium_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const float *background = medium_ray_look(f)->surfaces.scene->background;
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
    medium_ray_end_run(f, p);
    if (medium_ray_is_dark(f, p))
        leave_out_rest(f, p);
    write(f, p, counters);
}

/* ---- The machine ---- */

/* Meet the surface. Returns false if none can be seen: the pixel is done. */
static bool meet(const frame *f, medium_ray *p, ray_counters *counters) {
    medium_ray_end_run(f, p);
    p->way.head.volume = 0;
    return surface_ray_meet(f, &p->way, counters) && !medium_ray_is_dark(f, p);
}

/* Walk through the media in front of the surface. Returns true if *q asks for something first. */
static bool walk(const frame *f, medium_ray *p, ray_question *q, ray_counters *counters) {
    if (!overlaid(f))
        return ask_for_pieces(f, p, q);
    if (medium_lanes_pass(f, p, q, counters))
        return true;
    medium_lanes_end(p, medium_ray_look(f)->filled);
    return false;
}

/* Find the next surface. Walk through the media in front of it: one volume's pieces come in batches
 * to medium_take(), several volumes are passed right here. Meet the surface, light it, and join it
 * to what is in front. Then do the same behind it. */
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
    medium_take_settle(f, p, INFINITY);
    p->unbounded |= f->tracer[p->way.head.volume].lenient && p->walk.provisional;
    p->begun = false;
    p->stage = MEETING;
}

homogeneous medium_homogeneous(const medium_look *look, int v, double longest, bool integers,
                               double threshold) {
    const medium_whole_rule rule = {.transfer = &look->media[v],
                                    .share = MEDIUM_SHARE_OPACITY * look->error,
                                    .per_length = MEDIUM_SHARE_LENGTH * look->error /
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
                                      .take_scratch = sizeof(medium_take_scratch),
                                      .take = medium_take,
                                      .bundle = surface_ray_bundle};
