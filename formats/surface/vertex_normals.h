/* vertex_normals.h - normals at the vertices of a surface, made from the triangles around them.
 *
 * A vertex's normal is the sum of the normals of all triangles with a corner at its place, each as
 * long as its area is large. What counts is the place: vertices that lie on one another have one
 * normal, whatever their numbers. Without such a sum, as between two sides of a sheet, there is
 * none. Sums are double, in the order of the triangles: with that, the bits are given.
 */
#ifndef FORMATS_SURFACE_VERTEX_NORMALS_H
#define FORMATS_SURFACE_VERTEX_NORMALS_H

#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/status.h"

/* What has been added up at a place. */
typedef struct vertex_sum {
    float at[3];
    double sum[3];
} vertex_sum;

typedef struct vertex_normals {
    mem *m;
    size_t room;     /* vertices that it can hold */
    size_t count;    /* vertices so far */
    uint32_t places; /* of them, all different */
    vertex_sum *sums;
    uint32_t *place_of; /* of each vertex */
    uint32_t *slots;    /* where places are found */
    size_t mask;
} vertex_normals;

/* vertex_normals_init() - make room for 1 or more vertices; fewer than 2^32 - 1. Release it in any
 * case.
 * vertex_normals_memory() - the bytes that it takes. */
CHECKED status vertex_normals_init(vertex_normals *v, mem *m, size_t room);
size_t vertex_normals_memory(size_t room);
void vertex_normals_release(vertex_normals *v);

/* vertex_normals_begin() - forget all vertices.
 * vertex_normals_put() - put the next one; never more than there is room for. */
void vertex_normals_begin(vertex_normals *v);
void vertex_normals_put(vertex_normals *v, const float at[3]);

/* vertex_normals_add() - add a triangle to the vertices at its corners: those that were put.
 * numbers: of its corners, in the order in which vertices were put; one that was not may have any
 * number of v->count or more. */
void vertex_normals_add(vertex_normals *v, const float corner[3][3], const size_t numbers[3]);

/* vertex_normals_code() - a vertex's normal (triangle_normal.h). */
uint32_t vertex_normals_code(const vertex_normals *v, size_t number);

#endif
