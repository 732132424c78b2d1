#include "render/priority.h"

#include <string.h>

/* ---- Grids ---- */

/* The treelet of the level-0 grid that a coordinate falls into; outside, the one beyond. */
static int64_t treelet_of(const tracer *tr, int a, double x) {
    const level_planes *planes = &tr->scene.levels[0];
    uint32_t lo = 0, hi = planes->cells[a];
    if (!(x > planes->at[a][0]))
        return -1;
    if (!(x < planes->at[a][hi]))
        return tr->layout->level[0].treelets[a];
    while (hi - lo > 1) {
        const uint32_t middle = lo + (hi - lo) / 2;
        if (planes->at[a][middle] <= x)
            lo = middle;
        else
            hi = middle;
    }
    return lo >> tr->layout->cells_log2;
}

static uint32_t grid_rank(const frame *f, uint32_t t, const leafcast_light *light) {
    const tracer *tr = f->tracer;
    const uint32_t level = tr->layout->level_of[t];
    const int64_t far = (int64_t)1 << 24; /* more than any place */
    double from[3], towards[3] = {0.0, 0.0, 0.0};
    affine_point_to_grid(&tr->space, light && light->point ? light->vector : f->camera.eye, from);
    if (light && !light->point)
        affine_vector_to_grid(&tr->space, light->vector, towards);
    int64_t rank = 0;
    for (int a = 0; a < 3; a++) {
        const int64_t place = (int64_t)tr->layout->place[t][a] << level;
        if (light && !light->point) {
            /* Along the light's direction. */
            rank += towards[a] > 0.0 ? place : far - place;
            continue;
        }
        /* A ray only moves away from the eye's treelet on every axis (and towards a light's), so
         * the Manhattan distance rises. Of a coarse treelet: from the one of its level there. */
        const int64_t size = (int64_t)1 << level;
        const int64_t centre = (treelet_of(tr, a, from[a]) >> level) * size;
        const int64_t distance = place > centre ? place - centre : centre - place;
        rank += light ? far - distance : distance;
    }
    return (uint32_t)rank;
}

/* ---- Meshes ---- */

/* Numbers in the order of floats. */
static uint32_t ordered(double x) {
    const float f = (float)x;
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    return bits >> 31 ? ~bits : bits | 1u << 31;
}

/* The square of the distance from a point to a box. */
static double distance_to(const float bounds[6], const double from[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++) {
        const double below = (double)bounds[a] - from[a], above = from[a] - (double)bounds[a + 3];
        const double outside = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += outside * outside;
    }
    return sum;
}

/* Where a box begins in a direction. */
static double along(const float bounds[6], const double direction[3]) {
    double sum = 0.0;
    for (int a = 0; a < 3; a++)
        sum += direction[a] * (double)bounds[direction[a] > 0.0 ? a : a + 3];
    return sum;
}

static uint32_t mesh_rank(const frame *f, uint32_t t, const leafcast_light *light) {
    const float *bounds = f->tracer->tree->bounds[0][t];
    if (!light)
        return ordered(distance_to(bounds, f->camera.eye));
    if (!light->point)
        return ordered(along(bounds, light->vector));
    return ~ordered(distance_to(bounds, light->vector));
}

uint64_t priority_of(const frame *f, uint32_t t, int32_t light_index) {
    const leafcast_light *light =
        light_index == PRIORITY_PRIMARY ? NULL : &f->scene->lights[light_index];
    const uint32_t rank = (f->tracer->tree ? mesh_rank : grid_rank)(f, t, light);
    return (uint64_t)(light_index + 1) << 32 | rank;
}
