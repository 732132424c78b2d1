#include "render/experiments/stepping_ray.h"

#include <math.h>

#include "render/ray/kind.h"

/* Make the whole ray. Returns false if it misses the volume. */
static bool ray_of(const frame *f, uint32_t pixel, ray *r) {
    double origin[3], direction[3];
    camera_ray(&f->camera, pixel % f->width + 0.5, pixel / f->width + 0.5, origin, direction);
    return tracer_ray(&f->tracer[0], origin, direction, 0.0, (double)INFINITY, r);
}

void stepping_ray_begin(const frame *f, uint32_t pixel, ray_record *record) {
    stepping_ray *p = stepping_ray_of(record);
    ray r;
    *p = (stepping_ray){.head = {.pixel = pixel}, .through = 1.0, .from = 1.0};
    if (!ray_of(f, pixel, &r))
        return;
    p->from = r.t0;
    p->to = r.t1;
    if (!tracer_box(&f->tracer[0], &r, &p->from, &p->to))
        p->to = p->from - 1.0;
}

bool stepping_ray_ask(const frame *f, stepping_ray *p, ray_question *q) {
    if (p->head.volume > 0 || p->from > p->to || !ray_of(f, p->head.pixel, &q->ray))
        return false;
    if (!p->begun)
        p->walk = segments_begin(p->kept, SEGMENTS_KEPT);
    p->begun = true;
    p->walk.ahead = p->kept; /* records are copied */
    q->tracer = &f->tracer[0];
    q->state = NULL;
    q->walk = &p->walk;
    q->kept = p->kept;
    return true;
}

/* The walk through the volume has ended. */
void stepping_ray_answer(const frame *f, ray_record *record, trace_result result) {
    stepping_ray *p = stepping_ray_of(record);
    (void)f;
    (void)result;
    p->provisional = p->walk.provisional;
    p->head.volume++;
}

ray_bundle stepping_ray_bundle(const frame *f, uint32_t leg) {
    (void)leg;
    return camera_bundle(&f->camera);
}

void stepping_ray_write(const frame *f, const stepping_ray *p, ray_counters *counters) {
    const leafcast_image *image = &f->image;
    const float *background = stepping_look_of(f)->background;
    const size_t at = frame_plane(f, p->head.pixel);
    const double rest = p->through * (double)background[3];
    float *const planes[4] = {image->r, image->g, image->b, image->a};
    for (int c = 0; c < 4; c++) {
        const double x = c < 3 ? p->rgb[c] + rest * (double)background[c] : 1.0 - p->through + rest;
        if (image->rgba)
            image->rgba[4 * at + (size_t)c] = x;
        if (planes[c])
            planes[c][at] = (float)x;
    }
    if (image->error)
        image->error[at] = (double)INFINITY;
    if (image->value)
        image->value[at] = (double)NAN;
    if (image->z)
        image->z[at] = (double)INFINITY;
    if (image->id)
        image->id[at] = -1;
    for (int a = 0; a < 3; a++)
        if (image->normal[a])
            image->normal[a][at] = 0.0f;
    if (image->provisional)
        image->provisional[at] = p->provisional;
    counters->uncertified_pixels++;
    counters->provisional_pixels += p->provisional;
}
