/* certificate.h - check the error bounds of a picture of media: draw it again with half the bound
 * and compare. Each picture has a bound for every pixel, so two channels may differ by at most the
 * sum of both.
 */
#ifndef RENDER_APP_CERTIFICATE_H
#define RENDER_APP_CERTIFICATE_H

#include "formats/base/mem.h"
#include "formats/base/status.h"
#include "render/app/view_options.h"

typedef struct certificate {
    bool made;
    double difference; /* largest difference of any channel */
    double
        of_bounds; /* largest difference divided by the sum of the two bounds; 0 for equal pixels */
    uint64_t outside; /* pixels with a channel that differs by more than the sum of both bounds */
} certificate;

/* certificate_compare() - compare two pictures of `pixels` pixels, by their planes rgba and error,
 * without gaps. */
certificate certificate_compare(const leafcast_image *a, const leafcast_image *b, size_t pixels);

/* certificate_make() - draw the picture again with half its bound, from all data at full
 * resolution, and compare. The picture needs planes rgba and error; m allocates those of the
 * second. Returns ST_FAILED where the bound does not hold, or an error of drawing.
 */
CHECKED status certificate_make(leafcast *volume, const leafcast_scene *scene,
                                const leafcast_camera *camera, const leafcast_image *image, mem *m,
                                certificate *out);

/* certificate_lacks() - returns why pixels of a picture with these flags are uncertified, as
 * text. */
const char *certificate_lacks(const view_options *view);

#endif
