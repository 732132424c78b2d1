#include "render/grid/surface.h"

#include <float.h>
#include <math.h>

#include "render/shade.h"

void surface_cell_of(const level_planes *planes, uint64_t index, uint32_t cell[3]) {
    cell[0] = (uint32_t)(index % planes->cells[0]);
    index /= planes->cells[0];
    cell[1] = (uint32_t)(index % planes->cells[1]);
    cell[2] = (uint32_t)(index / planes->cells[1]);
}

static double mix(double a, double b, double s) {
    return (1.0 - s) * a + s * b;
}

double surface_trilinear(const float samples[8], const double at[3], const double inverse[3],
                         double gradient[3]) {
    double s[8];
    for (int i = 0; i < 8; i++)
        s[i] = (double)samples[i];
    double x[4], dx[4];
    for (int i = 0; i < 4; i++) {
        x[i] = mix(s[2 * i], s[2 * i + 1], at[0]);
        dx[i] = s[2 * i + 1] - s[2 * i];
    }
    const double xy[2] = {mix(x[0], x[1], at[1]), mix(x[2], x[3], at[1])};
    gradient[0] = mix(mix(dx[0], dx[1], at[1]), mix(dx[2], dx[3], at[1]), at[2]) * inverse[0];
    gradient[1] = mix(x[1] - x[0], x[3] - x[2], at[2]) * inverse[1];
    gradient[2] = (xy[1] - xy[0]) * inverse[2];
    return mix(xy[0], xy[1], at[2]);
}

/* The differences at the corners of a cell whose samples begin at s; the neighbours of node c of
 * axis a lie below[a][c] and above[a][c] from it. */
#define GRADIENTS_OF(NAME, TYPE)                                                              \
    static void NAME(const void *samples, size_t first, const ptrdiff_t stride[3],            \
                     const ptrdiff_t below[3][2], const ptrdiff_t above[3][2],                \
                     const double width[3][2], double gradients[8][4]) {                      \
        for (unsigned i = 0; i < 8; i++) {                                                    \
            const unsigned c[3] = {i & 1u, i >> 1 & 1u, i >> 2};                              \
            const TYPE *s = (const TYPE *)samples + first + (ptrdiff_t)c[0] * stride[0] +     \
                            (ptrdiff_t)c[1] * stride[1] + (ptrdiff_t)c[2] * stride[2];        \
            for (int a = 0; a < 3; a++)                                                       \
                gradients[i][a] =                                                             \
                    ((double)s[above[a][c[a]]] - (double)s[below[a][c[a]]]) * width[a][c[a]]; \
            gradients[i][3] = 0.0;                                                            \
        }                                                                                     \
    }

GRADIENTS_OF(gradients_u8, uint8_t)
GRADIENTS_OF(gradients_i8, int8_t)
GRADIENTS_OF(gradients_u16, uint16_t)
GRADIENTS_OF(gradients_i16, int16_t)
GRADIENTS_OF(gradients_f32, float)

void surface_gradients(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       double gradients[8][4]) {
    const level_planes *planes = &scene->levels[tr->level];
    const ptrdiff_t row = tr->shape.samples[0], stride[3] = {1, row, row * tr->shape.samples[1]};
    ptrdiff_t below[3][2], above[3][2];
    double width[3][2];
    size_t first = 0;
    for (int a = 0; a < 3; a++) {
        first += (cell[a] - tr->first_cell[a] + scene->halo) * (size_t)stride[a];
        for (unsigned c = 0; c < 2; c++) {
            const uint32_t node = cell[a] + c;
            below[a][c] = node > 0 ? -stride[a] : 0;
            above[a][c] = node < planes->cells[a] ? stride[a] : 0;
            width[a][c] = planes->central[a][node];
        }
    }
    switch (scene->type) {
    case SAMPLE_U8:
        gradients_u8(tr->samples, first, stride, below, above, width, gradients);
        return;
    case SAMPLE_I8:
        gradients_i8(tr->samples, first, stride, below, above, width, gradients);
        return;
    case SAMPLE_U16:
        gradients_u16(tr->samples, first, stride, below, above, width, gradients);
        return;
    case SAMPLE_I16:
        gradients_i16(tr->samples, first, stride, below, above, width, gradients);
        return;
    default: gradients_f32(tr->samples, first, stride, below, above, width, gradients);
    }
}

/* Trilinear interpolation of the nodes' central differences: in a regular grid the same as M08's
 * six evaluations of f. */
static void central_gradient(const walk_scene *scene, const resident_grid *tr,
                             const uint32_t cell[3], const double at[3], double gradient[3]) {
    double g[8][4];
    surface_gradients(scene, tr, cell, g);
    for (int a = 0; a < 3; a++)
        gradient[a] =
            mix(mix(mix(g[0][a], g[1][a], at[0]), mix(g[2][a], g[3][a], at[0]), at[1]),
                mix(mix(g[4][a], g[5][a], at[0]), mix(g[6][a], g[7][a], at[0]), at[1]), at[2]);
}

/* Bounds of how far the computed point (and a ray that starts there) lies from the hit, in grid
 * space. It goes through world space, whose origin may be far away: rounded there, too. */
static void position_errors(const affine *space, const ray *r, double t, double error[3]) {
    double grid[3], world[3];
    for (int a = 0; a < 3; a++)
        grid[a] = fabs(r->o[a]) + fabs(t * r->d[a]);
    for (int i = 0; i < 3; i++) {
        world[i] = fabs(space->to_world[i][3]);
        for (int a = 0; a < 3; a++)
            world[i] += fabs(space->to_world[i][a]) * grid[a];
    }
    for (int a = 0; a < 3; a++) {
        error[a] = grid[a];
        for (int i = 0; i < 3; i++)
            error[a] += fabs(space->to_grid[a][i]) * world[i];
        error[a] *= 4.0 * DBL_EPSILON;
    }
}

surface_point surface_at(const walk_scene *scene, const affine *space, const resident_grid *tr,
                         const ray *r, const hit *h, bool analytic) {
    const level_planes *planes = &scene->levels[tr->level];
    uint32_t cell[3];
    surface_cell_of(planes, h->cell, cell);
    const cell_box box = walk_cell_box(planes, cell);
    double at[3], position_error[3];
    for (int a = 0; a < 3; a++) {
        const double u = (h->t * r->d[a] - (box.lo[a] - r->o[a])) * box.inv[a];
        at[a] = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    }
    position_errors(space, r, h->t, position_error);
    float samples[8];
    walk_cell_samples(scene, tr, cell, samples);
    double gradient[3], magnitude = 0.0;
    surface_trilinear(samples, at, box.inv, gradient);
    for (int i = 0; i < 8; i++)
        magnitude = fmax(magnitude, fabs((double)samples[i] - scene->isovalues[h->iso]));

    surface_point point;
    point.span = INFINITY;
    for (int a = 0; a < 3; a++) {
        point.span = fmin(point.span, affine_unit(space, a) * (box.hi[a] - box.lo[a]));
    }
    /* The kernel's sums err by a few ulps of the largest difference; its position by a few ulps of
     * where it lies. */
    point.error = 32.0 * DBL_EPSILON * magnitude;
    for (int a = 0; a < 3; a++)
        point.error += fabs(gradient[a]) * position_error[a];
    affine_gradient_to_world(space, gradient, point.gradient);
    double smooth[3] = {0.0, 0.0, 0.0};
    if (!analytic && scene->halo > 0) {
        double central[3];
        central_gradient(scene, tr, cell, at, central);
        affine_gradient_to_world(space, central, smooth);
    }
    if (!shade_normal(smooth, point.normal) && !shade_normal(point.gradient, point.normal))
        point.normal[0] = point.normal[1] = point.normal[2] = 0.0f;
    return point;
}
