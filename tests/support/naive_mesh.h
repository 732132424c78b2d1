/* naive_mesh.h - a second reader of treelet files of meshes, written from formats/FORMAT.md 6
 * alone: slow, whole, and strict.
 *
 * Holds the file in memory and recomputes whatever the format says about every byte: padding,
 * offsets, checksums, bounds, ranges, trees, codes.
 */
#ifndef TESTS_SUPPORT_NAIVE_MESH_H
#define TESTS_SUPPORT_NAIVE_MESH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct naive_part { /* a treelet */
    long tets, vertices, nodes, leaves;
    float bounds[6];
    float (*positions)[3];
    float *values; /* set after set, `vertices` each */
    long (*tet)[4];
} naive_part;

typedef struct naive_mesh {
    long tets, vertices, treelets, sets, treelet_tets, leaf_tets, fields, steps;
    int run_align_log2, codec;
    naive_part *part;
    unsigned char *bytes; /* the file */
    size_t size;
    char why[256]; /* what is wrong with it */
} naive_mesh;

/* naive_mesh_load() - read and check everything; false: mesh->why says what is wrong. Release it
 * either way. */
bool naive_mesh_load(naive_mesh *mesh, const char *path);
void naive_mesh_release(naive_mesh *mesh);

#endif
