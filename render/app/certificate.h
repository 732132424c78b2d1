/* certificate.h - a picture of media held against the exact one drawn with half the bound: each has
 * a bound of its own for every pixel, so two channels may differ by no more than both bounds.
 */
#ifndef RENDER_APP_CERTIFICATE_H
#define RENDER_APP_CERTIFICATE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/view_options.h"

typedef struct certificate {
    bool made;
    double difference; /* of any channel, the largest; */
    double of_bounds;  /* and the largest as a share of the two bounds, 0 where it is 0 */
    uint64_t outside;  /* pixels of which a channel differs by more than both bounds */
} certificate;

/* certificate_compare() - two pictures of so many pixels: planes rgba and error, without gaps. */
certificate certificate_compare(const leafcast_image *a, const leafcast_image *b, size_t pixels);

/* certificate_make() - draw the picture, which has planes rgba and error, again with half its
 * bound and of all data at full resolution, and compare. ST_FAILED where it does not hold, and what
 * drawing returns. m: of the planes.
 */
CHECKED status certificate_make(leafcast *volume, const leafcast_scene *scene,
                                const leafcast_camera *camera, const leafcast_image *image, mem *m,
                                certificate *out);

/* certificate_lacks() - why pixels of such a picture are uncertified. */
const char *certificate_lacks(const view_options *view);

#endif
