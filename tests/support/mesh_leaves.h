/* mesh_leaves.h - tets in memory to a treelet file of kind mesh, through leaf_writer: as plain as
 * can be, for tests of the container. */
#ifndef TESTS_SUPPORT_MESH_LEAVES_H
#define TESTS_SUPPORT_MESH_LEAVES_H

#include <stddef.h>
#include <stdint.h>

#include "formats/leaf/leaf_writer.h"

typedef struct mesh_case {
    size_t points, tets;
    float (*xyz)[3];
    float *values; /* set after set, `points` each */
    /* Where mesh.gradients and mesh.moving say so, likewise: of each set; of steps 1, 2, .. */
    float (*gradients)[3], (*moved)[3];
    uint32_t (*ids)[4];
    leaf_mesh mesh; /* but for treelets; fields and steps as set by mesh_leaves_cube() */
    leaf_parameters file;
    int chain; /* trees as deep as can be: a leaf and the rest, at every node */
} mesh_case;

/* mesh_leaves_cube() - n^3 cells of 6 tets each with jittered vertices, in the order of the cells,
 * and waves with noise as values of `fields` fields at `steps` steps, one in `non_finite` of them
 * NaN or inf (0: none). Treelets of up to 50 tets, leaves of up to 3, raw. Release it. */
mesh_case mesh_leaves_cube(uint32_t n, uint32_t fields, uint32_t steps, uint64_t seed,
                           int non_finite);
void mesh_leaves_release(mesh_case *c);

/* mesh_leaves_extend() - what a file may have besides: gradients (any finite numbers), positions
 * that move from step to step if there are steps, names of the fields, times of the steps. */
void mesh_leaves_extend(mesh_case *c, uint64_t seed);

/* mesh_leaves_make() - treelets of `treelet_tets` tets in order, trees of equal parts, to the
 * scratch file of this name; fails the test on an error and on memory not given back. Returns the
 * path. */
const char *mesh_leaves_make(const mesh_case *c, const char *name);

/* mesh_leaves_try() - the same, with a mem, or with the last treelet first; the status. */
status mesh_leaves_try(mem *m, const mesh_case *c, const char *path, int backwards);

#endif
