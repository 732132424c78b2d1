#include "render/projection.h"

#include <math.h>

#include "formats/base/vec3.h"

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

size_t projection_bytes(const leaf_layout *layout) {
    return planes_in_all(layout) * sizeof(plane_projection);
}

/* What a step of one along a grid axis adds. */
typedef struct axis_projection {
    double x, y, w, far;
} axis_projection;

static axis_projection axis_of(const affine *space, const camera *c, int a) {
    const double step[3] = {space->to_world[0][a], space->to_world[1][a], space->to_world[2][a]};
    /* right and up are as long as half the picture's height at distance 1. */
    const double half = 0.5 * c->height;
    return (axis_projection){half * vec3_dot(c->right, step) / vec3_dot(c->right, c->right),
                             -half * vec3_dot(c->up, step) / vec3_dot(c->up, c->up),
                             vec3_dot(c->forward, step), vec3_length(step)};
}

/* The power of two that brings vectors in grid space to ordinary size. */
static double scale_of(const affine *space) {
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            largest = fmax(largest, fabs(space->to_grid[i][j]));
    return scalbn(1.0, -ilogb(largest));
}

/* Each entry is rounded once and two sums are: |error| of x <= 3 u sum |x| and of w <= 3 u sum |w|,
 * u = 2^-24, where sum |x| <= reach sum far and sum |w| <= sum far. Of x / w then 3 u (reach + |x /
 * w|) sum far / w, and the reciprocal's 2^-21; doubled and rounded up. rounded: how much more the
 * entries are. */
static void set_bounds(projection *p, const camera *c, double worst, double rounded) {
    const double u = rounded * ldexp(1.0, -24);
    const double shift = fmax(fabs(c->width - c->middle[0]), fabs(c->height - c->middle[1]));
    const double half = 0.5 * (fmax(c->width, c->height) + shift);
    const double reach =
        0.5 * c->height / sqrt(fmin(vec3_dot(c->right, c->right), vec3_dot(c->up, c->up)));
    p->margin = (float)(8.0 * u / (double)projection_depth_share * (reach + half) +
                        ldexp(half, -20) + 1e-4);
    p->plane_error = (float)(8.0 * u * (reach + half));
    /* The reciprocal wants numbers of ordinary size. */
    p->usable = worst < 1e15 && p->margin < 4.0f;
}

status projection_init(projection *p, mem *m, const leaf_layout *layout,
                       const level_planes levels[], const affine *space, const camera *c) {
    *p = (projection){.m = m,
                      .centre = {(float)(0.5 * c->middle[0]), (float)(0.5 * c->middle[1])},
                      .block = mem_array(m, planes_in_all(layout), sizeof *p->block)};
    if (!p->block)
        return ST_NOMEM;
    affine_point_to_grid(space, c->eye, p->eye);
    p->scale = scale_of(space);
    p->unscale = 1.0 / p->scale;
    axis_projection axis[3];
    double longest = 0.0, worst = 0.0;
    for (int a = 0; a < 3; a++) {
        axis[a] = axis_of(space, c, a);
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
    set_bounds(p, c, worst, 1.0);
    return ST_OK;
}

void projection_init_mesh(projection *p, const float bounds[6], const camera *c) {
    affine world;
    const double identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    double worst = 0.0;
    affine_init(&world, identity);
    *p = (projection){.centre = {(float)(0.5 * c->middle[0]), (float)(0.5 * c->middle[1])},
                      .scale = 1.0,
                      .unscale = 1.0};
    for (int a = 0; a < 3; a++) {
        const axis_projection axis = axis_of(&world, c, a);
        const double entries[4] = {axis.x, axis.y, axis.w, axis.far};
        p->eye[a] = c->eye[a];
        for (int i = 0; i < 4; i++)
            p->axis[a][i] = (float)entries[i];
        worst = fmax(worst, (fabs(axis.x) + fabs(axis.y) + axis.far) *
                                fmax(fabs((double)bounds[a] - c->eye[a]),
                                     fabs((double)bounds[a + 3] - c->eye[a])));
    }
    /* Entries are products of two rounded numbers, rounded. */
    set_bounds(p, c, worst, 2.0);
}

void projection_release(projection *p) {
    if (p->m)
        mem_free(p->m, p->block);
    p->block = NULL;
}
