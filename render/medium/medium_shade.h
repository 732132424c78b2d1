/* medium_shade.h - media lit by the scene's lights, with the gradient of the value as the normal.
 *
 * At a place, each channel of the transfer function's colour is multiplied by
 *
 *     L = 1 + s (l - 1),    l = k_a + (1 - k_a) sum over the lights of max(n . to the light, 0) I
 *
 * where l is the light of a white surface (M08 eq. 4.6, as shade.h has it): n is the gradient's
 * direction, turned to the eye, k_a the ambient share, I a light's colour; without lights one
 * shines from the eye. Neither shadows nor highlights. And
 *
 *     s = x^2 (3 - 2 x),    x = min(1, |gradient| cell / (fade range))
 *
 * with the usual length of a cell, and the range of the volume's values: where the value hardly
 * changes, its gradient is noise, and the medium stays as it is. Extinction is never shaded.
 *
 * How it is sampled: the light of a stretch is linear in its colour, so where L is one number, what
 * is seen is what is seen unshaded (medium_stretch.h) times that. Stretches of which L at the
 * middle and at either end differ are halved until they do not, or too little of the pixel is left
 * of them to matter. Nothing bounds what that is off, so shaded pixels are not certified.
 */
#ifndef RENDER_MEDIUM_MEDIUM_SHADE_H
#define RENDER_MEDIUM_MEDIUM_SHADE_H

#include "render/medium/medium_overlay.h"
#include "render/surface/surface_search.h"

/* What fade is where the scene says 0. */
#define MEDIUM_SHADE_FADE (1.0 / 32.0)

/* Of a scene. */
typedef struct medium_shade {
    const leafcast_scene *scene;
    double towards[LEAFCAST_LIGHTS_MAX][3]; /* lights, from everywhere; those of points not */
    double most;                            /* L is no more than that anywhere */
    double steepness[FRAME_VOLUMES_MAX];    /* a volume: x is that times the gradient's length */
} medium_shade;

/* medium_shade_of() - of a scene, but for volumes. */
medium_shade medium_shade_of(const leafcast_scene *scene);

/* medium_shade_steepness() - of a volume of that range. */
double medium_shade_steepness(double fade, double cell_size, const double range[2]);

/* A piece of a volume, as it is lit. */
typedef struct shaded_piece {
    double t0, t1;
    double steepness; /* of its volume; 0: nothing is known of its gradient, and L is 1 */
    segment_gradient gradient;
} shaded_piece;

/* medium_shade_at() - L at t, in the piece, of a ray. */
void medium_shade_at(const medium_shade *m, const world_ray *w, const shaded_piece *p, double t,
                     double light[3]);

/* A stretch that keeps to one piece of each of some volumes. */
typedef struct shaded_stretch {
    const medium_shade *shade;
    const world_ray *ray;
    int count;
    shaded_piece of[MEDIUM_LAYERS_MAX];
    /* What is seen of [t0, t1] of it, where the colours of volume i are multiplied by light[i].
     */
    medium_stretch (*see)(const void *ctx, double t0, double t1, const double light[][3]);
    const void *ctx;
    double most_rgb; /* the largest component of any colour */
} shaded_stretch;

/* medium_shade_stretch() - what is seen of [t0, t1], of whose light so much reaches the eye. */
medium_stretch medium_shade_stretch(const shaded_stretch *s, double t0, double t1, double reaching);

#endif
