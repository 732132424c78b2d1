/* tet_lab.h - the laboratory of tetrahedra: the kernel of render/mesh/tet_kernel.h on every
 * tetrahedron of the hostile meshes of tet_meshes.h, judged by the reference.
 *
 * Rays go through small meshes (64 rays share one) and all their surfaces are compared
 * (tet_judge.h). Beside missed, false and too far, which the grazing band excuses, these are
 * faults:
 *
 *   leaks    a ray that begins in or aims at the inside of a closed surface, and does not meet it:
 *            without excuse where no tetrahedra are flat or overlap
 *   sides    both see the same surfaces, apart from one another; the kernel names the wrong side
 *   uneven   in a closed mesh, the numbers of surfaces the two see differ by an odd number
 *
 * And this is none:
 *
 *   touches  a ray through a corner of the surface (where f = iso on an edge of the mesh), which
 *            the reference takes to pass beside it: the kernel sees that corner; or, where both see
 *            it, more than once
 *
 * A ray that begins on a surface is judged by what lies behind that.
 */
#ifndef TESTS_SUPPORT_TET_LAB_H
#define TESTS_SUPPORT_TET_LAB_H

#include <stdint.h>
#include <stdio.h>

#include "tests/support/tet_judge.h"

typedef struct tet_lab_row {
    ref_tally tally;  /* grazing: those excused */
    uint64_t stopped; /* rays that a closed surface must stop */
    uint64_t leaks, sides, uneven, touches;
} tet_lab_row;

/* What is asked: `count` rays of a case (of lab_mesh_name()) from index `first` on. */
typedef struct tet_lab_job {
    int which;
    uint64_t seed, first, count;
    const char *rerun; /* how a printed line begins: the program */
    FILE *log;         /* at most three lines */
} tet_lab_job;

void tet_lab_run(const tet_lab_job *job, tet_lab_row *row);
void tet_lab_add(tet_lab_row *to, const tet_lab_row *from);
uint64_t tet_lab_faults(const tet_lab_row *row);

/* A table, one line a case. */
void tet_lab_heading(FILE *out);
void tet_lab_print(FILE *out, const char *name, const tet_lab_row *row);

/* tet_lab_show() - one ray: what both see of it, on stdout. Returns whether there is a fault. */
bool tet_lab_show(int which, uint64_t seed, uint64_t index);

#endif
