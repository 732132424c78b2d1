#include "render/medium/medium_shade.h"

#include <math.h>

#include "formats/base/vec3.h"
#include "render/surface/surface_light.h"

/* A stretch is not halved if L changes by at most `enough` in it, or the change alters the pixel by
 * at most `too_little`. A piece is halved at most HALVINGS times. */
static const double enough = 1.0 / 128.0, too_little = 1.0 / 1024.0;
enum { HALVINGS = 5 };

double medium_shade_steepness(double fade, double cell_size, const double range[2]) {
    const double width = (fade > 0.0 ? fade : MEDIUM_SHADE_FADE) * (range[1] - range[0]);
    const double steepness = cell_size / width;
    return width > 0.0 && isfinite(steepness) ? steepness : 0.0;
}

static double most_of(const leafcast_scene *scene) {
    double sum[3] = {0.0, 0.0, 0.0};
    for (int i = 0; i < scene->light_count; i++)
        for (int c = 0; c < 3; c++)
            sum[c] += fabs((double)scene->lights[i].rgb[c]);
    return fmax(1.0, (double)scene->ambient + fmax(sum[0], fmax(sum[1], sum[2])));
}

medium_shade medium_shade_of(const leafcast_scene *scene) {
    static const double nowhere[3] = {0.0, 0.0, 0.0};
    medium_shade m = {.scene = scene, .most = most_of(scene)};
    for (int i = 0; i < scene->light_count; i++)
        if (!scene->lights[i].point)
            (void)light_from(&scene->lights[i], nowhere, m.towards[i]);
    return m;
}

/* Add what light i gives to a white surface with this normal, at t on the ray. */
static void add_light(const medium_shade *m, const world_ray *w, int i, const double normal[3],
                      double t, double sum[3]) {
    const leafcast_light *light = &m->scene->lights[i];
    const double *to = m->towards[i];
    double at[3], towards[3];
    if (light->point) {
        for (int a = 0; a < 3; a++)
            at[a] = w->origin[a] + t * w->direction[a];
        (void)light_from(light, at, towards);
        to = towards;
    }
    const double cosine = vec3_dot(normal, to);
    for (int c = 0; c < 3 && cosine > 0.0; c++)
        sum[c] += cosine * (double)light->rgb[c];
}

void medium_shade_at(const medium_shade *m, const world_ray *w, const shaded_piece *p, double t,
                     double light[3]) {
    const double ambient = (double)m->scene->ambient;
    double gradient[3], sum[3] = {0.0, 0.0, 0.0};
    light[0] = light[1] = light[2] = 1.0;
    if (p->steepness == 0.0)
        return;
    segment_gradient_at(&p->gradient, (t - p->t0) / (p->t1 - p->t0), gradient);
    const double length = vec3_length(gradient), along = vec3_dot(gradient, w->direction);
    if (!(length > 0.0 && isfinite(length)))
        return;
    const double x = p->steepness * length, turn = along > 0.0 ? -1.0 / length : 1.0 / length;
    const double normal[3] = {turn * gradient[0], turn * gradient[1], turn * gradient[2]};
    const double share = x < 1.0 ? x * x * (3.0 - 2.0 * x) : 1.0;
    for (int i = 0; i < m->scene->light_count; i++)
        add_light(m, w, i, normal, t, sum);
    for (int c = 0; c < 3; c++) {
        if (m->scene->light_count == 0)
            sum[c] = fabs(along) / length;
        light[c] += share * (ambient + (1.0 - ambient) * sum[c] - 1.0);
    }
}

typedef struct lighting {
    double of[MEDIUM_LAYERS_MAX][3];
} lighting;

static void lighting_at(const shaded_stretch *s, double t, lighting *out) {
    for (int i = 0; i < s->count; i++)
        medium_shade_at(s->shade, s->ray, &s->of[i], t, out->of[i]);
}

static double difference(const lighting *a, const lighting *b, int count) {
    double most = 0.0;
    for (int i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            most = fmax(most, fabs(a->of[i][c] - b->of[i][c]));
    return most;
}

/* A part of a stretch: L at its ends and in its middle, and what is seen with the middle's L
 * throughout. */
typedef struct lit_part {
    double t0, t1;
    const lighting *first, *last;
    lighting middle;
    medium_stretch seen;
} lit_part;

static double middle_of(const lit_part *p) {
    return 0.5 * (p->t0 + p->t1);
}

static void see_at_once(const shaded_stretch *s, lit_part *p) {
    lighting_at(s, middle_of(p), &p->middle);
    p->seen = s->see(s->ctx, p->t0, p->t1, (const double(*)[3])p->middle.of);
}

/* Returns what is seen of a part, on which see_at_once() has been called. Halves it where needed.
 */
static medium_stretch seen_of(const shaded_stretch *s, const lit_part *p, double reaching,
                              int halvings) {
    const double change =
        fmax(difference(&p->middle, p->first, s->count), difference(&p->middle, p->last, s->count));
    const double weight = reaching * (1.0 - p->seen.through);
    if (halvings == 0 || change <= enough || change * weight <= too_little)
        return p->seen;
    lit_part front = {.t0 = p->t0, .t1 = middle_of(p), .first = p->first, .last = &p->middle};
    lit_part back = {.t0 = front.t1, .t1 = p->t1, .first = &p->middle, .last = p->last};
    see_at_once(s, &front);
    see_at_once(s, &back);
    medium_stretch seen = seen_of(s, &front, reaching, halvings - 1);
    const medium_stretch behind = seen_of(s, &back, reaching * seen.through, halvings - 1);
    medium_join(&seen, &behind, s->most_rgb);
    return seen;
}

medium_stretch medium_shade_stretch(const shaded_stretch *s, double t0, double t1,
                                    double reaching) {
    lighting first, last;
    lit_part all = {.t0 = t0, .t1 = t1, .first = &first, .last = &last};
    see_at_once(s, &all);
    if (s->shade->most * reaching * (1.0 - all.seen.through) <= too_little)
        return all.seen;
    lighting_at(s, t0, &first);
    lighting_at(s, t1, &last);
    return seen_of(s, &all, reaching, HALVINGS);
}
