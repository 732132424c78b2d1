/* mesh_polygon.h - a polygon cut into triangles of its corners.
 *
 * A convex polygon becomes a fan around its first corner. A concave one is cut by ears (Meisters,
 * Amer. Math. Monthly 82, 1975), in double, seen along the axis nearest to the normal of its
 * best-fit plane (Newell's). Each has two triangles less than corners, which turn as it does.
 */
#ifndef FORMATS_MESH_MESH_POLYGON_H
#define FORMATS_MESH_MESH_POLYGON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "formats/base/mem.h"

/* Polygons of more corners become fans: ears take the square of their number. */
enum { MESH_POLYGON_EARS = 512 };

/* Begin with the mem set. */
typedef struct mesh_polygon_room {
    mem *m;
    double (*xyz)[3];   /* of the corners, set by the caller */
    uint32_t (*cut)[3]; /* the triangles: corners, from 0 */
    size_t room;
} mesh_polygon_room;

/* mesh_polygon_reserve() - make room for a polygon of so many corners. */
CHECKED status mesh_polygon_reserve(mesh_polygon_room *r, size_t corners);
void mesh_polygon_release(mesh_polygon_room *r);

/* mesh_polygon_cut() - cut a polygon of three or more corners. known: xyz is set. Returns false
 * where it became a fan unseen: its corners are not known, or too many. */
bool mesh_polygon_cut(mesh_polygon_room *r, size_t corners, bool known);

#endif
