/* mesh_feed.h - what stands between the reader of a format and the sink: buffers, checks and
 * counts.
 *
 * A reader says how many points there are, then feeds points, values and cells one at a time or in
 * runs. The feed rounds positions to floats and refuses what is not finite or too close together,
 * splits cells, leaves out cells with an id that is no point and tets with a repeated vertex, and
 * counts all of it in the report.
 */
#ifndef FORMATS_MESH_MESH_FEED_H
#define FORMATS_MESH_MESH_FEED_H

#include "formats/mesh/mesh_sink.h"

enum { MESH_FEED_CHUNK = 4096 };

/* The values of a field on their way. */
typedef struct mesh_feed_column {
    float *values;
    size_t held;
    uint64_t given; /* to the sink */
} mesh_feed_column;

/* The fields are the feed's own, but for `report` (skipped, field) and `m`, which readers use. */
typedef struct mesh_feed {
    mem *m;
    const char *name; /* of the file, for messages */
    const mesh_sink *sink;
    mesh_report *report;
    uint64_t points; /* in the whole mesh */
    uint64_t cells;  /* likewise, as far as is known */
    uint64_t cells_seen;
    uint64_t points_given; /* to the sink */
    size_t points_held, tets_held;
    float (*xyz)[3];
    mesh_feed_column *columns; /* of the fields */
    uint32_t fields;
    uint32_t (*tets)[4];
    float bounds[6]; /* of the points so far: lo x, y, z, hi x, y, z */
    bool vanished;   /* a coordinate was too small for a float, and none that is 0 */
} mesh_feed;

/* mesh_feed_begin() - for so many fields, 1 or more. Clears the report. Release in any case. */
CHECKED status mesh_feed_begin(mesh_feed *f, mem *m, const char *name, uint32_t fields,
                               const mesh_sink *sink, mesh_report *report);
void mesh_feed_release(mesh_feed *f);

/* mesh_feed_memory() - bytes that it takes for a field. */
static inline size_t mesh_feed_memory(void) {
    return MESH_FEED_CHUNK * sizeof(float) + 128;
}

/* mesh_feed_expect() - the number of points, known before the first cell. ST_UNSUPPORTED above
 * MESH_POINTS_MAX. */
CHECKED status mesh_feed_expect(mesh_feed *f, uint64_t points);

/* mesh_feed_expect_cells() - so many more, for mesh_feed_share() alone: what is in the file may
 * differ, and those that are passed over may count or not. */
void mesh_feed_expect_cells(mesh_feed *f, uint64_t cells);

/* mesh_feed_share() - how much of the mesh has come, 0 to 1, by the bytes it takes; where no reader
 * has said how many cells there are, as if there were five to a point. */
double mesh_feed_share(const mesh_feed *f);

/* The next points, in order of id; not more than were expected. */
CHECKED status mesh_feed_point(mesh_feed *f, const double xyz[3]);
CHECKED status mesh_feed_points(mesh_feed *f, const float (*xyz)[3], size_t count);

/* The next values of a field, 0, 1, .., in order of id; not more than there are points. */
CHECKED status mesh_feed_value(mesh_feed *f, uint32_t field, double value);
CHECKED status mesh_feed_values(mesh_feed *f, uint32_t field, const float *values, size_t count);

/* mesh_feed_zeros() - all values are 0: there is no field. */
CHECKED status mesh_feed_zeros(mesh_feed *f);

/* mesh_feed_cell() - one cell; an id that is no point may have any value that is none. */
CHECKED status mesh_feed_cell(mesh_feed *f, mesh_cell kind, const uint64_t *ids);
CHECKED status mesh_feed_tets(mesh_feed *f, const uint32_t (*ids)[4], size_t count);

/* mesh_feed_end() - the rest goes to the sink; all points and values must have been fed (an
 * assert). ST_CORRUPT for a mesh whose place no treelet file may have (leaf_place.h). */
CHECKED status mesh_feed_end(mesh_feed *f);

/* mesh_feed_magnitude() - of a vector array: component 1, 2, .. or, for 0, the length (the value
 * itself when there is one component). */
double mesh_feed_magnitude(const double *components, int count, int component);

#endif
