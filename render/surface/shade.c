#include "render/surface/shade.h"

#include <math.h>

#include "formats/base/vec3.h"

static float dot(const float a[3], const float b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* x^n for n >= 1 by squaring: a fixed sequence of products. powf() may differ between CPUs.
 */
static float power(float x, int n) {
    float result = 1.0f;
    for (; n > 0; n >>= 1, x *= x)
        if (n & 1)
            result *= x;
    return result;
}

shade_point shade_point_of(const leafcast_scene *scene, const float rgb[3], const float normal[3],
                           const float towards_eye[3]) {
    shade_point p = {.ambient = scene->ambient,
                     .specular = scene->specular,
                     .shininess = scene->shininess,
                     .shading = scene->shading};
    const float length = sqrtf(dot(normal, normal));
    const float turn = dot(normal, towards_eye) < 0.0f ? -length : length;
    for (int a = 0; a < 3; a++) {
        p.rgb[a] = rgb[a];
        p.eye[a] = towards_eye[a];
        p.normal[a] = length > 0.0f ? normal[a] / turn : towards_eye[a];
    }
    return p;
}

void shade_ambient(const shade_point *p, float out[3]) {
    const float weight = p->shading == LEAFCAST_SHADING_FLAT ? 1.0f : p->ambient;
    for (int i = 0; i < 3; i++)
        out[i] = weight * p->rgb[i];
}

bool shade_reaches(const shade_point *p, const float towards_light[3]) {
    return p->shading != LEAFCAST_SHADING_FLAT && dot(p->normal, towards_light) > 0.0f;
}

void shade_light(const shade_point *p, const float towards_light[3], const float light_rgb[3],
                 float visibility, float out[3]) {
    const float n_l = dot(p->normal, towards_light);
    if (!shade_reaches(p, towards_light))
        return;
    const float diffuse = visibility * ((1.0f - p->ambient) * n_l);
    for (int i = 0; i < 3; i++)
        out[i] += diffuse * light_rgb[i] * p->rgb[i];
    if (p->shading != LEAFCAST_SHADING_PHONG)
        return;
    /* R = 2 (N . L) N - L */
    const float r_v = 2.0f * n_l * dot(p->normal, p->eye) - dot(towards_light, p->eye);
    if (r_v > 0.0f) {
        const float highlight =
            visibility * p->specular * power(r_v < 1.0f ? r_v : 1.0f, p->shininess);
        for (int i = 0; i < 3; i++)
            out[i] += highlight * light_rgb[i];
    }
}

void shade_composite(float rgba[4], const float rgb[3], float opacity) {
    const float weight = (1.0f - rgba[3]) * opacity;
    for (int i = 0; i < 3; i++)
        rgba[i] += weight * rgb[i];
    rgba[3] += weight;
}

void shade_behind(float rgba[4], const float behind[4]) {
    const float weight = 1.0f - rgba[3];
    for (int i = 0; i < 4; i++)
        rgba[i] += weight * behind[i];
}

void shade_background(float rgba[4], const float background[4]) {
    shade_composite(rgba, background, background[3]);
}

bool shade_normal(const double gradient[3], float normal[3]) {
    double unit[3];
    if (!isfinite(gradient[0] + gradient[1] + gradient[2]) || !vec3_unit(gradient, unit))
        return false;
    for (int a = 0; a < 3; a++)
        normal[a] = (float)-unit[a];
    return true;
}
