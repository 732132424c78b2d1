/* medium_ray.h - a ray of the medium_integrator: its record, and the operations on it that
 * medium_take.h and medium_lanes.h share. */
#ifndef RENDER_MEDIUM_MEDIUM_RAY_H
#define RENDER_MEDIUM_MEDIUM_RAY_H

#include "render/medium/medium_doubt.h"
#include "render/medium/medium_look.h"
#include "render/medium/overlay_ray.h"
#include "render/surface/surface_ray.h"

/* What a ray does: find the next surface, walk through the medium in front of it, meet it, be lit
 * there. */
typedef enum medium_stage { FINDING, WALKING, MEETING, LIGHTING } medium_stage;

typedef struct medium_ray {
    surface_ray way;
    medium_stage stage;
    bool begun;     /* the walk has begun */
    bool doubted;   /* preview: the ray has met a doubt */
    bool unbounded; /* preview: absent data may be anything */
    bool coarse;    /* the ray meets a volume that is drawn coarser than its data */
    double reached; /* with several media: t up to which they have been walked */
    medium_rule rule;
    uint32_t treelet; /* of the last piece */
    double from;      /* everything before this t is in `front` */
    medium_stretch front;
    medium_stretch run; /* behind front: pieces in one treelet */
    segments_state walk;
    segment kept[SEGMENTS_KEPT];
    overlay_lane lanes[]; /* of the filled volumes, if overlaid; or a doubt */
} medium_ray;

static inline medium_ray *medium_ray_of(ray_record *r) {
    return (medium_ray *)r;
}

static inline const medium_look *medium_ray_look(const frame *f) {
    return f->look;
}

/* The doubt behind the run, in a preview of one filled volume, once `doubted`. */
static inline medium_doubt *medium_ray_doubt(medium_ray *p) {
    return (medium_doubt *)(void *)p->lanes;
}

/* The first filled volume from v on. */
static inline int medium_ray_filled(const frame *f, int v) {
    const medium_look *look = medium_ray_look(f);
    int i = 0;
    while (i < look->filled && look->filled_by[i] < v)
        i++;
    return i < look->filled ? look->filled_by[i] : f->volumes;
}

/* Whether so little light comes through that the rest may be left out. Leaving it out adds to the
 * error. */
static inline bool medium_ray_is_dark(const frame *f, const medium_ray *p) {
    const double through = p->front.through * p->run.through;
    return through * medium_ray_look(f)->brightest <= MEDIUM_SHARE_END * medium_ray_look(f)->error;
}

/* medium_ray_way() - returns the ray's way from p->from to the surface. */
world_ray medium_ray_way(const frame *f, const medium_ray *p);

/* medium_ray_join() - put stretch `behind` behind *front. */
void medium_ray_join(const frame *f, const medium_ray *p, medium_stretch *front,
                     const medium_stretch *behind);

/* medium_ray_end_run() - put p->run behind p->front, and begin an empty run. */
void medium_ray_end_run(const frame *f, medium_ray *p);

/* medium_ray_lit() - prepare piece s of volume v for shading. at: its treelet; NULL: absent, in a
 * preview. Then the piece is not shaded. */
shaded_piece medium_ray_lit(const frame *f, int v, const treelet *at, const ray *r,
                            const segment *s);

static inline void medium_ray_shade(medium_stretch *seen, const double light[3]) {
    for (int c = 0; c < 3; c++)
        seen->rgb[c] *= light[c];
}

#endif
