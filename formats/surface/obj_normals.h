/* obj_normals.h - which normals the corners of an OBJ file's faces give its vertices.
 *
 * A vertex of several normals becomes several points at one place: the first with the normal that a
 * face names first, the others behind all points so far. For that, points are kept: 12 bytes each,
 * 8 for a colour, and from the first normal on another 16. They are not as soon as that would take
 * more than an eighth of what the budget has left; a normal is refused then. Vertices stand before
 * the faces that use them.
 */
#ifndef FORMATS_SURFACE_OBJ_NORMALS_H
#define FORMATS_SURFACE_OBJ_NORMALS_H

#include "formats/surface/surface_flow.h"

/* A point, once there are normals. */
typedef struct obj_point {
    uint32_t normal; /* triangle_normal.h */
    bool has;        /* a face has said so: maybe that there is none */
    uint32_t next;   /* the next point of its vertex; UINT32_MAX: it is the last */
} obj_point;

typedef struct obj_normals {
    mem *m;
    surface_flow *flow; /* NULL: normals are not taken */
    bool coloured;
    bool unkept;     /* there was no room for points */
    uint32_t *codes; /* of the file's normals */
    size_t count, code_room;
    /* Of each point: */
    float (*xyz)[3];
    double *colours;
    obj_point *points; /* if there are normals */
    size_t held, xyz_room, colour_room, points_count, points_room;
    /* The first point of each vertex, if there are normals: else its number. */
    uint32_t *first;
    size_t vertices, first_room;
} obj_normals;

/* obj_normals_begin() - flow: whose feed may take normals. Release it in any case. */
void obj_normals_begin(obj_normals *n, mem *m, surface_flow *flow, bool coloured);
void obj_normals_release(obj_normals *n);

/* obj_normals_add() - the file's next normal. obj_normals_vertex() - its next vertex, whose point
 * was put, with its colour. */
CHECKED status obj_normals_add(obj_normals *n, const double normal[3]);
CHECKED status obj_normals_vertex(obj_normals *n, const double xyz[3], double colour);

/* obj_normals_point() - set *point to the point of a vertex with a normal: numbers from 0 on of
 * what has come, or UINT64_MAX: no normal. A new point is put, with its colour. */
CHECKED status obj_normals_point(obj_normals *n, uint64_t vertex, uint64_t normal, uint64_t *point);

/* obj_normals_end() - put the normals of all points, if the file has any. */
CHECKED status obj_normals_end(obj_normals *n);

#endif
