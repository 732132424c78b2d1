/* projection.h - where the planes between cells lie in a camera's picture.
 *
 * Homogeneous pixel coordinates are linear in each grid coordinate: a point's are the sum of three
 * entries, one a plane through it and axis. So the corners of any box of cells cost a few additions
 * each. All is relative to the eye, taken in double and then rounded to float: errors stay a tiny
 * part of a pixel however far from the origin, or the eye from the volume.
 *
 * Of a grid all planes between cells have their entries. A mesh has planes of its own for every
 * box; theirs are products of `axis` and the distance from the eye.
 */
#ifndef RENDER_LOOK_PROJECTION_H
#define RENDER_LOOK_PROJECTION_H

#include "formats/base/mem.h"
#include "formats/leaf/leaf.h"
#include "render/look/camera.h"
#include "render/ray/affine.h"

/* What a plane adds: pixels right of where the camera looks, below it, and depth are x / w, y / w,
 * w; all w scaled alike. far bounds the share of any of the point's distance that is due to this
 * axis.
 */
typedef struct plane_projection {
    float x, y, w, far;
    float from_eye,
        inverse;     /* the plane itself and 1 / the width of the cell behind it; grid space */
    float unused[2]; /* two to a cache line */
} plane_projection;

typedef struct projection {
    const plane_projection *at[LEAF_LEVELS_MAX][3]; /* of a grid */
    float axis[3][4]; /* of a mesh, world space: x, y, w, far of a plane at 1 from the eye */
    bool usable;      /* false: numbers beyond float; nothing else is set then */
    double eye[3];    /* grid space */
    float centre[2];  /* where the camera looks: pixels from the picture's left and top edge */
    /* x / w of a corner is right to margin pixels within the picture, where w is at least
     * depth_share of the sum of its far; beyond the picture it does not come in. */
    float margin;
    float margin_least; /* the part of it that depth has no share in: the rest goes with far / w */
    /* |error| of x - c w for a constant c of at most half the picture's size, over the sum of far.
     */
    float plane_error;
    double scale, unscale; /* the power of two that brings the grid's directions to ordinary size;
                              1 / it */
    plane_projection *block;
    mem *m;
} projection;

static const float projection_depth_share = 1.0f / 16.0f;

void projection_release(projection *p);

/* ---- For kinds: grid/grid_projection.h, mesh/mesh_projection.h ---- */

/* What a step of one along a grid axis adds. */
typedef struct axis_projection {
    double x, y, w, far;
} axis_projection;

axis_projection projection_axis(const affine *space, const camera *c, int a);

/* projection_scale() - the power of two that brings vectors in grid space to ordinary size. */
double projection_scale(const affine *space);

/* projection_set_bounds() - margin, plane_error and usable. worst: the largest of what entries add
 * up to; rounded: how many roundings an entry has. */
void projection_set_bounds(projection *p, const camera *c, double worst, double rounded);

#endif
