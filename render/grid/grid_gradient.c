#include "render/grid/grid_gradient.h"

#include <math.h>

#include "render/grid/surface.h"

/* Returns the treelet's cell between whose planes x lies, or the nearest one. planes: from the
 * treelet's first cell on. */
static uint32_t cell_at(const double planes[], uint32_t cells, double x) {
    const double guess = (x - planes[0]) / (planes[cells] - planes[0]) * cells;
    uint32_t i = guess > 0.0 ? (uint32_t)fmin(guess, (double)(cells - 1)) : 0;
    while (i + 1 < cells && planes[i + 1] <= x)
        i++;
    while (i > 0 && planes[i] > x)
        i--;
    return i;
}

/* Find the cell that holds the middle of a piece, and where the piece begins and ends in it. */
static void find_cell(const level_planes *planes, const resident_grid *at, const ray *r,
                      const segment *s, uint32_t cell[3], cell_visit *visit) {
    const double t = 0.5 * (s->t0 + s->t1);
    *visit = (cell_visit){.t_in = s->t0, .t_out = s->t1};
    for (int a = 0; a < 3; a++) {
        const uint32_t first = at->first_cell[a];
        cell[a] = first + cell_at(planes->at[a] + first, at->shape.cells[a], r->o[a] + t * r->d[a]);
        const double lo = planes->at[a][cell[a]] - r->o[a], inverse = planes->inverse[a][cell[a]];
        visit->in[a] = fmin(fmax((s->t0 * r->d[a] - lo) * inverse, 0.0), 1.0);
        visit->out[a] = fmin(fmax((s->t1 * r->d[a] - lo) * inverse, 0.0), 1.0);
    }
}

/* Compute the differences along the cell's edges. Their trilinear form is the gradient of the
 * samples' trilinear form. */
static void own_gradients(const walk_scene *scene, const resident_grid *at, const uint32_t cell[3],
                          double gradients[8][4]) {
    const level_planes *planes = &scene->levels[at->level];
    float samples[8];
    walk_cell_samples(scene, at, cell, samples);
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            gradients[i][a] = ((double)samples[i | 1 << a] - (double)samples[i & ~(1 << a)]) *
                              planes->inverse[a][cell[a]];
}

static bool all_finite(double gradients[8][4]) {
    double sum = 0.0;
    for (int i = 0; i < 8; i++)
        sum += 0.0 * (gradients[i][0] + gradients[i][1] + gradients[i][2]);
    return sum == 0.0;
}

void grid_gradient(const tracer *tr, const treelet *treelet_at, const ray *r, const segment *s,
                   segment_gradient *out) {
    const walk_scene *scene = tr->own;
    const resident_grid *at = resident_grid_of(treelet_at);
    double corners[8][4], along[3][4], b[3][4];
    uint32_t cell[3];
    cell_visit visit;
    find_cell(&scene->levels[at->level], at, r, s, cell, &visit);
    const bool central = !scene->analytic_normals && scene->halo > 0;
    if (central)
        surface_gradients(scene, at, cell, corners);
    if (!central || !all_finite(corners))
        own_gradients(scene, at, cell, corners);
    for (int a = 0; a < 3; a++) {
        double component[8];
        for (int i = 0; i < 8; i++)
            component[i] = corners[i][a];
        cell_blossom(&visit, component, along[a]);
    }
    for (int i = 0; i < 4; i++) {
        const double grid[3] = {along[0][i], along[1][i], along[2][i]};
        double world[3];
        affine_gradient_to_world(&tr->space, grid, world);
        for (int a = 0; a < 3; a++)
            b[a][i] = world[a];
    }
    *out = segment_gradient_of((const double(*)[4])b);
}
