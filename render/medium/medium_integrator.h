/* medium_integrator.h - media, with surfaces in them. A ray sees the medium up to the next surface,
 * that surface, and so on behind it (medium_stretch.h, surface_ray.h). Pieces of one filled volume
 * come in batches with those of other rays. Several filled volumes are laid over each other ray by
 * ray (overlay_ray.h, medium_overlay.h).
 *
 * The error of a pixel is shared out: parts for the medium, by its opacity and by its length, and a
 * part for the end. A ray ends when nothing of more weight can follow. The light of surfaces counts
 * as exact. Shadows through media are not drawn.
 *
 * A preview goes on where treelets are absent, with a guess and a bound of its own
 * (medium_doubt.h). Where surfaces are not certain, or several media are at one place, the bound is
 * all that may be seen.
 */
#ifndef RENDER_MEDIUM_MEDIUM_INTEGRATOR_H
#define RENDER_MEDIUM_MEDIUM_INTEGRATOR_H

#include "render/look/transfer.h"
#include "render/medium/medium_shade.h"
#include "render/surface/surface_integrator.h"
#include "stream/homogeneous.h"

extern const integrator medium_integrator;

/* frame.look */
typedef struct medium_look {
    surface_look surfaces;    /* must be first: the surfaces' code uses it as frame.look */
    const transfer *media;    /* one for each volume; without spans: no medium there */
    const double (*range)[2]; /* one for each volume: its values lie in it */
    int filled;               /* number of filled volumes */
    double error;             /* the most that a channel may be off */
    double brightest; /* the largest component of any medium's colour, surface's, light's, ... */
    /* Shades colours; then no pixel is certified. NULL: colours are not shaded. */
    const medium_shade *shade;
    /* Lay pieces of all volumes over each other ray by ray: several are filled; or one is shaded
     * whose pieces may come after their treelet was evicted. */
    bool overlaid;
    bool unbounded; /* preview: what is drawn may be off by anything */
} medium_look;

/* medium_record_more() - frame.record_more for this look, in a preview or not. */
size_t medium_record_more(const medium_look *look, bool preview);

/* medium_homogeneous() - which values of volume v, the only filled one, are equivalent
 * (medium_whole.h). longest: at least the world length of any ray in it; threshold: 0, or as in
 * leafcast_experimental.h. */
homogeneous medium_homogeneous(const medium_look *look, int v, double longest, bool integers,
                               double threshold);

#endif
