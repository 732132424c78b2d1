#include "tests/support/ref_camera.h"

#include <math.h>

static const double PI = 3.14159265358979323846;

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static void normalize(double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        v[a] /= length;
}

void ref_world_box(const ref_volume *v, double lower[3], double upper[3]) {
    for (int a = 0; a < 3; a++) {
        lower[a] = INFINITY;
        upper[a] = -INFINITY;
    }
    for (int corner = 0; corner < 8; corner++) {
        double node[3];
        for (int a = 0; a < 3; a++) {
            long i = corner >> a & 1 ? v->dims[a] - 1 : 0;
            node[a] = v->axis[a] ? v->axis[a][i] : (double)i;
        }
        for (int a = 0; a < 3; a++) {
            const double *m = v->to_world[a];
            double x = m[0] * node[0] + m[1] * node[1] + m[2] * node[2] + m[3];
            lower[a] = fmin(lower[a], x);
            upper[a] = fmax(upper[a], x);
        }
    }
}

ref_camera ref_view_of_box(const double lower[3], const double upper[3], double distance, int width,
                           int height) {
    ref_camera camera = {.up = {0, 0, 1}, .fov = 45, .width = width, .height = height};
    double direction[3] = {1, 0.6, 0.8}, edge = 0;
    normalize(direction);
    for (int a = 0; a < 3; a++)
        edge = fmax(edge, upper[a] - lower[a]);
    for (int a = 0; a < 3; a++) {
        camera.look_at[a] = (lower[a] + upper[a]) / 2;
        camera.eye[a] = camera.look_at[a] + distance * edge * direction[a];
    }
    return camera;
}

ref_camera ref_standard_view(const ref_volume *v, double distance, int width, int height) {
    double lower[3], upper[3];
    ref_world_box(v, lower, upper);
    return ref_view_of_box(lower, upper, distance, width, height);
}

ref_ray ref_primary_ray(const ref_camera *camera, int x, int y) {
    double forward[3], right[3], up[3];
    for (int a = 0; a < 3; a++)
        forward[a] = camera->look_at[a] - camera->eye[a];
    normalize(forward);
    cross(forward, camera->up, right);
    normalize(right);
    cross(right, forward, up);

    double half = tan(camera->fov * PI / 360);
    double sx = (2 * (x + 0.5) / camera->width - 1) * half * camera->width / camera->height;
    double sy = (1 - 2 * (y + 0.5) / camera->height) * half;
    ref_ray ray;
    for (int a = 0; a < 3; a++) {
        ray.o[a] = camera->eye[a];
        ray.d[a] = forward[a] + sx * right[a] + sy * up[a];
    }
    normalize(ray.d);
    return ray;
}
