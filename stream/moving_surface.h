/* moving_surface.h - a surface of triangles in memory whose vertices move, while it is drawn (M08
 * 5.3).
 *
 * It looks like a file of triangles (kind 5) that never was one, at two steps: one is drawn, the
 * other one gets new positions (M08 5.1.2.4). All of its treelets are in memory as rays want them.
 * Triangles lie where they were when it was made; so another step needs no sorting: positions are
 * copied to where treelets have them, then boxes are made anew from the triangles up, treelet by
 * treelet, by several threads. The boxes are exact: rays find what they would in a surface made
 * anew, to the bit, if by more of them the more the motion tears neighbours apart. So are normals,
 * if it has any: they are made anew from the triangles (formats/surface/vertex_normals.h), in the
 * host's order.
 *
 * Triangles have the host's numbers.
 */
#ifndef STREAM_MOVING_SURFACE_H
#define STREAM_MOVING_SURFACE_H

#include "formats/base/pool.h"
#include "formats/leaf/leaf_file.h"
#include "formats/surface/vertex_normals.h"
#include "stream/moving_order.h"
#include "stream/triangle_blocks.h"

enum {
    MOVING_STEPS = 2,
    MOVING_FIELDS_MAX = 2,
    MOVING_TRIANGLES = 4096 /* of a treelet: 8^3 blocks, whose tree is complete */
};

/* Of a treelet: where its vertices begin among all treelets', and its triangles at each step. The
 * masks beside those of step i are field i's: both steps have the same. */
typedef struct moving_treelet {
    size_t first;
    triangle_blocks at[MOVING_STEPS];
} moving_treelet;

typedef struct moving_surface {
    mem *m;
    leaf_file *file;
    pool *threads;
    uint32_t vertices, treelet_count; /* the host's vertices; treelets */
    uint32_t *numbers;                /* of the triangles, in their order, */
    uint32_t *order;                  /* and where those of the host are in it */
    uint16_t (*rows)[3];
    /* Of each treelet's vertices, treelet after treelet: */
    uint32_t *ids;                   /* the host's vertex */
    float *places[MOVING_STEPS];     /* per treelet x[n], y[n], z[n] */
    uint32_t *normals[MOVING_STEPS]; /* NULL: it has none */
    float *values[MOVING_FIELDS_MAX];
    vertex_normals sums; /* of the host's vertices, while they are put */
    moving_treelet *treelets;
} moving_surface;

/* moving_surface_create() - the file, whose two steps are the source's, and all else. Rows are
 * vertices. threads: that an update uses, the caller's among them. The caller closes the file,
 * then destroys the surface. ST_NOMEM tells how much memory would do. */
CHECKED status moving_surface_create(mem *m, const moving_source *src, int threads,
                                     moving_surface **out);
void moving_surface_destroy(moving_surface *s); /* NULL is fine */

/* moving_surface_put() - give a step, which nobody reads, other positions of the host's vertices.
 * ST_USAGE: a position that is not finite, or all of them too near each other; then the step must
 * get others before it is read. */
CHECKED status moving_surface_put(moving_surface *s, uint32_t step, const float (*positions)[3]);

/* moving_surface_find() - where a triangle of the host's is: its treelet, and *local in there. */
uint32_t moving_surface_find(const moving_surface *s, uint64_t number, uint32_t *local);

#endif
