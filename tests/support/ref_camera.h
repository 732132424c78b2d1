/* ref_camera.h - the reference's own camera: right-handed, vertical field of view, pixel centres at
 * +0.5, y down. */
#ifndef TESTS_SUPPORT_REF_CAMERA_H
#define TESTS_SUPPORT_REF_CAMERA_H

#include "tests/support/reference.h"

typedef struct ref_camera {
    double eye[3], look_at[3], up[3];
    double fov; /* vertical, degrees */
    int width, height;
} ref_camera;

/* ref_world_box() - the world bounding box of a volume. */
void ref_world_box(const ref_volume *v, double lower[3], double upper[3]);

/* ref_view_of_box() - fov 45, up +z, looking at the box's centre from `distance` times its longest
 * edge in the direction (1, 0.6, 0.8). The standard view has distance 2.2, the close view 1.1. */
ref_camera ref_view_of_box(const double lower[3], const double upper[3], double distance, int width,
                           int height);

/* ref_standard_view() - that of a volume's world box. */
ref_camera ref_standard_view(const ref_volume *v, double distance, int width, int height);

/* ref_primary_ray() - through the centre of pixel (x, y), y down; unit direction. */
ref_ray ref_primary_ray(const ref_camera *camera, int x, int y);

#endif
