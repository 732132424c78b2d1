/* segment_truth.h - the pieces of a ray through cells as the references in long double see them,
 * and a judge of those that the renderer found.
 *
 * A piece is wanted of each cell that the ray passes for longer than rounding can hide, none is
 * allowed of others; its ends, and its value at and between them, must be right within the bounds
 * that grid_segments.h and mesh_segments.h state.
 */
#ifndef TESTS_SUPPORT_SEGMENT_TRUTH_H
#define TESTS_SUPPORT_SEGMENT_TRUTH_H

#include "render/ray/segments.h"
#include "tests/support/tet_reference.h"

typedef struct truth_piece {
    uint64_t cell;
    long double t0, t1;
    long double off[2]; /* the ends may be off by so much */
} truth_piece;

/* A volume of one kind. Rays are in its own space, t in [0, inf). */
typedef struct segment_truth {
    const void *of;
    /* Every cell with data that the ray passes, in any order; returns how many. */
    size_t (*pieces)(const void *of, const ref_ray *r, truth_piece *out, size_t room);
    /* The value in a cell at t, and by how much ours may be off there. */
    long double (*value)(const void *of, const ref_ray *r, uint64_t cell, long double t,
                         long double *off);
    /* The least and the greatest sample of a cell. */
    void (*range)(const void *of, uint64_t cell, double range[2]);
    /* Whether two cells share a face: then ends that meet are the same bits. */
    bool (*share_face)(const void *of, uint64_t a, uint64_t b);
} segment_truth;

segment_truth segment_truth_grid(const ref_volume *v); /* node coordinates; to_world the identity */
/* sound: points of one place are one point; else it is not known which faces are shared. */
segment_truth segment_truth_mesh(const tet_ref_mesh *m, bool sound);

typedef struct segment_tally {
    size_t rays, pieces, faces; /* faces: ends that adjoin, bit for bit */
    size_t faults;
    double worst_t, worst_value, worst_sum; /* of the bounds */
} segment_tally;

/* segment_judge() - pieces of a ray, as they came, and what is said of their errors. Faults are
 * counted and said. */
void segment_judge(segment_tally *sum, const segment_truth *truth, const char *name,
                   const ref_ray *r, const segment *got, size_t count, const segments_error *error);

#endif
