#include "render/app/lost_marks.h"

static void mix(float *plane, size_t pixel, float mark) {
    if (plane)
        plane[pixel] = 0.5F * (plane[pixel] + mark);
}

void lost_marks_draw(leafcast_image *image, size_t pixels) {
    for (size_t i = 0; i < pixels; i++) {
        if (!image->provisional[i])
            continue;
        mix(image->r, i, 1.0F);
        mix(image->g, i, 0.0F);
        mix(image->b, i, 1.0F);
        mix(image->a, i, 1.0F);
    }
}
