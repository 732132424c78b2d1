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

#include "tests/support/naive_sections.h"

typedef struct naive_part { /* a treelet */
    long tets, vertices, nodes, leaves;
    float (*bounds)[6];    /* of each step, or of the first alone where nothing moves */
    float (*positions)[3]; /* likewise, `vertices` each */
    float *values;         /* set after set, `vertices` each */
    float (*gradients)[3]; /* likewise, or none */
    long (*tet)[4];
} naive_part;

typedef struct naive_mesh {
    long tets, vertices, treelets, sets, treelet_tets, leaf_tets, fields, steps;
    long gradient_sets, places; /* sets or 0; steps or 1: how many positions a vertex has */
    int run_align_log2, codec;
    char (*names)[64]; /* of fields, or NULL */
    double *times;     /* of steps, or NULL */
    naive_part *part;
    unsigned char *bytes; /* the file */
    size_t size;
    const struct naive_mesh *before; /* the segments before this one, */
    long segments_before;            /* and how many; 0: it is a file, or the first one */
    bool grows;                      /* it is a segment */
    naive_sections sections;
    char why[256]; /* what is wrong with it */
} naive_mesh;

/* naive_mesh_read() - the same of a segment whose bytes are there, and what is before it; all else
 * is zeros.
 * naive_mesh_load() - read and check everything; false: mesh->why says what is wrong. Release it
 * either way. */
bool naive_mesh_read(naive_mesh *mesh);
bool naive_mesh_load(naive_mesh *mesh, const char *path);
void naive_mesh_release(naive_mesh *mesh);

#endif
