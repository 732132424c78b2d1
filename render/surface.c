#include "render/surface.h"

#include <float.h>
#include <math.h>

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

/* One component of the gradient at a node: a central difference, one-sided at the volume's ends. */
static double difference(const walk_scene *scene, const level_planes *planes, const treelet *tr,
                         const int64_t node[3], int a) {
    int64_t below[3] = {node[0], node[1], node[2]}, above[3] = {node[0], node[1], node[2]};
    if (node[a] > 0)
        below[a]--;
    if (node[a] < (int64_t)planes->cells[a])
        above[a]++;
    return ((double)walk_sample(scene, tr, above) - (double)walk_sample(scene, tr, below)) /
           (planes->at[a][above[a]] - planes->at[a][below[a]]);
}

/* Trilinear interpolation of the nodes' central differences: in a regular grid the same as M08's
 * six evaluations of f. */
static void central_gradient(const walk_scene *scene, const treelet *tr, const uint32_t cell[3],
                             const double at[3], double gradient[3]) {
    const level_planes *planes = &scene->levels[tr->level];
    for (int a = 0; a < 3; a++) {
        double d[8];
        for (int i = 0; i < 8; i++) {
            const int64_t node[3] = {(int64_t)cell[0] + (i & 1), (int64_t)cell[1] + (i >> 1 & 1),
                                     (int64_t)cell[2] + (i >> 2 & 1)};
            d[i] = difference(scene, planes, tr, node, a);
        }
        gradient[a] = mix(mix(mix(d[0], d[1], at[0]), mix(d[2], d[3], at[0]), at[1]),
                          mix(mix(d[4], d[5], at[0]), mix(d[6], d[7], at[0]), at[1]), at[2]);
    }
}

/* The unit vector against a gradient; false where it has no direction. */
static bool unit_against(const double gradient[3], float normal[3]) {
    /* Scaled first, so that squares neither vanish nor overflow. */
    const double largest = fmax(fabs(gradient[0]), fmax(fabs(gradient[1]), fabs(gradient[2])));
    if (!(largest > 0.0) || !isfinite(gradient[0] + gradient[1] + gradient[2]))
        return false;
    double v[3];
    for (int a = 0; a < 3; a++)
        v[a] = gradient[a] / largest;
    const double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3; a++)
        normal[a] = (float)(-v[a] / length);
    return true;
}

surface_point surface_at(const walk_scene *scene, const affine *space, const treelet *tr,
                         const ray *r, const hit *h, bool analytic) {
    const level_planes *planes = &scene->levels[tr->level];
    uint32_t cell[3];
    surface_cell_of(planes, h->cell, cell);
    const cell_box box = walk_cell_box(planes, cell);
    double at[3], position_error[3];
    for (int a = 0; a < 3; a++) {
        const double x = r->o[a] + h->t * r->d[a];
        const double u = (x - box.lo[a]) * box.inv[a];
        at[a] = u < 0.0 ? 0.0 : u > 1.0 ? 1.0 : u;
        position_error[a] = 4.0 * DBL_EPSILON * (fabs(r->o[a]) + fabs(h->t * r->d[a]));
    }
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
    if (!unit_against(smooth, point.normal) && !unit_against(point.gradient, point.normal))
        point.normal[0] = point.normal[1] = point.normal[2] = 0.0f;
    return point;
}
