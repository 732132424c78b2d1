/* camera.h - pixels to rays in world space.
 *
 * Right-handed; `fov` is vertical; pixel (i, j) has its centre at (i + 0.5, j + 0.5), y down from
 * the top left corner. Everything is double, and nothing but + - * / sqrt is used (the tangent too
 * is our own), so that a pixel has the same ray on every CPU.
 */
#ifndef RENDER_LOOK_CAMERA_H
#define RENDER_LOOK_CAMERA_H

#include "formats/base/status.h"
#include "render/leafcast.h"
#include "render/ray/ray_bundle.h"

/* A leafcast_camera made ready: d(x, y) = forward + ((2x - middle x) / height) right + ((middle y -
 * 2y) / height) up. */
typedef struct camera {
    double eye[3];
    double forward[3];      /* unit length */
    double right[3], up[3]; /* as long as half the height of the picture at distance 1 */
    double width, height;   /* pixels of the whole picture */
    double window[2];       /* its pixel that counts as (0, 0) */
    double middle[2];       /* twice the pixel that `forward` goes through: width, height, unless
                               camera_window() and camera_shift() say otherwise */
    bool ortho; /* rays are parallel; right and up are then half the height of the picture
                   in world units */
} camera;

/* The index of a pixel fits 32 bits, signed or not. */
enum { CAMERA_PIXELS_MAX = INT32_MAX };

/* camera_init() - ST_USAGE when there is no such camera: numbers that are not finite, no or too
 * many pixels, fov outside (0, 180), nothing between eye and look_at, `up` along the view. */
CHECKED status camera_init(camera *c, const leafcast_camera *from);

/* camera_window() - pixels are counted from (x, y) on; the same rays, to the bit. camera_shift() -
 * from now on, rays go through what is (x + dx, y + dy) there; at most half a pixel. */
void camera_window(camera *c, uint32_t x, uint32_t y);
void camera_shift(camera *c, double dx, double dy);

/* camera_ray() - the ray through (x, y), in pixels: from the eye, or the plane through it; unit
 * direction; no component is -0. */
void camera_ray(const camera *c, double x, double y, double origin[3], double direction[3]);

/* camera_bundle() - all rays of the camera. */
ray_bundle camera_bundle(const camera *c);

/* camera_pixel() - the width of a pixel at a distance from the eye, in the middle of the picture:
 * what --lod pixel goes by. */
double camera_pixel(const camera *c, double distance);

/* camera_fit() - the nearest place from which all corners of a box are in the picture, looking at
 * its middle. corners: as bits of the index say, along the box's axes 0, 1, 2, in world space.
 * Up is +z, unless the box is more than twice as long along z as along x and y: then it is laid
 * down, and up is the longer one of these. The longer of the two other axes lies across, left to
 * right; the eye is a little to the side of the third, and above: see camera.c. */
leafcast_camera camera_fit(const double corners[8][3], double fov, uint32_t width, uint32_t height);

/* camera_standard() - fov 45, up +z, from `distance` times the longest edge of the box in the
 * direction (1, 0.6, 0.8) of its centre. bounds: minimum and maximum in world space. */
leafcast_camera camera_standard(const double bounds[2][3], double distance, uint32_t width,
                                uint32_t height);

#endif
