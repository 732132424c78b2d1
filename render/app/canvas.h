/* canvas.h - draw pixels, rectangles and lines over a picture's planes, for legends and
 * annotations.
 */
#ifndef RENDER_APP_CANVAS_H
#define RENDER_APP_CANVAS_H

#include <stdint.h>

#include "render/leafcast.h"

/* The planes r, g, b and a of an image, `width` values a row; planes that are NULL are skipped. */
typedef struct canvas {
    const leafcast_image *image;
    long width, height;
} canvas;

/* A rectangle of pixels, right and lower edge excluded. */
typedef struct canvas_box {
    long x0, y0, x1, y1;
} canvas_box;

/* canvas_put() - blend a linear colour over one pixel, opacity 0 to 1. Pixels outside of the canvas
 * are ignored. canvas_fill() - the same for a rectangle. */
void canvas_put(const canvas *c, long x, long y, const float rgb[3], float opacity);
void canvas_fill(const canvas *c, canvas_box box, const float rgb[3], float opacity);

/* A straight line between two points in pixel coordinates; a pixel's centre is at +0.5. */
typedef struct canvas_line {
    double from[2], to[2];
    double width; /* pixels */
    float rgb[3], opacity;
    /* Returns whether the line is visible at a pixel, at this share of its length (0 to 1). NULL:
     * everywhere. */
    bool (*seen)(const void *ctx, double share, long x, long y);
    const void *ctx;
} canvas_line;

/* canvas_draw_line() - draw a line with smooth edges: a pixel is blended by the share of it that
 * the line's width covers. */
void canvas_draw_line(const canvas *c, const canvas_line *line);

#endif
