/* point_samples.h - a volume's samples at many points: behind leafcast_sample_points() and
 * leafcast_sample_slice().
 *
 * Points wait in lists, one per treelet. A point starts in the list of the first treelet that may
 * hold it (kind.treelet_at). Treelets with points are loaded in their order, as many at a time as
 * the budget has slots for. All threads sample the points of treelets that have come, while further
 * treelets are read. A point that its treelet does not hold moves to the list of its next treelet,
 * which comes later. So treelets without points are not read, and the others once. Two exceptions:
 * a point may come to a treelet that is already evicted; and without room for all points at a time,
 * they are taken in chunks. The sample depends on the point alone.
 */
#ifndef RENDER_DOOR_POINT_SAMPLES_H
#define RENDER_DOOR_POINT_SAMPLES_H

#include "render/door/leafcast_volume.h"

typedef struct point_samples {
    leafcast *volume;
    uint32_t set;   /* a field at a step */
    uint32_t level; /* level of detail */
    size_t count;
    /* point(): give the i-th point; any thread may call it, more than once. found(): take the
     * sample there (inside: false outside of the data); any thread, once per point. */
    void (*point)(const void *ctx, size_t i, double point[3]);
    void (*found)(void *ctx, size_t i, const double point[3], const leafcast_sample *sample);
    void *ctx;
    size_t beside; /* bytes of the budget that the caller uses */
    /* As of leafcast_trace(); or NULL. */
    bool (*watch)(void *ctx, double done);
    void *watch_ctx;
} point_samples;

/* point_samples_run() - sample all points. Needs the device's lock. stats: as in
 * leafcast_sample_slice(); may be NULL. ST_NOMEM names the smallest budget that would do. */
CHECKED status point_samples_run(const point_samples *p, leafcast_stats *stats);

#endif
