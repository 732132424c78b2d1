#include "render/look/camera.h"

#include <math.h>
#include <string.h>

#include "formats/base/vec3.h"

static const double PI = 3.14159265358979323846;

/* tan x for x in (0, pi/2), by the Taylor series of sine and cosine, small terms first. Within
 * 1e-15 of the true value below 1.5, and the same bits everywhere, which libm does not promise. */
static double tangent(double x) {
    const double s = x * x;
    double sine = 0.0, cosine = 0.0;
    for (int n = 24; n > 0; n -= 2) {
        sine = (1.0 - sine) * s / (n * (n + 1));
        cosine = (1.0 - cosine) * s / (n * (n - 1));
    }
    return x * (1.0 - sine) / (1.0 - cosine);
}

static bool all_finite(const double v[3]) {
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

static status check(const leafcast_camera *from) {
    if (from->width == 0 || from->height == 0)
        return status_describe(ST_USAGE, "a picture of %u x %u pixels", from->width, from->height);
    if ((uint64_t)from->width * from->height > CAMERA_PIXELS_MAX)
        return status_describe(ST_USAGE, "a picture of %u x %u pixels: more than %d", from->width,
                               from->height, CAMERA_PIXELS_MAX);
    if (!all_finite(from->eye) || !all_finite(from->look_at) || !all_finite(from->up))
        return status_describe(ST_USAGE, "the camera's eye, look-at and up must be finite");
    if (!(from->ortho_height >= 0.0 && from->ortho_height < INFINITY))
        return status_describe(ST_USAGE, "an orthographic picture %g high", from->ortho_height);
    if (from->ortho_height == 0.0 && !(from->fov > 0.0 && from->fov < 180.0))
        return status_describe(ST_USAGE, "a field of view of %g degrees is not between 0 and 180",
                               from->fov);
    return ST_OK;
}

status camera_init(camera *c, const leafcast_camera *from) {
    status st = check(from);
    if (st)
        return st;
    double up[3];
    memcpy(c->eye, from->eye, sizeof c->eye);
    vec3_sub(from->look_at, from->eye, c->forward);
    if (!vec3_unit(c->forward, c->forward))
        return status_describe(ST_USAGE, "the camera's eye and look-at are the same point");
    if (!vec3_unit(from->up, up))
        return status_describe(ST_USAGE, "the camera's up has no direction");
    vec3_cross(c->forward, up, c->right);
    if (!(vec3_dot(c->right, c->right) > 1e-24) || !vec3_unit(c->right, c->right))
        return status_describe(ST_USAGE, "the camera looks along its up direction");
    vec3_cross(c->right, c->forward, c->up);

    c->ortho = from->ortho_height > 0.0;
    const double half = c->ortho ? 0.5 * from->ortho_height : tangent(from->fov * PI / 360.0);
    for (int a = 0; a < 3; a++) {
        c->right[a] *= half;
        c->up[a] *= half;
    }
    c->width = from->width;
    c->height = from->height;
    camera_window(c, 0, 0);
    return ST_OK;
}

void camera_window(camera *c, uint32_t x, uint32_t y) {
    c->window[0] = x;
    c->window[1] = y;
    camera_shift(c, 0.0, 0.0);
}

void camera_shift(camera *c, double dx, double dy) {
    c->middle[0] = c->width - 2.0 * (c->window[0] + dx);
    c->middle[1] = c->height - 2.0 * (c->window[1] + dy);
}

/* A ray of a parallel camera; (u, v) is where it begins. */
static void ortho_ray(const camera *c, double u, double v, double origin[3], double direction[3]) {
    for (int a = 0; a < 3; a++) {
        origin[a] = c->eye[a] + u * c->right[a] + v * c->up[a];
        direction[a] = c->forward[a] + 0.0;
    }
}

void camera_ray(const camera *c, double x, double y, double origin[3], double direction[3]) {
    const double u = (2.0 * x - c->middle[0]) / c->height;
    const double v = (c->middle[1] - 2.0 * y) / c->height;
    double d[3];
    if (c->ortho) {
        ortho_ray(c, u, v, origin, direction);
        return;
    }
    for (int a = 0; a < 3; a++)
        d[a] = c->forward[a] + u * c->right[a] + v * c->up[a];
    const double shrink = 1.0 / vec3_length(d);
    for (int a = 0; a < 3; a++) {
        origin[a] = c->eye[a];
        direction[a] = d[a] * shrink + 0.0; /* -0 + 0 = +0 */
    }
}

ray_bundle camera_bundle(const camera *c) {
    const double *v = c->ortho ? c->forward : c->eye;
    return (ray_bundle){c->ortho ? RAYS_ALONG : RAYS_FROM, {v[0], v[1], v[2]}};
}

double camera_pixel(const camera *c, double distance) {
    return 2.0 * vec3_length(c->up) / c->height * (c->ortho ? 1.0 : distance);
}

leafcast_camera camera_standard(const double bounds[2][3], double distance, uint32_t width,
                                uint32_t height) {
    leafcast_camera view = {.size = sizeof(leafcast_camera),
                            .up = {0.0, 0.0, 1.0},
                            .fov = 45.0,
                            .width = width,
                            .height = height};
    double towards[3] = {1.0, 0.6, 0.8}, edge = 0.0;
    const double length = vec3_length(towards);
    for (int a = 0; a < 3; a++)
        edge = fmax(edge, bounds[1][a] - bounds[0][a]);
    for (int a = 0; a < 3; a++) {
        view.look_at[a] = 0.5 * (bounds[0][a] + bounds[1][a]);
        view.eye[a] = view.look_at[a] + distance * edge * (towards[a] / length);
    }
    return view;
}

/* ---- the view that fits ---- */

/* The direction to the eye: across, along the third axis, up. 27 degrees to the side, 24 above. */
static const double FIT_ACROSS = 0.5, FIT_DEPTH = 1.0, FIT_UP = 0.5;
static const double FIT_MARGIN = 1.04;

/* Choose the world axes that are up and across; size[]: the box's extents. */
static void fit_axes(const double size[3], int *up, int *across) {
    const double sides = fmax(size[0], size[1]);
    *up = size[2] > 2.0 * sides ? (size[0] >= size[1] ? 0 : 1) : 2;
    *across = *up == 2 ? (size[0] >= size[1] ? 0 : 1) : 2;
}

/* Returns how far the eye must be from the box's centre, against c->forward, so that a corner at
 * `offset` from the centre lies inside the picture. */
static double fit_distance(const double offset[3], const camera *c, double aspect) {
    const double towards = -vec3_dot(offset, c->forward);
    const double half = vec3_dot(c->up, c->up); /* tan^2 of half the field of view */
    const double x = fabs(vec3_dot(offset, c->right)) / (half * aspect),
                 y = fabs(vec3_dot(offset, c->up)) / half;
    return towards + FIT_MARGIN * fmax(x, y);
}

leafcast_camera camera_fit(const double corners[8][3], double fov, uint32_t width,
                           uint32_t height) {
    leafcast_camera view = {
        .size = sizeof(leafcast_camera), .fov = fov, .width = width, .height = height};
    double lo[3], hi[3], size[3], distance = 0.0;
    for (int a = 0; a < 3; a++) {
        lo[a] = hi[a] = corners[0][a];
        for (int i = 1; i < 8; i++) {
            lo[a] = fmin(lo[a], corners[i][a]);
            hi[a] = fmax(hi[a], corners[i][a]);
        }
        size[a] = hi[a] - lo[a];
        view.look_at[a] = 0.5 * lo[a] + 0.5 * hi[a];
    }
    int up, across;
    fit_axes(size, &up, &across);
    /* Right-handed: across x up points away from the picture, to the eye. So the eye is on one side
     * or the other of the third axis. */
    const int depth = 3 - up - across;
    const double side = (across + 1) % 3 == up ? 1.0 : -1.0;
    double back[3], edge = fmax(fmax(size[0], size[1]), size[2]);
    back[across] = FIT_ACROSS;
    back[up] = FIT_UP;
    back[depth] = side * FIT_DEPTH;
    if (!vec3_unit(back, back))
        return view;
    view.up[up] = 1.0;
    edge = edge > 0.0 ? edge : 1.0;
    for (int a = 0; a < 3; a++)
        view.eye[a] = view.look_at[a] + edge * back[a];
    camera c;
    if (camera_init(&c, &view) != ST_OK)
        return view;
    for (int i = 0; i < 8; i++) {
        double offset[3];
        vec3_sub(corners[i], view.look_at, offset);
        distance = fmax(distance, fit_distance(offset, &c, (double)width / height));
    }
    for (int a = 0; a < 3 && distance > 0.0; a++)
        view.eye[a] = view.look_at[a] + distance * back[a];
    return view;
}
