/* annotate.h - draw marks into a picture that show position and size: the volume's box, values
 * along its edges, a scale bar, a title.
 */
#ifndef RENDER_APP_ANNOTATE_H
#define RENDER_APP_ANNOTATE_H

#include "formats/base/status.h"
#include "render/app/text_face.h"

enum { ANNOTATE_BOX = 1, ANNOTATE_AXES = 2, ANNOTATE_SCALE = 4, ANNOTATE_ALL = 7 };
enum { ANNOTATE_TEXT_MAX = 256, ANNOTATE_UNIT_MAX = 32 };

typedef struct annotation {
    unsigned parts;                /* the ANNOTATE_... flags to draw */
    char title[ANNOTATE_TEXT_MAX]; /* a line at the top of the picture; "": none */
    char unit[ANNOTATE_UNIT_MAX];  /* unit of world space, written behind lengths; "": none */
    leafcast_axes axes;            /* says what the axes' ends are called: "x, R to L" */
} annotation;

/* annotate_parts() - read the value of --annotate: NULL (all), or names out of box, axes, scale,
 * separated by commas. */
CHECKED status annotate_parts(const char *text, unsigned *parts);

/* annotate_wanted() - returns whether there is anything to draw. */
static inline bool annotate_wanted(const annotation *a) {
    return a->parts != 0 || a->title[0];
}

/* annotate_draw() - draw over the planes r, g, b and a of a picture.
 * The camera has taken it of a volume with these bounds (world space, minimum and maximum). Where
 * image->z is given, surfaces hide the lines of the box behind them. light: the background is
 * light, so marks are dark.
 *
 *   box    the box's edges; those on its far side are faint.
 *   axes   per axis: values along one edge on the outline of the box, and the axis' name.
 *   scale  a bar of a round length. In perspective pictures it is valid in the plane through
 *          look_at that is perpendicular to the line of sight. */
void annotate_draw(const leafcast_image *image, const leafcast_camera *view,
                   const double bounds[2][3], const annotation *a, bool light, text_face *face);

/* annotate_round() - returns the largest length of 1, 2 or 5 times a power of ten that is at most
 * `length` > 0. */
double annotate_round(double length);

#endif
