#include "render/grid/surface.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "render/surface/shade.h"

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

/* Two neighbours along x. */
typedef double pair __attribute__((vector_size(16)));

/* Offsets from a cell's first node to the nodes around the cell: one below and one above the cell's
 * own on each axis, unless the volume ends there. */
typedef struct cell_around {
    ptrdiff_t stride[3], below[3], above[3];
    double width[3][2]; /* 1 / the distance between a node's neighbours */
} cell_around;

/* Compute the gradients at a cell's corners, row by row of x. Each sample is converted once. */
#define GRADIENTS_OF(NAME, TYPE)                                                         \
    static inline pair NAME##_pair(const TYPE *s) {                                      \
        return (pair){(double)s[0], (double)s[1]};                                       \
    }                                                                                    \
    static void NAME(const void *samples, size_t first, const cell_around *n,            \
                     double gradients[8][4]) {                                           \
        const TYPE *s = (const TYPE *)samples + first;                                   \
        pair inner[2][2], y_outer[2][2], z_outer[2][2];                                  \
        for (int k = 0; k < 2; k++) {                                                    \
            const TYPE *along_y = s + k * n->stride[2], *along_z = s + k * n->stride[1]; \
            inner[k][0] = NAME##_pair(along_y);                                          \
            inner[k][1] = NAME##_pair(along_y + n->stride[1]);                           \
            y_outer[k][0] = NAME##_pair(along_y + n->below[1]);                          \
            y_outer[k][1] = NAME##_pair(along_y + n->above[1]);                          \
            z_outer[0][k] = NAME##_pair(along_z + n->below[2]);                          \
            z_outer[1][k] = NAME##_pair(along_z + n->above[2]);                          \
        }                                                                                \
        for (int z = 0; z < 2; z++) {                                                    \
            for (int y = 0; y < 2; y++) {                                                \
                const TYPE *row = s + y * n->stride[1] + z * n->stride[2];               \
                const pair own = inner[z][y];                                            \
                const pair x_low = {(double)row[n->below[0]], own[0]};                   \
                const pair x_high = {own[1], (double)row[n->above[0]]};                  \
                const pair y_low = y == 0 ? y_outer[z][0] : inner[z][0];                 \
                const pair y_high = y == 0 ? inner[z][1] : y_outer[z][1];                \
                const pair z_low = z == 0 ? z_outer[0][y] : inner[0][y];                 \
                const pair z_high = z == 0 ? inner[1][y] : z_outer[1][y];                \
                put_gradients((x_high - x_low) * (pair){n->width[0][0], n->width[0][1]}, \
                              (y_high - y_low) * (pair){n->width[1][y], n->width[1][y]}, \
                              (z_high - z_low) * (pair){n->width[2][z], n->width[2][z]}, \
                              gradients + 2 * y + 4 * z);                                \
            }                                                                            \
        }                                                                                \
    }

static inline void put_gradients(pair x, pair y, pair z, double gradients[2][4]) {
    for (int i = 0; i < 2; i++) {
        const pair low = {x[i], y[i]}, high = {z[i], 0.0};
        memcpy(gradients[i], &low, sizeof low);
        memcpy(gradients[i] + 2, &high, sizeof high);
    }
}

GRADIENTS_OF(gradients_u8, uint8_t)
GRADIENTS_OF(gradients_i8, int8_t)
GRADIENTS_OF(gradients_u16, uint16_t)
GRADIENTS_OF(gradients_i16, int16_t)
GRADIENTS_OF(gradients_f32, float)

void surface_gradients(const walk_scene *scene, const resident_grid *tr, const uint32_t cell[3],
                       double gradients[8][4]) {
    const level_planes *planes = &scene->levels[tr->level];
    const ptrdiff_t row = tr->shape.samples[0];
    cell_around n = {.stride = {1, row, row * tr->shape.samples[1]}};
    size_t first = 0;
    for (int a = 0; a < 3; a++) {
        first += (cell[a] - tr->first_cell[a] + scene->halo) * (size_t)n.stride[a];
        n.below[a] = cell[a] > 0 ? -n.stride[a] : 0;
        n.above[a] = (cell[a] + 1 < planes->cells[a] ? 2 : 1) * n.stride[a];
        n.width[a][0] = planes->central[a][cell[a]];
        n.width[a][1] = planes->central[a][cell[a] + 1];
    }
    switch (scene->type) {
    case SAMPLE_U8: gradients_u8(tr->samples, first, &n, gradients); return;
    case SAMPLE_I8: gradients_i8(tr->samples, first, &n, gradients); return;
    case SAMPLE_U16: gradients_u16(tr->samples, first, &n, gradients); return;
    case SAMPLE_I16: gradients_i16(tr->samples, first, &n, gradients); return;
    default: gradients_f32(tr->samples, first, &n, gradients);
    }
}

/* Interpolate the nodes' central differences trilinearly: in a regular grid the same as M08's six
 * evaluations of f. */
static void central_gradient(const walk_scene *scene, const resident_grid *tr,
                             const uint32_t cell[3], const double at[3], double gradient[3]) {
    double g[8][4];
    surface_gradients(scene, tr, cell, g);
    for (int a = 0; a < 3; a++)
        gradient[a] =
            mix(mix(mix(g[0][a], g[1][a], at[0]), mix(g[2][a], g[3][a], at[0]), at[1]),
                mix(mix(g[4][a], g[5][a], at[0]), mix(g[6][a], g[7][a], at[0]), at[1]), at[2]);
}

/* Set error[] to a bound of the distance of the computed point from the hit, per axis of grid
 * space. Also bounds the start of a ray there. The point is also rounded in world space, whose
 * origin may be far away. */
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

/* A hit in its cell. */
typedef struct cell_hit {
    uint32_t cell[3];
    cell_box box;
    double at[3]; /* in the cell, each in [0, 1] */
} cell_hit;

static cell_hit cell_hit_of(const walk_scene *scene, const resident_grid *tr, const ray *r,
                            const hit *h) {
    const level_planes *planes = &scene->levels[tr->level];
    cell_hit c;
    surface_cell_of(planes, h->cell, c.cell);
    c.box = walk_cell_box(planes, c.cell);
    for (int a = 0; a < 3; a++) {
        const double u = (h->t * r->d[a] - (c.box.lo[a] - r->o[a])) * c.box.inv[a];
        c.at[a] = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
    }
    return c;
}

/* Compute the surface point but for its normal. */
static surface_point start_of(const walk_scene *scene, const affine *space, const resident_grid *tr,
                              const ray *r, const hit *h, const cell_hit *c) {
    double position_error[3], gradient[3], magnitude = 0.0;
    float samples[8];
    position_errors(space, r, h->t, position_error);
    walk_cell_samples(scene, tr, c->cell, samples);
    surface_trilinear(samples, c->at, c->box.inv, gradient);
    for (int i = 0; i < 8; i++)
        magnitude = fmax(magnitude, fabs((double)samples[i] - scene->isovalues[h->iso]));
    /* The kernel's sums err by a few ulps of the largest difference. The hit's position errs by a
     * few ulps of where it lies. */
    surface_point point = {.span = INFINITY, .error = 32.0 * DBL_EPSILON * magnitude};
    for (int a = 0; a < 3; a++) {
        point.span = fmin(point.span, affine_unit(space, a) * (c->box.hi[a] - c->box.lo[a]));
        point.error += fabs(gradient[a]) * position_error[a];
    }
    affine_gradient_to_world(space, gradient, point.gradient);
    return point;
}

surface_point surface_at(const walk_scene *scene, const affine *space, const resident_grid *tr,
                         const ray *r, const hit *h, bool analytic) {
    const cell_hit c = cell_hit_of(scene, tr, r, h);
    surface_point point = start_of(scene, space, tr, r, h, &c);
    double smooth[3] = {0.0, 0.0, 0.0};
    if (!analytic && scene->halo > 0) {
        double central[3];
        central_gradient(scene, tr, c.cell, c.at, central);
        affine_gradient_to_world(space, central, smooth);
    }
    if (!shade_normal(smooth, point.normal) && !shade_normal(point.gradient, point.normal))
        point.normal[0] = point.normal[1] = point.normal[2] = 0.0f;
    return point;
}
