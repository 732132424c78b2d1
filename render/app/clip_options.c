#include "render/app/clip_options.h"

#include "formats/base/cli_value.h"

status clip_options_add_plane(leafcast_scene *scene, const char *text) {
    if (scene->clip_plane_count == LEAFCAST_CLIP_PLANES_MAX)
        return status_describe(ST_USAGE, "--clip-plane: more than %d of them",
                               LEAFCAST_CLIP_PLANES_MAX);
    double *plane = scene->clip_planes[scene->clip_plane_count];
    const status st = cli_vector(text, "--clip-plane", 4, plane);
    scene->clip_plane_count += st == ST_OK;
    return st;
}

status clip_options_box(leafcast_scene *scene, const char *text) {
    double x[6];
    status st = cli_vector(text, "--clip-box", 6, x);
    for (int a = 0; a < 3 && st == ST_OK; a++) {
        if (!(x[a] <= x[a + 3]))
            st = status_describe(ST_USAGE, "--clip-box: \"%s\" ends before it begins", text);
        scene->clip_min[a] = x[a];
        scene->clip_max[a] = x[a + 3];
    }
    scene->clip_box = st == ST_OK;
    return st;
}
