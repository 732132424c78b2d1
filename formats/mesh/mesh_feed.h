/* mesh_feed.h - buffers, checks and counts between the reader of a format and the sink.
 *
 * A reader says how many points there are, then feeds points, values and cells one at a time or in
 * runs. The feed rounds positions to floats, and refuses positions that are not finite or too close
 * together. It splits cells, and leaves out cells with an id outside the points and tets with a
 * repeated vertex. The report counts all of it.
 */
#ifndef FORMATS_MESH_MESH_FEED_H
#define FORMATS_MESH_MESH_FEED_H

#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_polygon.h"
#include "formats/mesh/mesh_sink.h"

enum { MESH_FEED_CHUNK = 4096 };

/* The buffer of one field's values. */
typedef struct mesh_feed_column {
    float *values;
    size_t held;
    uint64_t given; /* to the sink */
} mesh_feed_column;

/* Points and values that were fed, for readers that make further ones of them. */
typedef struct mesh_feed_kept {
    uint64_t first; /* id of the first one */
    size_t count;
    float (*xyz)[3];
    float *values; /* [fields][count] */
} mesh_feed_kept;

/* The first points, for polygons that may be concave. */
typedef struct mesh_feed_corners {
    bool wanted;
    float (*xyz)[3];
    size_t count, room;
    mesh_polygon_room scratch;
} mesh_feed_corners;

/* Readers use `m`, `points`, `kept` and `report` (skipped, ghosts, field). The rest is private. */
typedef struct mesh_feed {
    mem *m;
    const char *name; /* the file's name, for messages */
    const mesh_sink *sink;
    mesh_report *report;
    uint64_t points; /* in the whole mesh */
    uint64_t cells;  /* in the whole mesh, as far as known */
    uint64_t cells_seen;
    uint64_t points_given;         /* to the sink */
    size_t points_held, tets_held; /* tets, or cells */
    float (*xyz)[3];
    mesh_feed_column *columns; /* of the fields */
    uint32_t fields;
    uint32_t *normals; /* if the sink takes them */
    size_t normals_held;
    uint64_t normals_given; /* to the sink */
    uint32_t (*tets)[4];
    uint32_t (*whole)[CELL_ROW]; /* instead, if the sink takes cells */
    uint32_t (*triangles)[3];    /* instead, if the sink takes triangles */
    const byte_stream *open;     /* the number of points is not known yet; NULL: it is */
    uint64_t highest;            /* of the triangles' ids */
    mesh_feed_corners corners;
    float bounds[6]; /* box of the points so far: lo x, y, z, hi x, y, z */
    mesh_feed_kept kept;
    bool vanished; /* a coordinate that is not 0 was rounded to 0 */
} mesh_feed;

/* mesh_feed_begin() - begin with 1 or more fields, and clear the report. Release in any case. */
CHECKED status mesh_feed_begin(mesh_feed *f, mem *m, const char *name, uint32_t fields,
                               const mesh_sink *sink, mesh_report *report);
void mesh_feed_release(mesh_feed *f);

/* mesh_feed_memory() - returns the bytes that each field takes. */
static inline size_t mesh_feed_memory(void) {
    return MESH_FEED_CHUNK * sizeof(float) + 128;
}

/* mesh_feed_expect() - set the number of points, before any is fed. ST_UNSUPPORTED above
 * MESH_POINTS_MAX. */
CHECKED status mesh_feed_expect(mesh_feed *f, uint64_t points);

/* mesh_feed_expect_open() - instead: the format does not tell the number of points before they have
 * come. Allowed with one field; every value then has its point before it, or mesh_feed_zeros()
 * comes last. An id is checked by mesh_feed_end(): ST_CORRUPT where it is no point's. by: the
 * stream that tells how much has come. */
void mesh_feed_expect_open(mesh_feed *f, const byte_stream *by);

/* mesh_feed_expect_cells() - expect so many more cells. Only mesh_feed_share() uses the number: the
 * file may hold another one, and skipped cells may count or not. */
void mesh_feed_expect_cells(mesh_feed *f, uint64_t cells);

/* mesh_feed_share() - returns how much of the mesh has come, 0 to 1, measured in bytes. Five cells
 * a point are assumed where no reader has said how many there are. */
double mesh_feed_share(const mesh_feed *f);

/* Feed the next points, in order of id; never more than expected. */
CHECKED status mesh_feed_point(mesh_feed *f, const double xyz[3]);
CHECKED status mesh_feed_points(mesh_feed *f, const float (*xyz)[3], size_t count);

/* Feed the next values of a field (0, 1, ..), in order of id; never more than there are points. */
CHECKED status mesh_feed_value(mesh_feed *f, uint32_t field, double value);
CHECKED status mesh_feed_values(mesh_feed *f, uint32_t field, const float *values, size_t count);

/* mesh_feed_takes_normals() - whether the sink takes normals of points.
 * mesh_feed_normal() - feed the next one (triangle_normal.h), in order of id; if any, then as many
 * as points. */
static inline bool mesh_feed_takes_normals(const mesh_feed *f) {
    return f->normals != NULL;
}
CHECKED status mesh_feed_normal(mesh_feed *f, uint32_t code);

/* mesh_feed_zeros() - feed 0 for all values: the mesh has no field. */
CHECKED status mesh_feed_zeros(mesh_feed *f);

/* mesh_feed_keep() - keep the next `count` points that will be fed, and the values of all fields of
 * these, until the next call. 0: nothing more. Takes 12 bytes a point, and 4 a value. */
CHECKED status mesh_feed_keep(mesh_feed *f, uint64_t count);

/* mesh_feed_takes_quadratic() - whether quadratic tets may be fed: the sink takes cells as they
 * are, or by their corners. */
static inline bool mesh_feed_takes_quadratic(const mesh_feed *f) {
    return f->whole != NULL || f->sink->corners;
}

/* mesh_feed_cell() - feed one cell. An invalid id may be passed as any value outside 0 .. points -
 * 1; the cell is then counted as bad. mesh_feed_part() - one with valid ids that is a part of the
 * file's cell: the report counts neither. */
CHECKED status mesh_feed_cell(mesh_feed *f, cell_shape kind, const uint64_t *ids);
CHECKED status mesh_feed_part(mesh_feed *f, cell_shape kind, const uint64_t *ids);
CHECKED status mesh_feed_tets(mesh_feed *f, const uint32_t (*ids)[4], size_t count);

/* mesh_feed_keep_corners() - keep the points that will be fed, for mesh_feed_polygon(). Takes 12
 * bytes a point; stops at MESH_FEED_CORNERS points, or where it would take more than an eighth of
 * what the budget has left. */
enum { MESH_FEED_CORNERS = 1 << 22 };
void mesh_feed_keep_corners(mesh_feed *f);

/* mesh_feed_triangle() - feed one triangle of a surface, to a sink that takes triangles. Ids as of
 * mesh_feed_cell(); one with a repeated vertex is left out and counted.
 * mesh_feed_polygon() - feed a polygon of three or more corners, cut into triangles as
 * mesh_polygon.h says; by a fan, and counted as fanned, unless its corners have come and are kept.
 */
CHECKED status mesh_feed_triangle(mesh_feed *f, const uint64_t ids[3]);
CHECKED status mesh_feed_polygon(mesh_feed *f, const uint64_t *ids, size_t corners);

/* mesh_feed_end() - hand the rest to the sink. All points and values must have been fed (an
 * assert). ST_CORRUPT for a mesh at a place that no treelet file may have (leaf_place.h). */
CHECKED status mesh_feed_end(mesh_feed *f);

/* mesh_feed_magnitude() - returns component 1, 2, .. of a vector; for component 0 its length, or
 * the value itself when there is one component. */
double mesh_feed_magnitude(const double *components, int count, int component);

#endif
