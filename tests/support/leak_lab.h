/* leak_lab.h - the laboratory of closed surfaces: nothing gets through, from outside or from
 * inside, along single rays and in pictures.
 *
 * Of a ray (leafcast_probe_ray()) towards a point inside, without excuse: it meets the surface no
 * later than there. Of one that begins inside: it meets the surface. Then: sides alternate, from
 * outside the first surface is entered, as many lie ahead as the ends' sides ask for; a ray in the
 * reference's grazing band is excused from that, for surfaces at one t count as one.
 *
 * Of every pixel (leafcast_trace(), with every ISA that this CPU has): the same bits from all; from
 * inside a surface everywhere; from outside one no farther than any of the points looked at along
 * the ray that lie inside.
 */
#ifndef TESTS_SUPPORT_LEAK_LAB_H
#define TESTS_SUPPORT_LEAK_LAB_H

#include <stdint.h>
#include <stdio.h>

#include "formats/base/pool.h"

typedef struct leak_tally {
    uint64_t rays, pixels;
    uint64_t leaks;    /* rays and pixels that saw through */
    uint64_t disorder; /* rays with the wrong sides, or number of surfaces */
    uint64_t excused;  /* of those: in the grazing band */
    uint64_t unlike;   /* pixels that differ between ISAs, or from the single ray */
} leak_tally;

typedef struct leak_lab_job {
    int which, placing; /* of solids.h */
    uint64_t seed, rays;
    uint32_t side;     /* pictures of side x side pixels; 0: none */
    const char *rerun; /* how a printed line begins: the program */
    FILE *log;
} leak_lab_job;

/* leak_lab_run() - one solid. Converts it to a treelet file in the scratch folder. */
CHECKED status leak_lab_run(pool *p, const leak_lab_job *job, leak_tally *tally);

void leak_tally_add(leak_tally *to, const leak_tally *from);
uint64_t leak_tally_faults(const leak_tally *tally);
void leak_tally_heading(FILE *out);
void leak_tally_row(FILE *out, const char *name, const leak_tally *tally);

/* leak_lab_rerun() - PROGRAM leak FORM PLACING SEED RAY, or PROGRAM leak FORM PLACING SEED picture
 * SIDE; argv[0] is FORM. Returns 0, 1 when the fault is there, 2 when the arguments make no sense.
 */
int leak_lab_rerun(int argc, char **argv);

#endif
