/* view_planes.h - the planes of a picture being drawn, which are shown before they are complete. */
#ifndef RENDER_VIEW_VIEW_PLANES_H
#define RENDER_VIEW_VIEW_PLANES_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/leafcast.h"

/* A picture's planes, and their size. */
typedef struct view_planes {
    uint32_t width, height;
    leafcast_image image;
} view_planes;

/* view_planes_make() - make the planes that are not NULL in `wanted`, with all pixels provisional.
 * ST_NOMEM. view_planes_release() - free them; all zeros are allowed. view_planes_bytes() - returns
 * their bytes. */
CHECKED status view_planes_make(mem *m, const leafcast_image *wanted, uint32_t width,
                                uint32_t height, view_planes *out);
void view_planes_release(mem *m, view_planes *p);
uint64_t view_planes_bytes(const view_planes *p);

/* view_planes_enlarge() - fill the planes with an enlarged preview, for pixels that are not drawn
 * yet. view_planes_blank() - mark all pixels as not drawn, by NaN in the red plane.
 * view_planes_share() - returns the share of pixels that are drawn since. view_planes_provisional()
 * - returns how many pixels are provisional. */
void view_planes_enlarge(const view_planes *from, view_planes *to);
void view_planes_blank(const view_planes *of);
double view_planes_share(const view_planes *of);
uint64_t view_planes_provisional(const view_planes *of);

#endif
