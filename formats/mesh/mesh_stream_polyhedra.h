/* mesh_stream_polyhedra.h - polyhedra of a mesh stream, while it is read (MESH_STREAM.md).
 *
 * A stream is read once, so its header tells how many points polyhedra add. Each is read, adds its
 * points and is fed in parts (mesh_polyhedron.h) before the next one.
 */
#ifndef FORMATS_MESH_MESH_STREAM_POLYHEDRA_H
#define FORMATS_MESH_MESH_STREAM_POLYHEDRA_H

#include "formats/input/byte_stream.h"
#include "formats/mesh/mesh_feed.h"

typedef struct mesh_stream_polyhedra {
    mem *m;
    byte_stream *data;
    uint64_t points;                  /* of the stream: ids are below */
    uint32_t fields;                  /* whose values are fed */
    uint64_t count, numbers, middles; /* as the header tells: see mesh_stream_header */
} mesh_stream_polyhedra;

/* mesh_stream_polyhedra_read() - read and feed all of them. All points and values have been fed,
 * and kept (mesh_feed_keep()) if there are middles. One with an id that is no point is counted as
 * bad, and adds no points. ST_CORRUPT where they are not what the header tells. */
CHECKED status mesh_stream_polyhedra_read(const mesh_stream_polyhedra *s, mesh_feed *feed);

#endif
