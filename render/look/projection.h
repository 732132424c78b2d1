/* projection.h - where the planes between cells lie in a camera's picture.
 *
 * Homogeneous pixel coordinates are linear in each grid coordinate. So the coordinates of a point
 * are a sum of three entries: one per axis, for the plane across that axis through the point. The
 * corners of a box of cells cost a few additions each. All entries are relative to the eye,
 * computed in double and then rounded to float. So errors stay a tiny part of a pixel, however far
 * the eye or the volume is from the origin.
 *
 * Grids have entries for all planes between cells. Every box of other kinds has planes of its own;
 * their entries are products of `axis` and the distance from the eye.
 */
#ifndef RENDER_LOOK_PROJECTION_H
#define RENDER_LOOK_PROJECTION_H

#include "formats/base/mem.h"
#include "formats/leaf/leaf.h"
#include "render/look/camera.h"
#include "render/ray/affine.h"

/* What a plane adds to the coordinates of the points on it: pixels right of the picture's centre (x
 * / w), below it (y / w), and depth w; all w are scaled alike. far: a bound of what the axis adds
 * to a point's distance from the eye.
 */
typedef struct plane_projection {
    float x, y, w, far;
    float from_eye, inverse; /* the plane, and 1 / the width of the cell behind it; in grid space */
    float unused[2];         /* makes two fill a cache line */
} plane_projection;

typedef struct projection {
    const plane_projection *at[LEAF_LEVELS_MAX][3]; /* for a grid */
    float axis[3][4]; /* for boxes, world space: x, y, w, far of a plane at 1 from the eye */
    bool usable;      /* false: numbers exceed float; then nothing else is set */
    double eye[3];    /* grid space */
    float centre[2];  /* where the camera looks: pixels from the picture's left and top edge */
    /* Bound of the error of a corner's x / w, in pixels, for corners within the picture whose w is
     * at least projection_depth_share of the sum of their `far`. Corners beyond the picture stay
     * beyond it. */
    float margin;
    float margin_least; /* the part of margin that does not depend on depth; the rest scales with
                           far / w */
    /* plane_error times the sum of `far` bounds the error of x - c w, for a constant c up to half
     * the picture's size.
     */
    float plane_error;
    double scale,
        unscale; /* power of two that brings directions in the grid to ordinary size; 1 / it */
    plane_projection *block;
    mem *m;
} projection;

static const float projection_depth_share = 1.0f / 16.0f;

void projection_release(projection *p);

/* ---- For grid/grid_projection.h, box_projection.h ---- */

/* What one unit along a grid axis adds to homogeneous pixel coordinates. */
typedef struct axis_projection {
    double x, y, w, far;
} axis_projection;

axis_projection projection_axis(const affine *space, const camera *c, int a);

/* projection_scale() - the power of two that brings vectors in grid space to ordinary size. */
double projection_scale(const affine *space);

/* projection_set_bounds() - set margin, plane_error and usable. worst: the largest sum of entries;
 * rounded: how many roundings an entry has. */
void projection_set_bounds(projection *p, const camera *c, double worst, double rounded);

#endif
