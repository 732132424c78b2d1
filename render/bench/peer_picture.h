/* peer_picture.h - two pictures of the same surface: how far apart they are, and side by side. */
#ifndef RENDER_BENCH_PEER_PICTURE_H
#define RENDER_BENCH_PEER_PICTURE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"

typedef struct peer_difference {
    uint64_t both, only_ours, only_peer; /* pixels where a surface was hit */
    double median, p99, worst;           /* of |distance - distance| where both did, in cells */
    double colour;                       /* root mean square there, over r, g and b */
    uint64_t far;                        /* pixels there with a channel more than 0.1 apart */
} peer_difference;

/* peer_picture_compare() - pictures of count pixels with r, g, b and z; cell: world length of a
 * cell. */
CHECKED status peer_picture_compare(mem *m, const leafcast_image *ours, const leafcast_image *peer,
                                    size_t count, double cell, peer_difference *out);

/* peer_picture_write() - one picture of both and of their distances' difference: ours, the peer's,
 * |difference| from black (1e-4 cells and less) over blue, red and yellow to white (a cell and
 * more); green where only one of them hit. */
CHECKED status peer_picture_write(mem *m, const char *path, bool force, uint32_t width,
                                  uint32_t height, const leafcast_image *ours,
                                  const leafcast_image *peer, double cell);

#endif
