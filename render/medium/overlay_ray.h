/* overlay_ray.h - one ray's pieces through several volumes, laid over each other. They are cut into
 * stretches that lie within one piece of each volume (medium_overlay.h).
 *
 * The pieces come one by one, by each kind's scalar code (segments.h). Resumable where a treelet is
 * absent in any volume. Gives the same stretches, whatever was resident when.
 */
#ifndef RENDER_MEDIUM_OVERLAY_RAY_H
#define RENDER_MEDIUM_OVERLAY_RAY_H

#include "render/frame/frame.h"
#include "render/ray/segments.h"
#include "render/surface/surface_search.h"

enum { OVERLAY_AHEAD = 8 }; /* pieces; more take more memory, but less time */

/* One volume on the ray's way. May be copied. */
typedef struct overlay_lane {
    uint16_t volume;
    bool in_piece, ended; /* `piece` is the current one; there are no more pieces */
    uint32_t stretches;   /* number of stretches given so far; of the first lane */
    segment piece;
    segments_error error; /* of its pieces; set by the caller */
    segments_state walk;
    segment ahead[OVERLAY_AHEAD];
} overlay_lane;

/* A stretch, and the lanes that have a piece there. */
typedef struct overlay_stretch {
    double t0, t1;
    int count;
    const overlay_lane *lane[LEAFCAST_MEDIA_MAX];
} overlay_stretch;

/* overlay_begin() - set the lanes to a ray's start. The caller sets volume and error. */
void overlay_begin(overlay_lane lanes[], int count);

/* overlay_next() - set *out to the next stretch from t = *from on, and *from to its end.
 * SEGMENTS_BLOCKED: lane *blocked needs the absent treelet walk.blocked. SEGMENTS_END: there are no
 * more, or the frame shall end; that is checked now and then, since a stretch may take long. */
segments_result overlay_next(const frame *f, const world_ray *w, overlay_lane lanes[], int count,
                             double *from, overlay_stretch *out, int *blocked,
                             ray_counters *counters);

#endif
