/* overlay_ray.h - one ray's pieces through several volumes, laid over each other: stretches on
 * which it keeps to one piece of each (medium_overlay.h).
 *
 * The pieces come one by one, by the truth of each kind (segments.h). Resumable where a treelet is
 * absent in any volume; the same stretches, whatever was resident when.
 */
#ifndef RENDER_MEDIUM_OVERLAY_RAY_H
#define RENDER_MEDIUM_OVERLAY_RAY_H

#include "render/frame/frame.h"
#include "render/ray/segments.h"
#include "render/surface/surface_search.h"

enum { OVERLAY_AHEAD = 8 }; /* pieces: more takes memory, less time */

/* A volume on the way. May be copied. */
typedef struct overlay_lane {
    uint16_t volume;
    bool in_piece, ended; /* a piece has been reached; there are no more */
    uint32_t stretches;   /* of the first lane: so many have been given */
    segment piece;
    segments_error error; /* of its pieces: the caller's */
    segments_state walk;
    segment ahead[OVERLAY_AHEAD];
} overlay_lane;

/* A stretch, and the lanes that have something there. */
typedef struct overlay_stretch {
    double t0, t1;
    int count;
    const overlay_lane *lane[FRAME_VOLUMES_MAX];
} overlay_stretch;

/* overlay_begin() - lanes from the start of a ray on; volume and error are the caller's. */
void overlay_begin(overlay_lane lanes[], int count);

/* overlay_next() - the next stretch from t = *from on, which becomes its end. SEGMENTS_BLOCKED:
 * lane *blocked has missed the treelet walk.blocked. SEGMENTS_END: there are none, or the frame
 * shall end, which is asked for now and then: a stretch may take long. */
segments_result overlay_next(const frame *f, const world_ray *w, overlay_lane lanes[], int count,
                             double *from, overlay_stretch *out, int *blocked,
                             ray_counters *counters);

#endif
