/* camera.h - pixels to rays in world space.
 *
 * Right-handed; `fov` is vertical; pixel (i, j) has its centre at (i + 0.5, j + 0.5), y down from
 * the top left corner. Everything is double, and only + - * / sqrt are used, also for the tangent.
 * So a pixel has the same ray on every CPU.
 */
#ifndef RENDER_LOOK_CAMERA_H
#define RENDER_LOOK_CAMERA_H

#include "formats/base/status.h"
#include "render/leafcast.h"
#include "render/ray/ray_bundle.h"

/* A leafcast_camera, prepared for making rays. The direction of pixel (x, y) is forward + ((2x -
 * middle x) / height) right + ((middle y - 2y) / height) up. */
typedef struct camera {
    double eye[3];
    double forward[3];      /* unit length */
    double right[3], up[3]; /* as long as half the height of the picture at distance 1 */
    double width, height;   /* pixels of the whole picture */
    double window[2];       /* the pixel of the picture that counts as (0, 0) */
    double middle[2];       /* twice the pixel that `forward` goes through: width, height, unless
                               camera_window() and camera_shift() say otherwise */
    bool ortho; /* rays are parallel; right and up are then half the height of the picture
                   in world units */
} camera;

/* The index of a pixel fits 32 bits, signed or not. */
enum { CAMERA_PIXELS_MAX = INT32_MAX };

/* camera_init() - prepare a camera. ST_USAGE for numbers that are not finite, no or too many
 * pixels, fov outside (0, 180), eye and look_at at one point, or `up` along the view. */
CHECKED status camera_init(camera *c, const leafcast_camera *from);

/* camera_window() - from now on, count pixels from (x, y) on; rays stay the same, to the bit.
 * camera_shift() - move all later rays by (dx, dy) pixels, at most half a pixel each. */
void camera_window(camera *c, uint32_t x, uint32_t y);
void camera_shift(camera *c, double dx, double dy);

/* camera_ray() - the ray through (x, y), in pixels. It starts at the eye, or on the plane through
 * the eye if parallel; its direction has unit length, and no component is -0. */
void camera_ray(const camera *c, double x, double y, double origin[3], double direction[3]);

/* camera_bundle() - the bundle of all rays of the camera. */
ray_bundle camera_bundle(const camera *c);

/* camera_pixel() - the world width of a pixel at a distance from the eye, in the middle of the
 * picture; for --lod pixel. */
double camera_pixel(const camera *c, double distance);

/* camera_fit() - returns a camera that looks at the middle of a box, from the nearest place from
 * which all corners are in the picture. corners: in world space, bit a of the index says which end
 * of axis a. Up is +z, unless the box is more than twice as long along z as along x and y: then up
 * is the longer of x and y. The longer of the two other axes goes from left to right. The eye
 * looks along the third axis, a little from above and from the side: see camera.c. */
leafcast_camera camera_fit(const double corners[8][3], double fov, uint32_t width, uint32_t height);

/* camera_standard() - fov 45, up +z, looking at the box's centre from the direction (1, 0.6, 0.8),
 * at `distance` times its longest edge. bounds: minimum and maximum in world space. */
leafcast_camera camera_standard(const double bounds[2][3], double distance, uint32_t width,
                                uint32_t height);

#endif
