#include "render/app/light_options.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "formats/base/cli_value.h"

static int commas_in(const char *text) {
    int commas = 0;
    for (; *text; text++)
        commas += *text == ',';
    return commas;
}

static status check_radius(bool point, double radius, const char *what) {
    if (radius >= 0.0 && (point || radius <= 90.0))
        return ST_OK;
    return status_describe(ST_USAGE,
                           point ? "%s: a radius of %g is below 0"
                                 : "%s: a half-angle of %g degrees is not 0 to 90",
                           what, radius);
}

status light_options_add(leafcast_scene *scene, bool point, const char *text) {
    const char *what = point ? "--point-light" : "--light";
    if (scene->light_count == LEAFCAST_LIGHTS_MAX)
        return status_describe(ST_USAGE, "%s: more than %d of them", what, LEAFCAST_LIGHTS_MAX);
    const int commas = commas_in(text);
    const bool coloured = commas == 5 || commas == 6, soft = commas == 3 || commas == 6;
    double x[7] = {0.0, 0.0, 0.0, 1.0, 1.0, 1.0}, radius = 0.0;
    status st = cli_vector(text, what, 3 + 3 * coloured + soft, x);
    if (st != ST_OK)
        return st;
    if (!point && x[0] == 0.0 && x[1] == 0.0 && x[2] == 0.0)
        return status_describe(ST_USAGE, "--light: %s is no direction", text);
    if (soft)
        radius = x[coloured ? 6 : 3];
    st = check_radius(point, radius, what);
    if (st != ST_OK)
        return st;
    leafcast_light *light = &scene->lights[scene->light_count++];
    *light = (leafcast_light){.point = point, .radius = radius};
    for (int i = 0; i < 3; i++) {
        light->vector[i] = x[i];
        light->rgb[i] = coloured ? (float)x[3 + i] : 1.0F;
    }
    return ST_OK;
}

void light_options_remove(leafcast_scene *scene, bool point) {
    int kept = 0;
    for (int i = 0; i < scene->light_count; i++)
        if (scene->lights[i].point != point)
            scene->lights[kept++] = scene->lights[i];
    scene->light_count = kept;
}

bool light_options_soft(const leafcast_scene *scene) {
    bool soft = false;
    for (int i = 0; i < scene->light_count; i++)
        soft |= scene->lights[i].radius > 0.0;
    return soft;
}

/* Take "X[,N]": a number of lo .. hi, and a whole one of 1 .. most. *n stays where it is not
 * given. */
static status take_pair(const char *text, const char *what, double lo, double hi, int most,
                        double *x, int *n) {
    char number[64];
    const size_t length = strcspn(text, ",");
    snprintf(number, sizeof number, "%.*s", (int)(length < 63 ? length : 63), text);
    status st = cli_finite(number, what, lo, hi, x);
    if (st == ST_OK && text[length])
        st = cli_int(text + length + 1, what, 1, most, n);
    return st;
}

status light_options_occlusion(const char *text, leafcast_scene *scene) {
    const status st =
        take_pair(text, "--occlusion", 0.0, LEAFCAST_PLACE_MOST, LEAFCAST_LIGHT_SAMPLES_MAX,
                  &scene->occlusion, &scene->occlusion_samples);
    if (st == ST_OK && !(scene->occlusion > 0.0))
        return status_describe(ST_USAGE, "--occlusion: a distance of %s is not above 0", text);
    return st;
}

status light_options_reflect(const char *text, leafcast_surface *surface, int *bounces) {
    double weight = 0.0;
    const status st =
        take_pair(text, "--reflect", 0.0, 1.0, LEAFCAST_BOUNCES_MAX, &weight, bounces);
    if (st == ST_OK)
        surface->reflectivity = (float)weight;
    return st;
}

status light_options_refract(const char *text, leafcast_surface *surface, int *bounces) {
    double index = 0.0;
    const status st = take_pair(text, "--refract", 1.0 / LEAFCAST_REFRACTION_MOST,
                                LEAFCAST_REFRACTION_MOST, LEAFCAST_BOUNCES_MAX, &index, bounces);
    if (st == ST_OK)
        surface->refraction = (float)index;
    return st;
}
