#include "render/app/certificate.h"

#include <math.h>

static const double WHOLE = 1.0 / 510.0, LEAST = 1e-9; /* bounds: default, least allowed */

/* Returns the larger value; NaN counts as the largest. */
static double worse(double a, double b) {
    return isnan(a) || a >= b ? a : b;
}

certificate certificate_compare(const leafcast_image *a, const leafcast_image *b, size_t pixels) {
    certificate made = {.made = true};
    for (size_t i = 0; i < pixels; i++) {
        const double bounds = a->error[i] + b->error[i];
        double most = 0.0;
        for (size_t c = 4 * i; c < 4 * i + 4; c++)
            most = worse(most, fabs(a->rgba[c] - b->rgba[c]));
        made.difference = worse(made.difference, most);
        if (most > 0.0)
            made.of_bounds = fmax(made.of_bounds, most / bounds);
        made.outside += !(most <= bounds);
    }
    return made;
}

/* Returns the scene with half the bound, without previews or levels of detail: bounds are about all
 * data at full resolution. */
static leafcast_scene halved(const leafcast_scene *scene) {
    leafcast_scene half = *scene;
    half.lod = LEAFCAST_LOD_EXACT;
    half.preview = false;
    half.error = fmax(0.5 * (scene->error > 0.0 ? scene->error : WHOLE), LEAST);
    return half;
}

status certificate_make(leafcast *volume, const leafcast_scene *scene,
                        const leafcast_camera *camera, const leafcast_image *image, mem *m,
                        certificate *out) {
    const size_t pixels = (size_t)camera->width * camera->height;
    const leafcast_scene half = halved(scene);
    leafcast_image again = {.size = sizeof again,
                            .rgba = mem_array(m, 4 * pixels, sizeof *again.rgba),
                            .error = mem_array(m, pixels, sizeof *again.error)};
    status st = again.rgba && again.error ? ST_OK : ST_NOMEM;
    if (st == ST_OK)
        st = (status)leafcast_trace(volume, &half, camera, &again, NULL, NULL, NULL);
    if (st == ST_OK)
        *out = certificate_compare(image, &again, pixels);
    mem_free(m, again.rgba);
    mem_free(m, again.error);
    if (st == ST_OK && out->outside > 0)
        st = status_describe(ST_FAILED,
                             "the bound does not hold: drawn again with half of it, %llu pixels "
                             "differ by more than both bounds",
                             (unsigned long long)out->outside);
    return st;
}

const char *certificate_lacks(const view_options *view) {
    if (view->scene.shade_media)
        return "the medium is shaded: not certified";
    if (view->experiments.summing != LEAFCAST_CERTIFIED)
        return "nobody knows the error of steps";
    if (view->scene.lod != LEAFCAST_LOD_EXACT)
        return "nobody knows how far levels of detail are from the data";
    return "rounding alone may";
}
