/* affine.h - grid space to world space and back; rows are (M | origin) as in a grid's to_world. */
#ifndef RENDER_RAY_AFFINE_H
#define RENDER_RAY_AFFINE_H

typedef struct affine {
    double to_world[3][4];
    double to_grid[3][3]; /* inverse of the linear part */
} affine;

/* affine_init() - to_world: 12 doubles, invertible (a leaf file's header was checked to be). */
void affine_init(affine *a, const double to_world[12]);

void affine_point_to_world(const affine *a, const double grid[3], double world[3]);
void affine_point_to_grid(const affine *a, const double world[3], double grid[3]);
void affine_vector_to_grid(const affine *a, const double world[3], double grid[3]);

/* affine_grid_rounding() - how far rounding may bring a coordinate of affine_point_to_grid() off,
 * and bring a point of grid space with these moduli of coordinates off that was taken to world
 * space. */
double affine_grid_rounding(const affine *a, const double world[3], const double grid[3], int axis);

/* affine_unit() - the world length of one unit of grid space along an axis. */
double affine_unit(const affine *a, int axis);

/* affine_gradient_to_world() - gradients transform with the inverse transpose. */
void affine_gradient_to_world(const affine *a, const double grid[3], double world[3]);

#endif
