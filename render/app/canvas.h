/* canvas.h - marks over a picture's planes: what legends and annotations are drawn with.
 */
#ifndef RENDER_APP_CANVAS_H
#define RENDER_APP_CANVAS_H

#include <stdint.h>

#include "render/leafcast.h"

/* The planes r, g, b and a of an image, as far as there are any, `width` values a row. */
typedef struct canvas {
    const leafcast_image *image;
    long width, height;
} canvas;

/* A rectangle of pixels, right and lower edge excluded. */
typedef struct canvas_box {
    long x0, y0, x1, y1;
} canvas_box;

/* canvas_put() - a colour (linear) over a pixel, opacity 0 to 1; outside of the canvas nothing
 * is. canvas_fill() - over a rectangle. */
void canvas_put(const canvas *c, long x, long y, const float rgb[3], float opacity);
void canvas_fill(const canvas *c, canvas_box box, const float rgb[3], float opacity);

/* A straight line; ends are pixels' coordinates, centres at +0.5. */
typedef struct canvas_line {
    double from[2], to[2];
    double width; /* pixels */
    float rgb[3], opacity;
    /* Whether a share of the way, 0 to 1, is to be seen at a pixel; NULL: all. */
    bool (*seen)(const void *ctx, double share, long x, long y);
    const void *ctx;
} canvas_line;

/* canvas_draw_line() - with smooth edges: a pixel takes as much of the colour as the line's width
 * covers of it across. */
void canvas_draw_line(const canvas *c, const canvas_line *line);

#endif
