/* ply_surface.h - a naive reader of the PLY surfaces that leafcast writes, and what a surface is
 * asked about in tests. Trouble fails the running test.
 */
#ifndef TESTS_SUPPORT_PLY_SURFACE_H
#define TESTS_SUPPORT_PLY_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct ply_surface {
    size_t vertices, triangles;
    double (*at)[3];
    float (*normal)[3];
    double *isovalue; /* NULL: the file has none */
    uint32_t (*corner)[3];
} ply_surface;

/* ply_surface_read() - the bytes of a file; release it. */
ply_surface ply_surface_read(const char *bytes, size_t size);
void ply_surface_release(ply_surface *s);

/* What its sides are: a side goes from a corner to the next one. */
typedef struct ply_sides {
    size_t sides;       /* between different vertices, counted once however turned */
    size_t repeated;    /* there more than once, turned the same way */
    size_t open;        /* without one turned the other way */
    uint32_t (*rim)[2]; /* the open ones; free it */
} ply_sides;
ply_sides ply_surface_sides(const ply_surface *s);

/* ply_surface_euler() - vertices - sides + triangles; all vertices are in a triangle, else the test
 * fails. */
long ply_surface_euler(const ply_surface *s);

/* ply_surface_fans() - vertices whose triangles do not follow one another in a single fan. */
size_t ply_surface_fans(const ply_surface *s);

#endif
