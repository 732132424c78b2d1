/* point_samples.h - what a volume is at many points: behind leafcast_sample_points() and
 * leafcast_sample_slice().
 *
 * Points wait in lists, one a treelet: each in that of the first treelet that may hold it
 * (kind.treelet_at). The treelets with points are brought in in their order, as many at a time as
 * the budget has slots for; all points that wait for those that have come are sampled by all
 * threads, while further ones are read. A point that is not in its treelet goes on to the list of
 * its next one, which lies behind. So treelets without points are not read, and those with points
 * once, but where a point comes to a treelet that has given way already, or where there is not room
 * for all points at a time: they are taken in chunks then. What is found depends on the point
 * alone.
 */
#ifndef RENDER_DOOR_POINT_SAMPLES_H
#define RENDER_DOOR_POINT_SAMPLES_H

#include "render/door/leafcast_volume.h"

typedef struct point_samples {
    leafcast *volume;
    uint32_t set;   /* of values: a field at a step */
    uint32_t level; /* of detail */
    size_t count;
    /* The i-th point, and what is there (inside: false, where nothing is); by any thread, each
     * once. */
    void (*point)(const void *ctx, size_t i, double point[3]);
    void (*found)(void *ctx, size_t i, const double point[3], const leafcast_sample *sample);
    void *ctx;
    size_t beside; /* bytes of the budget that are the caller's */
    /* As of leafcast_trace(); or NULL. */
    bool (*watch)(void *ctx, double done);
    void *watch_ctx;
} point_samples;

/* point_samples_run() - with the device's lock held. stats: NULL, or what leafcast_sample_slice()
 * says of it. ST_NOMEM names the smallest budget that would do. */
CHECKED status point_samples_run(const point_samples *p, leafcast_stats *stats);

#endif
