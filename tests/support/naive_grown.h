/* naive_grown.h - a second reader of growing treelet files, from section 4 of formats/SERIES.md
 * alone. */
#ifndef TESTS_SUPPORT_NAIVE_GROWN_H
#define TESTS_SUPPORT_NAIVE_GROWN_H

#include "tests/support/naive_leaf.h"
#include "tests/support/naive_mesh.h"

enum { NAIVE_SEGMENTS_MAX = 64 };

typedef struct naive_grown {
    naive_leaf segment[NAIVE_SEGMENTS_MAX]; /* of a grid, */
    naive_mesh mesh[NAIVE_SEGMENTS_MAX];    /* or of a mesh */
    long first[NAIVE_SEGMENTS_MAX];         /* step of all */
    uint64_t size[NAIVE_SEGMENTS_MAX];
    long segments, steps;
    char why[256];
} naive_grown;

/* naive_grown_load() - read and check all segments. Of grids, each has the samples of its first
 * field at step `step` of all, if that is one of its steps, else of its set 0. False: g->why.
 * Release it either way. */
bool naive_grown_load(naive_grown *g, const char *path, long step);
void naive_grown_release(naive_grown *g);

/* naive_grown_segment(), naive_grown_mesh() - the segment that has a step; *own: which of its own
 * steps that is. */
const naive_leaf *naive_grown_segment(const naive_grown *g, long step);
const naive_mesh *naive_grown_mesh(const naive_grown *g, long step, long *own);

#endif
