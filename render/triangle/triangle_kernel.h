/* triangle_kernel.h - a triangle of a surface, and where a ray meets it: the scalar truth.
 *
 * A triangle is a flat_polygon whose points are ranked by their coordinates, x before y before z.
 * So two triangles with an edge in common agree about its ends wherever they have them from: as one
 * vertex, as two at one place, from two treelets or files. No ray slips through between them, and
 * one through the edge meets it at one t: flat_polygon.h. Of several triangles there, the one of
 * the lowest number counts.
 *
 * The normal is that of the right-hand rule: in most files it points out of what the surface is
 * around. A ray that goes against it enters; the gradient of surface_point is against it, too, of
 * unit length.
 */
#ifndef RENDER_TRIANGLE_TRIANGLE_KERNEL_H
#define RENDER_TRIANGLE_TRIANGLE_KERNEL_H

#include "render/flat/flat_point.h"
#include "render/flat/flat_polygon.h"

typedef struct triangle {
    float p[3][3]; /* finite; in the file's order */
    float value[3];
} triangle;

/* triangle_polygon() - the triangle turned over, as rays meet it: its points are 0, 2, 1. */
void triangle_polygon(const triangle *x, flat_polygon *out);

/* triangle_flat_facts() - what all rays that meet a triangle have in common. */
flat_facts triangle_flat_facts(const triangle *x);

/* triangle_point() - the point of a hit. coloured: values are packed colours (triangle_geometry.h).
 * Values and colours are linear between the vertices, colours as light. */
surface_point triangle_point(const triangle *x, const ray *r, const hit *h, bool coloured);

/* triangle_values() - set `own` of a point where facts are known already. */
void triangle_values(const triangle *x, const ray *r, double t, bool coloured, surface_point *out);

#endif
