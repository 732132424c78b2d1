#include "render/ray/affine.h"

#include <float.h>
#include <math.h>
#include <string.h>

void affine_init(affine *a, const double to_world[12]) {
    memcpy(a->to_world, to_world, sizeof a->to_world);
    const double(*m)[4] = (const double(*)[4])a->to_world;
    double cofactor[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            cofactor[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    const double determinant =
        m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            a->to_grid[i][j] = cofactor[j][i] / determinant;
}

void affine_point_to_world(const affine *a, const double grid[3], double world[3]) {
    for (int i = 0; i < 3; i++)
        world[i] = a->to_world[i][0] * grid[0] + a->to_world[i][1] * grid[1] +
                   a->to_world[i][2] * grid[2] + a->to_world[i][3];
}

void affine_vector_to_grid(const affine *a, const double world[3], double grid[3]) {
    for (int i = 0; i < 3; i++)
        grid[i] =
            a->to_grid[i][0] * world[0] + a->to_grid[i][1] * world[1] + a->to_grid[i][2] * world[2];
}

void affine_point_to_grid(const affine *a, const double world[3], double grid[3]) {
    /* Subtract the origin first: a volume far from it keeps its digits. */
    const double from_origin[3] = {world[0] - a->to_world[0][3], world[1] - a->to_world[1][3],
                                   world[2] - a->to_world[2][3]};
    affine_vector_to_grid(a, from_origin, grid);
}

double affine_grid_rounding(const affine *a, const double world[3], const double grid[3],
                            int axis) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double size = fabs(world[i]) + fabs(a->to_world[i][3]);
        for (int b = 0; b < 3; b++)
            size += fabs(a->to_world[i][b]) * grid[b];
        sum += fabs(a->to_grid[axis][i]) * size;
    }
    return 4.0 * DBL_EPSILON * sum;
}

double affine_unit(const affine *a, int axis) {
    const double x = a->to_world[0][axis], y = a->to_world[1][axis], z = a->to_world[2][axis];
    return sqrt(x * x + y * y + z * z);
}

void affine_gradient_to_world(const affine *a, const double grid[3], double world[3]) {
    for (int j = 0; j < 3; j++)
        world[j] =
            a->to_grid[0][j] * grid[0] + a->to_grid[1][j] * grid[1] + a->to_grid[2][j] * grid[2];
}
