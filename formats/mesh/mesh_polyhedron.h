/* mesh_polyhedron.h - cells with any number of faces (OpenFOAM, Voronoi meshes), as tets and
 * pyramids about points in their middle.
 *
 * A cell's middle is the mean of its points, and so is that of a face with five corners or more. A
 * value there is the mean of the points' values. A triangle makes a tet with the cell's middle, a
 * quad a pyramid, a larger face a tet of each of its sides, its own middle and the cell's. So a
 * triangle or a quad fits the cells of other shapes that share it. Faces that go round to the left,
 * seen from outside, make parts that are turned as other cells are. A larger face's middle comes
 * out the same, to the bit, in both cells that have it. Its field is continuous: not the one that a
 * solver with a value a cell has, of which there is none at points.
 */
#ifndef FORMATS_MESH_MESH_POLYHEDRON_H
#define FORMATS_MESH_MESH_POLYHEDRON_H

#include "formats/mesh/mesh_feed.h"

typedef struct mesh_polyhedron {
    size_t faces;
    const uint64_t *stream; /* face after face: how many corners, then their ids, around */
    size_t size;            /* numbers of the stream: as the faces say */
} mesh_polyhedron;

/* mesh_polyhedron_fault() - what is wrong with a stream of so many faces, which end where it does;
 * NULL: nothing. */
const char *mesh_polyhedron_fault(const mesh_polyhedron *p);

/* mesh_polyhedron_inside() - whether all ids are below `points`. */
bool mesh_polyhedron_inside(const mesh_polyhedron *p, uint64_t points);

/* mesh_polyhedron_ids() - the ids of its points, each once, ascending. Returns how many. ids: room
 * for size. */
size_t mesh_polyhedron_ids(const mesh_polyhedron *p, uint64_t *ids);

/* Room for what follows. Start with {.m = budget}; free .ids and .points. */
typedef struct mesh_polyhedron_point {
    float at[3];
    uint64_t id;
} mesh_polyhedron_point;
typedef struct mesh_polyhedron_room {
    mem *m;
    uint64_t *ids;
    mesh_polyhedron_point *points;
    size_t room;
} mesh_polyhedron_room;
CHECKED status mesh_polyhedron_reserve(mesh_polyhedron_room *r, const mesh_polyhedron *p);
void mesh_polyhedron_release(mesh_polyhedron_room *r);

/* mesh_polyhedron_middles() - how many points it adds.
 * mesh_polyhedron_feed_middles() - feed these, with the values of `fields` fields. All its points
 * have been kept (mesh_feed_keep()), ids count from the first one kept. r: reserved for it.
 * mesh_polyhedron_feed() - feed its tets and pyramids. first: what to add to ids; middle: the id of
 * the first point that it added. */
uint64_t mesh_polyhedron_middles(const mesh_polyhedron *p);
CHECKED status mesh_polyhedron_feed_middles(const mesh_polyhedron *p, mesh_feed *f, uint32_t fields,
                                            mesh_polyhedron_room *r);
CHECKED status mesh_polyhedron_feed(const mesh_polyhedron *p, mesh_feed *f, uint64_t first,
                                    uint64_t middle);

#endif
