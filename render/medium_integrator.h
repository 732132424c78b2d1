/* medium_integrator.h - media, with surfaces in them: what a ray sees up to the next surface, that
 * surface, and so on behind it (medium_stretch.h, surface_ray.h).
 *
 * The error of a pixel is shared out: so much for what is seen of the medium, by its opacity and by
 * its length, and what is left for the end: a ray is done when nothing of more weight can come.
 * The light of surfaces is taken as it is, shadows through media are not drawn.
 */
#ifndef RENDER_MEDIUM_INTEGRATOR_H
#define RENDER_MEDIUM_INTEGRATOR_H

#include "render/surface_integrator.h"
#include "render/transfer.h"

extern const integrator medium_integrator;

/* frame.look */
typedef struct medium_look {
    surface_look surfaces;    /* first: it is that integrator's look, too */
    const transfer *media;    /* a volume; without spans: it is filled with nothing */
    const double (*range)[2]; /* a volume: its values lie in */
    double error;             /* a channel may be off by */
    double brightest; /* the largest component of any medium's colour, surface's, light's, ... */
} medium_look;

#endif
