/* naive_surface.h - a second reader of treelet files of surfaces, written from formats/TRIANGLES.md
 * and what it refers to alone: slow, whole, and strict. Of files that have not grown.
 */
#ifndef TESTS_SUPPORT_NAIVE_SURFACE_H
#define TESTS_SUPPORT_NAIVE_SURFACE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "tests/support/naive_sections.h"

typedef struct naive_patch { /* a treelet */
    long triangles, vertices;
    bool smooth;        /* it has normals */
    float (*normal)[3]; /* of each step, or of the first alone: unit vectors; 0 0 0: none */
    float *xyz;    /* of each step, or of the first alone where nothing moves: x, then y, then z */
    float *values; /* set after set */
    long (*row)[3];
} naive_patch;

typedef struct naive_surface {
    long triangles, vertices, treelets, treelet_triangles, fields, steps, sets;
    long places; /* steps or 1: how many positions a vertex has */
    int run_align_log2, codec;
    naive_patch *patch;
    unsigned char *bytes; /* the file */
    size_t size;
    naive_sections sections;
    char why[256]; /* what is wrong with it */
} naive_surface;

/* naive_surface_load() - read and check everything; false: s->why says what is wrong. Release it
 * either way. */
bool naive_surface_load(naive_surface *s, const char *path);
void naive_surface_release(naive_surface *s);

#endif
