/* hex_judge.h - what the library tells of isosurfaces of hexahedra and quadratic tets, of whatever
 * kind their file is, beside brute force over all cells (hex_truth.h, quadratic_truth.h).
 *
 * Rays that brute force is in doubt about (a root within 1e-9 of a cell's face, in parameters, or
 * two that nearly touch; all rays near a folded cell) are counted and not judged. Distances are in
 * edges: the mean edge of the cell that the surface is in.
 */
#ifndef TESTS_SUPPORT_HEX_JUDGE_H
#define TESTS_SUPPORT_HEX_JUDGE_H

#include <stdio.h>

#include "formats/curved/curved_cell.h"
#include "render/leafcast.h"
#include "tests/support/cell_mix.h"

enum { HEX_JUDGE_ROOTS = 512 };
#define HEX_JUDGE_ERROR 1e-6 /* edges by which a distance may be wrong */

/* A cell, and the ball about it. */
typedef struct hex_judged {
    curved_cell cell;
    double middle[3], square, edge;
    bool folded; /* it has no interpolant of its own */
} hex_judged;

typedef struct hex_judge {
    hex_judged *of;
    size_t count;
} hex_judge;

typedef struct hex_judge_root {
    long double t;
    double edge;
} hex_judge_root;

typedef struct hex_tally {
    uint64_t rays, doubtful;
    uint64_t surfaces, missed, invented, wrong; /* wrong: further off than HEX_JUDGE_ERROR */
    double worst;                               /* edges, of those that are right */
} hex_tally;

/* hex_judge_mix() - all cells of a mesh. hex_judge_open() - all cells that a volume has, as it
 * tells them (leafcast_get_cell()), but those that are hidden or have a corner without a value.
 * hex_judge_release() -
 * in any case. */
void hex_judge_mix(hex_judge *j, const cell_mix *m);
void hex_judge_open(hex_judge *j, leafcast *v);
void hex_judge_release(hex_judge *j);

/* hex_judge_roots() - all with t > 0, in order. d: unit length. Returns how many; -1: in doubt. */
int hex_judge_roots(const hex_judge *j, double iso, const double o[3], const double d[3],
                    hex_judge_root roots[HEX_JUDGE_ROOTS]);

/* hex_judge_ray() - judge all hits of a ray with the one selected surface, by
 * leafcast_probe_ray(). hex_judge_picture() - the depths of a picture. Both return whether nothing
 * was wrong. */
bool hex_judge_ray(const hex_judge *j, leafcast *v, double iso, const double o[3],
                   const double d[3], hex_tally *tally);
bool hex_judge_picture(const hex_judge *j, leafcast *v, double iso, const leafcast_camera *c,
                       hex_tally *tally);

uint64_t hex_tally_faults(const hex_tally *t);
void hex_tally_add(hex_tally *to, const hex_tally *t);
void hex_tally_heading(FILE *f);
void hex_tally_row(FILE *f, const char *name, const hex_tally *t);

#endif
