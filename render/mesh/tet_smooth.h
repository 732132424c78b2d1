/* tet_smooth.h - smooth normals of isopolygons: interpolated between the gradients at the mesh's
 * vertices (W07 7, M08 6.3.4). Faceted normals come from the tet alone.
 *
 * Along a cut edge, gradients change as the values do. Between the polygon's points, each point's
 * gradient is weighted by the area of the triangle between the place and two other points. A
 * polygon is flat and the interpolation in a tet linear, so this is the barycentric one, for
 * slivers too.
 *
 * These normals affect shading alone. What is hit, where, and from which side, never depends on
 * them. + - * / sqrt in a fixed order, so all ways to a pixel have the same bits.
 */
#ifndef RENDER_MESH_TET_SMOOTH_H
#define RENDER_MESH_TET_SMOOTH_H

#include "render/mesh/tet_kernel.h"

/* What the rays that hit a polygon have in common. */
typedef struct tet_smooth {
    isopolygon g;
    double across[3];      /* normal of its plane, any length; 0: it has none */
    double gradient[4][3]; /* at its points */
} tet_smooth;

/* tet_smooth_of() - gradients: at the tet's vertices; g: from isopolygon_of(). */
void tet_smooth_of(const tet *x, double iso, const isopolygon *g, const float gradients[4][3],
                   tet_smooth *out);

/* tet_smooth_normal() - gives the normal at o + t d, a point of the polygon (to rounding): unit,
 * against the gradient. Returns false, and leaves normal untouched, if the gradient is 0 or not
 * finite. */
bool tet_smooth_normal(const tet_smooth *s, const double o[3], const double d[3], double t,
                       float normal[3]);

#endif
