/* medium_look.h - how media look, and how the error allowed for a pixel is divided.
 *
 * Two shares are for the medium, in proportion to its opacity and to its length. One share is for
 * the end of the ray: a ray ends when what follows cannot weigh more. The light of surfaces counts
 * as exact. Media throw no shadows.
 */
#ifndef RENDER_MEDIUM_MEDIUM_LOOK_H
#define RENDER_MEDIUM_MEDIUM_LOOK_H

#include "render/look/transfer.h"
#include "render/medium/medium_shade.h"
#include "render/surface/surface_integrator.h"

/* Shares of the pixel's error. OPACITY, LENGTH: for the medium, by either. END: for the end of the
 * ray. PIECE: for light left out inside a piece, at most 64 times (spans or halvings), each counted
 * twice. */
#define MEDIUM_SHARE_OPACITY 0.5
#define MEDIUM_SHARE_LENGTH  0.3
#define MEDIUM_SHARE_END     0.1
#define MEDIUM_SHARE_PIECE   (0.04 / 128.0)

/* Share that is always allowed for a stretch beside a cut of overlaid media. */
#define MEDIUM_SHARE_CUT 0x1p-18

/* frame.look */
typedef struct medium_look {
    surface_look surfaces;    /* must be first: the surfaces' code uses it as frame.look */
    const transfer *media;    /* one for each volume; without spans: no medium there */
    const double (*range)[2]; /* one for each volume: its values lie in it */
    int filled;               /* number of filled volumes, */
    uint16_t filled_by[LEAFCAST_MEDIA_MAX]; /* and these, in order */
    double error;                           /* the most that a channel may be off */
    double brightest; /* the largest component of any medium's colour, surface's, light's, ... */
    /* Shades colours; then no pixel is certified. NULL: colours are not shaded. */
    const medium_shade *shade;
    /* Walk ray by ray, and lay pieces of all volumes over each other. Set if several volumes are
     * filled, or one is shaded and its pieces may come after their treelet was evicted. */
    bool overlaid;
    bool unbounded; /* preview: what is drawn may be off by anything */
} medium_look;

#endif
