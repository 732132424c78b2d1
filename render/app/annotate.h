/* annotate.h - what tells a picture's reader where he is: the volume's box with its edges' values,
 * a scale bar, a title.
 */
#ifndef RENDER_APP_ANNOTATE_H
#define RENDER_APP_ANNOTATE_H

#include "formats/base/status.h"
#include "render/app/text_face.h"

enum { ANNOTATE_BOX = 1, ANNOTATE_AXES = 2, ANNOTATE_SCALE = 4, ANNOTATE_ALL = 7 };
enum { ANNOTATE_TEXT_MAX = 256, ANNOTATE_UNIT_MAX = 32 };

typedef struct annotation {
    unsigned parts;                /* ANNOTATE_..., together */
    char title[ANNOTATE_TEXT_MAX]; /* ""; or a line above the picture */
    char unit[ANNOTATE_UNIT_MAX];  /* of world space, behind lengths; "": none is named */
    leafcast_axes axes;            /* names the ends of the axes: "x, R to L" */
} annotation;

/* annotate_parts() - of --annotate: NULL (all), or names out of box, axes, scale, divided by
 * commas. */
CHECKED status annotate_parts(const char *text, unsigned *parts);

/* annotate_wanted() - whether there is anything to draw. */
static inline bool annotate_wanted(const annotation *a) {
    return a->parts != 0 || a->title[0];
}

/* annotate_draw() - over the planes r, g, b and a of a picture that a camera has taken of a volume
 * with these bounds (world space, minimum and maximum); image->z, where it is, hides what is behind
 * surfaces. light: the background is, so that marks are dark.
 *
 *   box    its edges; those behind it are faint.
 *   axes   values along one edge an axis that is an outline of the box, and the axis' name.
 *   scale  a bar of a round length. Of perspective pictures it holds in the plane through look_at
 *          across the way there. */
void annotate_draw(const leafcast_image *image, const leafcast_camera *view,
                   const double bounds[2][3], const annotation *a, bool light, text_face *face);

/* annotate_round() - the largest of 1, 2, 5 times a power of ten that is at most `length` > 0. */
double annotate_round(double length);

#endif
