/* medium_shade.h - media lit by the scene's lights, with the gradient of the value as the normal.
 *
 * At each place, each channel of the transfer function's colour is multiplied by
 *
 *     L = 1 + s (l - 1),    l = k_a + (1 - k_a) sum over the lights of max(n . to the light, 0) I
 *
 * where l is the light of a white surface (M08 eq. 4.6, as shade.h has it): n is the gradient's
 * direction, turned to the eye, k_a the ambient share, I a light's colour. Without lights, one
 * white light shines from the eye. There are no shadows and no highlights. The factor s is
 *
 *     s = x^2 (3 - 2 x),    x = min(1, |gradient| cell / (fade range))
 *
 * where `cell` is the usual length of a cell, and `range` the range of the volume's values. Where
 * the value hardly
 * changes, its gradient is noise, so the medium is not shaded there. Extinction is never shaded.
 *
 * Sampling: the light of a stretch is linear in its colour. So where L is constant, what is seen is
 * L times what is seen unshaded (medium_stretch.h). Stretches where L differs between the middle
 * and either end are halved, until it does not differ or they matter too little to the pixel. The
 * error is not bounded, so shaded pixels are not certified.
 */
#ifndef RENDER_MEDIUM_MEDIUM_SHADE_H
#define RENDER_MEDIUM_MEDIUM_SHADE_H

#include "render/medium/medium_overlay.h"
#include "render/surface/surface_search.h"

/* The default of fade, where the scene says 0. */
#define MEDIUM_SHADE_FADE (1.0 / 32.0)

/* The part of a scene that shading needs. */
typedef struct medium_shade {
    const leafcast_scene *scene;
    double towards[LEAFCAST_LIGHTS_MAX][3]; /* direction to each light that is not a point */
    double most;                            /* upper bound of L */
    const double *steepness;                /* per volume: cell / (fade range), as in x above */
} medium_shade;

/* medium_shade_of() - make a medium_shade for a scene; the caller sets steepness. */
medium_shade medium_shade_of(const leafcast_scene *scene);

/* medium_shade_steepness() - the steepness of a volume with that range of values. */
double medium_shade_steepness(double fade, double cell_size, const double range[2]);

/* A piece of a volume, for shading. */
typedef struct shaded_piece {
    double t0, t1;
    double steepness; /* of its volume; 0: the gradient is unknown, and L is 1 */
    segment_gradient gradient;
} shaded_piece;

/* medium_shade_at() - set light to L at t on a ray, inside the piece. */
void medium_shade_at(const medium_shade *m, const world_ray *w, const shaded_piece *p, double t,
                     double light[3]);

/* A stretch that lies within one piece of each of some volumes. */
typedef struct shaded_stretch {
    const medium_shade *shade;
    const world_ray *ray;
    int count;
    shaded_piece of[MEDIUM_LAYERS_MAX];
    /* Returns what is seen of [t0, t1] of it, with the colours of volume i multiplied by light[i].
     */
    medium_stretch (*see)(const void *ctx, double t0, double t1, const double light[][3]);
    const void *ctx;
    double most_rgb; /* the largest component of any colour */
} shaded_stretch;

/* medium_shade_stretch() - returns what is seen of [t0, t1], shaded. reaching: the share of the
 * stretch's light that reaches the eye. */
medium_stretch medium_shade_stretch(const shaded_stretch *s, double t0, double t1, double reaching);

#endif
