/* medium_look.h - what is to be seen of media, and how the error of a pixel is shared out.
 *
 * Parts are for the medium, by its opacity and by its length, and a part is for the end. A ray ends
 * when nothing of more weight can follow. The light of surfaces counts as exact. Shadows through
 * media are not drawn.
 */
#ifndef RENDER_MEDIUM_MEDIUM_LOOK_H
#define RENDER_MEDIUM_MEDIUM_LOOK_H

#include "render/look/transfer.h"
#include "render/medium/medium_shade.h"
#include "render/surface/surface_integrator.h"

/* Shares of the pixel's error: for the medium by its opacity, by its length, for the end, for light
 * left out inside a piece, which happens behind at most 64 spans or halvings and counts twice. */
#define MEDIUM_SHARE_OPACITY 0.5
#define MEDIUM_SHARE_LENGTH  0.3
#define MEDIUM_SHARE_END     0.1
#define MEDIUM_SHARE_PIECE   (0.04 / 128.0)

/* And beside a cut of overlaid media. */
#define MEDIUM_SHARE_CUT 0x1p-18

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

#endif
