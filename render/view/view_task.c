#include "render/view/view_task.h"

#include <math.h>
#include <string.h>

#include "render/ray/placement.h"

view_way view_task_way(const leafcast_scene *scene, const view_options *v) {
    bool behind = scene->shadows;
    for (int i = 0; i < v->isos; i++)
        behind |= v->surfaces[i].opacity < 1.0f;
    if (scene->project != LEAFCAST_PROJECT_NONE)
        return scene->project == LEAFCAST_PROJECT_MEAN ? VIEW_WAY_MEANS : VIEW_WAY_EXTREMES;
    if (scene->media_count > 0)
        return scene->shade_media ? VIEW_WAY_SHADED : VIEW_WAY_MEDIA;
    return behind ? VIEW_WAY_BEHIND : VIEW_WAY_SURFACES;
}

/* Returns the number of cells in the width of a pixel, where the volume is nearest to the eye. */
static double cells_of(const leafcast_camera *c, const leafcast_info *info) {
    double square = 0.0;
    for (int a = 0; a < 3; a++) {
        const double nearest = fmin(fmax(c->eye[a], info->bounds[0][a]), info->bounds[1][a]);
        square += (c->eye[a] - nearest) * (c->eye[a] - nearest);
    }
    const double across = c->ortho_height != 0.0
                              ? c->ortho_height
                              : 2.0 * sqrt(square) * tan(c->fov * (M_PI / 360.0));
    return across / (c->height * info->cell_size);
}

/* Returns a guess for the first picture: seconds per pixel on two CPUs, of volumes that are not
 * small. */
static double guess_of(view_way of) {
    static const double guesses[VIEW_WAYS] = {0.10e-6, 0.3e-6, 0.8e-6, 3e-6, 0.8e-6, 3e-6};
    return guesses[of];
}

/* Returns the cost of cells relative to those of a regular grid of their size, if all segments of a
 * ray are needed. Measured: of tets 3 to 22 times, with 0.2 to 11 million of them. Of thinned
 * curvilinear grids with 36 to 260 thousand cells, relative to the grid inside: media 9 to 19
 * times, projections 21 to 72. Half of that remains, as view_pace.h already counts 2 for a finer
 * level. */
static double apart_of(const leafcast_info *info, view_way of) {
    const bool thinned = info->cell_levels > info->levels;
    if (of == VIEW_WAY_SURFACES || of == VIEW_WAY_BEHIND || info->preview_levels == info->levels)
        return 1.0;
    return thinned && (of == VIEW_WAY_EXTREMES || of == VIEW_WAY_MEANS) ? 20.0 : 8.0;
}

/* Returns what is told of an object's volume, as large as it is at its place. */
static leafcast_info placed(const picture_volume *object) {
    leafcast_info info = leafcast_describe(object->volume);
    const placement place = placement_of(object->place);
    double box[2][3];
    placement_box(&place, info.bounds, box);
    memcpy(info.bounds, box, sizeof box);
    info.cell_size *= place.moved ? place.size : 1.0;
    return info;
}

view_task view_task_of(const picture_volume *objects, int count, const leafcast_scene *scene,
                       const leafcast_camera *camera, view_way of) {
    view_task t = {.width = camera->width,
                   .height = camera->height,
                   .levels = 1,
                   .cells = INFINITY,
                   .guess = guess_of(of),
                   .apart = 1.0};
    for (int i = 0; i < count; i++) {
        const leafcast_info info = placed(&objects[i]);
        const uint32_t levels = scene->lod == LEAFCAST_LOD_PIXEL ? 1 : info.preview_levels;
        t.levels = levels > t.levels ? levels : t.levels;
        t.cells = fmin(t.cells, cells_of(camera, &info));
        t.slow = info.cell_levels > t.slow ? info.cell_levels : t.slow;
        t.apart = fmax(t.apart, apart_of(&info, of));
    }
    return t;
}
