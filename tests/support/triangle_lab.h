/* triangle_lab.h - surfaces of triangles to test with, from harmless to hostile. */
#ifndef TESTS_SUPPORT_TRIANGLE_LAB_H
#define TESTS_SUPPORT_TRIANGLE_LAB_H

#include <stdbool.h>
#include <stdint.h>

#include "prep/mesh/mesh_convert.h"
#include "render/leafcast.h"
#include "tests/support/fields.h"

enum { TRIANGLE_LAB_MAX = 4096 };

typedef struct triangle_lab {
    const char *name;
    uint32_t points, triangles;
    float xyz[3 * TRIANGLE_LAB_MAX][3];
    float value[3 * TRIANGLE_LAB_MAX];
    uint32_t corner[TRIANGLE_LAB_MAX][3];
    double about[TRIANGLE_LAB_MAX][4]; /* a ball about each triangle: middle, radius */
    double middle[3], size, edge;      /* of all points; the mean edge */
    bool closed; /* a line that does not graze it crosses it an even number of times */
} triangle_lab;

/* triangle_lab_count() - how many there are. triangle_lab_make() - number n of them. */
int triangle_lab_count(void);
void triangle_lab_make(triangle_lab *s, int n, uint64_t seed);

/* triangle_lab_measure() - points have moved: measure balls, middle, size and edge again. */
void triangle_lab_measure(triangle_lab *s);

/* triangle_lab_ray() - a ray that has a chance to meet the surface, often in an edge or a corner,
 * along an axis, or all but along a triangle. Direction of unit length. */
void triangle_lab_ray(const triangle_lab *s, field_random *r, double o[3], double d[3]);

/* triangle_lab_convert() - a file of it, in treelets of at most so many triangles. Its values have
 the

 * name `name`. */
void triangle_lab_convert(const triangle_lab *s, const char *path, uint32_t treelet,
                          const char *name, bool compressed, mesh_result *result);

#endif
