/* shadow_lab.h - the laboratory of self-shadowing: no acne, no light where none can come, also far
 * from the origin.
 *
 * Pictures with shadows of the solids of solids.h, lit from directions at random:
 *
 *   acne   on a convex solid, points that face the light, yet lie in a shadow: it can only be their
 *          own
 *   leaks  inside a closed wall, points that light from outside reaches
 *   wrong  on any solid, points whose light is not what the reference says, which follows the way
 * to the light from its own hit; not judged where either ray lies in the grazing band, or where a
 * surface is met within NEAR of a cell
 */
#ifndef TESTS_SUPPORT_SHADOW_LAB_H
#define TESTS_SUPPORT_SHADOW_LAB_H

#include <stdint.h>
#include <stdio.h>

#include "formats/base/status.h"

typedef struct shadow_tally {
    uint64_t points; /* seen in pictures */
    uint64_t facing; /* of convex solids: towards the light */
    uint64_t acne;
    uint64_t walled; /* seen inside walls */
    uint64_t leaks;
    uint64_t judged; /* held against the reference; */
    uint64_t shaded; /* of these, in a shadow; */
    uint64_t wrong;  /* and told otherwise */
    uint64_t unclear;
    uint64_t ill_conditioned; /* as the renderer counts them */
} shadow_tally;

typedef struct shadow_lab_job {
    int which, placing; /* of solids.h */
    uint64_t seed;
    int views;
    uint32_t side; /* pictures of side x side pixels */
    const char *isa;
    const char *rerun; /* how a printed line begins: the program */
    FILE *log;
} shadow_lab_job;

/* shadow_lab_run() - one solid. Converts it to a treelet file in the scratch folder. */
CHECKED status shadow_lab_run(const shadow_lab_job *job, shadow_tally *tally);

void shadow_tally_add(shadow_tally *to, const shadow_tally *from);
uint64_t shadow_tally_faults(const shadow_tally *tally);
void shadow_tally_heading(FILE *out);
void shadow_tally_row(FILE *out, const char *name, const shadow_tally *tally);

/* shadow_lab_rerun() - PROGRAM shadow FORM PLACING SEED VIEWS SIDE ISA; argv[0] is FORM. Returns 0,
 * 1 when the fault is there, 2 when the arguments make no sense. */
int shadow_lab_rerun(int argc, char **argv);

#endif
