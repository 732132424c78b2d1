/* triangle_kernel.h - a triangle of a surface, and where a ray meets it: the scalar truth.
 *
 * A triangle is a flat_polygon whose points are ranked by their coordinates, x before y before z.
 * So two triangles with an edge in common agree about its ends wherever they have them from: as one
 * vertex, as two at one place, from two treelets or files. No ray slips through between them, and
 * one through the edge meets it at one t: flat_polygon.h. So do two triangles of the same three
 * points, in whatever order these come: the one of the lowest rank is the first.
 *
 * Of several triangles met at one t, those seen from the front count as one crossing, those seen
 * from behind as another, behind it; each has the colour of the lowest number. So a sheet of two
 * sides, triangles back to back, has on either side what faces it. Neighbours that turn differently
 * are two crossings on the edge between them.
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
    bool smooth;
    uint32_t normal[3]; /* of the vertices, if it is smooth (triangle_normal.h) */
} triangle;

/* The unit normals at the vertices of a triangle, and what tells the vertices' shares at a point.
 */
typedef struct triangle_smooth {
    bool any; /* false: it is flat */
    double at[3][3];
    int u, v; /* the axes along which it is seen largest, and from there: */
    double corner[3], by[2][2];
} triangle_smooth;

/* triangle_less() - the order of hits of one ray on triangles: (t, iso, front first, number). */
static inline bool triangle_less(const hit *a, const hit *b) {
    if (a->t != b->t)
        return a->t < b->t;
    if (a->iso != b->iso)
        return a->iso < b->iso;
    return a->entering != b->entering ? a->entering : a->cell < b->cell;
}

/* triangle_is_before() - whether a point's rank is lower. */
static inline bool triangle_is_before(const float a[3], const float b[3]) {
    for (int k = 0; k < 2; k++)
        if (a[k] != b[k])
            return a[k] < b[k];
    return a[2] < b[2];
}

/* triangle_corners_from - the corners of a triangle turned over, as rays meet it, if this one has
 * the lowest rank. */
static const uint8_t triangle_corners_from[3][3] = {{0, 2, 1}, {1, 0, 2}, {2, 1, 0}};

/* triangle_polygon() - the triangle as rays meet it. */
void triangle_polygon(const triangle *x, flat_polygon *out);

/* triangle_flat_facts() - what all rays that meet a triangle have in common. */
flat_facts triangle_flat_facts(const triangle *x);

/* triangle_smooth_of() - a triangle is flat if one of its vertices has no normal.
 * triangle_smooth_normal() - set the normal at a point where a ray meets a smooth triangle: those
 * of the vertices, linear in between, of unit length, turned to the side of the triangle's own. One
 * that the eye could not see is bent as far as to where it is just seen, so that silhouettes stay
 * lit from the eye's side. normal: the triangle's own; left alone if the sum has no direction.
 * It is for shading alone: hits, sides, and where shadows and mirrored rays begin are the
 * triangle's. */
triangle_smooth triangle_smooth_of(const triangle *x);
void triangle_smooth_normal(const triangle_smooth *s, const ray *r, double t, float normal[3]);

/* triangle_point() - the point of a hit. coloured: values are packed colours (triangle_geometry.h).
 * Values and colours are linear between the vertices, colours as light. */
surface_point triangle_point(const triangle *x, const ray *r, const hit *h, bool coloured);

/* triangle_values() - set `own` of a point where facts are known already. */
void triangle_values(const triangle *x, const ray *r, double t, bool coloured, surface_point *out);

#endif
