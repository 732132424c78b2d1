/* medium_integrator.h - media, with surfaces in them: what a ray sees up to the next surface, that
 * surface, and so on behind it (medium_stretch.h, surface_ray.h). One filled volume's pieces come
 * with those of other rays; several volumes' are laid over each other ray by ray (overlay_ray.h,
 * medium_overlay.h).
 *
 * The error of a pixel is shared out: so much for what is seen of the medium, by its opacity and by
 * its length, and what is left for the end: a ray is done when nothing of more weight can come.
 * The light of surfaces is taken as it is, shadows through media are not drawn.
 *
 * A preview goes on where treelets are absent, with a guess and a bound of its own
 * (medium_doubt.h). Where surfaces are not sure, or several media are at one place, its bound is
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
    surface_look surfaces;    /* first: it is that integrator's look, too */
    const transfer *media;    /* a volume; without spans: it is filled with nothing */
    const double (*range)[2]; /* a volume: its values lie in */
    int filled;               /* how many are */
    double error;             /* a channel may be off by */
    double brightest; /* the largest component of any medium's colour, surface's, light's, ... */
    /* Colours are shaded by it, and no pixel is certified; NULL: they are as they are. */
    const medium_shade *shade;
    /* Pieces of all volumes are laid over each other ray by ray: several are filled; or one is
     * shaded whose pieces may come when their treelet is gone. */
    bool overlaid;
    bool unbounded; /* preview: what is drawn stands for what may be anything */
} medium_look;

/* medium_record_more() - frame.record_more for it, in a preview or not. */
size_t medium_record_more(const medium_look *look, bool preview);

/* medium_homogeneous() - which values of volume v, if it alone is filled, may be taken for one
 * (medium_whole.h). longest: at least the world length of any ray in it; threshold: 0, or as in
 * leafcast_experimental.h. */
homogeneous medium_homogeneous(const medium_look *look, int v, double longest, bool integers,
                               double threshold);

#endif
