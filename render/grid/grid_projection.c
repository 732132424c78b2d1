#include "render/grid/grid_projection.h"

#include <math.h>

static size_t planes_of(const leaf_layout *layout, uint32_t level, int a) {
    return ((size_t)layout->level[level].treelets[a] << layout->cells_log2) + 1;
}

static size_t planes_in_all(const leaf_layout *layout) {
    size_t planes = 0;
    for (uint32_t l = 0; l < layout->levels; l++)
        for (int a = 0; a < 3; a++)
            planes += planes_of(layout, l, a);
    return planes;
}

size_t grid_projection_bytes(const leaf_layout *layout) {
    return planes_in_all(layout) * sizeof(plane_projection);
}

status grid_projection_init(projection *p, mem *m, const leaf_layout *layout,
                            const level_planes levels[], const affine *space, const camera *c) {
    *p = (projection){.m = m,
                      .centre = {(float)(0.5 * c->middle[0]), (float)(0.5 * c->middle[1])},
                      .block = mem_array(m, planes_in_all(layout), sizeof *p->block)};
    if (!p->block)
        return ST_NOMEM;
    affine_point_to_grid(space, c->eye, p->eye);
    p->scale = projection_scale(space);
    p->unscale = 1.0 / p->scale;
    axis_projection axis[3];
    double longest = 0.0, worst = 0.0;
    for (int a = 0; a < 3; a++) {
        axis[a] = projection_axis(space, c, a);
        longest = fmax(longest, axis[a].far);
    }
    plane_projection *next = p->block;
    for (uint32_t l = 0; l < layout->levels; l++) {
        for (int a = 0; a < 3; a++) {
            const size_t planes = planes_of(layout, l, a);
            p->at[l][a] = next;
            for (size_t i = 0; i < planes; i++) {
                const double from_eye = levels[l].at[a][i] - p->eye[a], q = from_eye / longest;
                const double inverse = levels[l].inverse[a][i + 1 < planes ? i : i - 1];
                *next++ = (plane_projection){(float)(axis[a].x * q),
                                             (float)(axis[a].y * q),
                                             (float)(axis[a].w * q),
                                             (float)(axis[a].far * fabs(q)),
                                             (float)from_eye,
                                             (float)inverse,
                                             {0.0f, 0.0f}};
                worst = fmax(worst, fabs(axis[a].x * q) + fabs(axis[a].y * q) +
                                        fabs(axis[a].far * q) + fabs(from_eye) + inverse);
            }
        }
    }
    projection_set_bounds(p, c, worst, 1.0);
    return ST_OK;
}
