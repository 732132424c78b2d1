/* mesh_normals.h - normals at the vertices of a surface, made from its triangles
 * (formats/surface/vertex_normals.h), in bands of as many vertices as there is room for. The
 * triangles are passed once for each band:
 *
 *     for (uint64_t band = 0; st == ST_OK && band < mesh_normals_bands(n); band++) {
 *         mesh_normals_begin(n, band, point)
 *         for all records, some at a time: mesh_normals_add(n, records, count)
 *         mesh_normals_end(n, normals)
 *     }
 *
 * The bits depend on the order of the records alone, not on the bands.
 */
#ifndef PREP_MESH_MESH_NORMALS_H
#define PREP_MESH_MESH_NORMALS_H

#include "formats/surface/vertex_normals.h"
#include "prep/mesh/mesh_pages.h"
#include "prep/mesh/mesh_sort.h"

typedef struct mesh_normals_plan {
    uint64_t band;          /* vertices */
    uint64_t points_window; /* bytes of the window on spilled points */
} mesh_normals_plan;

typedef struct mesh_normals {
    vertex_normals at;
    mesh_pages points;
    uint64_t vertices, band;
    uint64_t first; /* of the band */
} mesh_normals;

/* mesh_normals_plan_make() - the fastest plan for so many vertices that takes at most `room` bytes,
 * or else the smallest one. paged: points will be in a file.
 * mesh_normals_memory() - bytes that a plan takes. */
mesh_normals_plan mesh_normals_plan_make(const mesh_spool *points, uint64_t vertices, bool paged,
                                         uint64_t room);
uint64_t mesh_normals_memory(const mesh_normals_plan *plan);

/* mesh_normals_init() - release it in any case. */
CHECKED status mesh_normals_init(mesh_normals *n, mem *m, mesh_spool *points, uint64_t vertices,
                                 const mesh_normals_plan *plan);
void mesh_normals_release(mesh_normals *n);

/* mesh_normals_bands() - how many there are. mesh_normals_begin() - point: the index of vertex 0
 * among the points. mesh_normals_end() - append the band's normals. */
uint64_t mesh_normals_bands(const mesh_normals *n);
CHECKED status mesh_normals_begin(mesh_normals *n, uint64_t band, uint64_t point);
CHECKED status mesh_normals_add(mesh_normals *n, const mesh_record *records, size_t count);
CHECKED status mesh_normals_end(mesh_normals *n, mesh_spool *to);

#endif
