/* surface_flow.h - what readers of surfaces share on the way to the feed: values of faces, and
 * pieces.
 *
 * Fields of faces are constant on them: each triangle then gets three points of its own. For that
 * the points of a piece are kept, 12 bytes each and 4 a value of theirs. With --cells-to-points
 * they are averaged to the points instead (mesh_average.h). Without fields of faces nothing is kept
 * but corners of polygons (mesh_feed_keep_corners()).
 *
 * The reader goes through its pieces: all points of one, their values, and its faces. Ids count
 * from the piece's first point.
 */
#ifndef FORMATS_SURFACE_SURFACE_FLOW_H
#define FORMATS_SURFACE_SURFACE_FLOW_H

#include "formats/mesh/mesh_average.h"
#include "formats/surface/surface_choice.h"

/* The most corners of a polygon. */
enum { SURFACE_CORNERS_MAX = 1 << 20 };

typedef struct surface_column {
    float *values;
    size_t count, room;
} surface_column;

typedef struct surface_flow {
    mesh_feed *feed;
    const surface_choice *choice;
    mem *m;
    bool apart, averaged;
    bool dry;               /* points of triangles are counted, nothing is fed */
    uint64_t base;          /* points of the pieces before */
    uint64_t count;         /* of this piece; UINT64_MAX: not known */
    uint64_t fed, expected; /* apart: points of triangles */
    mesh_average sums;
    float (*xyz)[3]; /* apart: of the piece */
    size_t held, room;
    uint32_t *normals; /* apart: of its points, if it has any */
    size_t normals_held, normals_room;
    surface_column *columns; /* apart: the points' values, a column for each field that is taken */
    mesh_polygon_room polygon;
} surface_flow;

/* surface_flow_expect_polygons() - keep corners for polygons of four or more (mesh_feed.h), before
 * surface_flow_run(). For formats that may have such. */
void surface_flow_expect_polygons(const surface_choice *choice, mesh_feed *feed);

/* Goes through a surface; called twice where its triangles must be counted first. */
typedef status surface_pass(void *state, surface_flow *flow);

/* surface_flow_run() - feed a surface. points: of all pieces; UINT64_MAX: not known. again: the
 * pass may be called twice; otherwise ST_UNSUPPORTED for several fields of which one is of faces.
 */
CHECKED status surface_flow_run(const surface_choice *choice, mesh_feed *feed, uint64_t points,
                                bool again, surface_pass *pass, void *state);

/* ---- for the pass ---- */

/* surface_flow_piece() - begin a piece of so many points; UINT64_MAX: not known.
 * surface_flow_end_piece() - all of it has come. */
CHECKED status surface_flow_piece(surface_flow *f, uint64_t points);
CHECKED status surface_flow_end_piece(surface_flow *f);

/* Put the next point, or the next value of the k-th field taken, which must be one of the points.
 */
CHECKED status surface_flow_point(surface_flow *f, const double xyz[3]);
CHECKED status surface_flow_value(surface_flow *f, uint32_t k, double value);

/* surface_flow_normal() - put the normal of the next point, of any length, or without a direction:
 * if any, then of all points of all pieces; before the faces where surface_choice_apart(). Only if
 * the feed takes normals (mesh_feed_takes_normals()). surface_flow_no_normals() - put `count` that
 * are none. */
CHECKED status surface_flow_normal(surface_flow *f, const double normal[3]);
CHECKED status surface_flow_no_normals(surface_flow *f, uint64_t count);

/* Put a face. values: of the fields taken; those of the points are not looked at; may be NULL when
 * there is none of faces. Ids that are invalid, and corners that repeat, count in the report; so do
 * faces of fewer than three corners, as skipped. surface_flow_skip() - count so many vertices or
 * edges that are not taken. */
CHECKED status surface_flow_polygon(surface_flow *f, const uint64_t *ids, size_t corners,
                                    const double *values);
void surface_flow_skip(surface_flow *f, uint64_t count);

/* The triangles of a strip. Begin with zeros, and put its ids one by one. */
typedef struct surface_strip {
    uint64_t ids[2], count;
} surface_strip;
CHECKED status surface_flow_strip(surface_flow *f, surface_strip *s, uint64_t id,
                                  const double *values);

#endif
