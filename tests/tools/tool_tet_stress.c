/* tool_tet_stress.c - the laboratory of tetrahedra at length.
 *
 *   tet_stress [COUNT [CASE]]      COUNT rays of each case of tests/support/tet_meshes.c, or of one
 *   tet_stress CASE SEED INDEX     one ray, with all that the kernel and the reference see of it
 *
 * Exit status 1 when there is a fault. The seed of the first form is $SEED, else 1.
 */
#include <stdlib.h>
#include <string.h>

#include "tests/support/tet_lab.h"
#include "tests/support/tet_meshes.h"

static int case_of(const char *name) {
    for (int i = 0; i < lab_mesh_count(); i++)
        if (strcmp(lab_mesh_name(i), name) == 0)
            return i;
    fprintf(stderr, "tet_stress: no case %s\n", name);
    exit(2);
}

int main(int argc, char **argv) {
    if (argc == 4)
        return tet_lab_show(case_of(argv[1]), strtoull(argv[2], NULL, 10),
                            strtoull(argv[3], NULL, 10));
    const char *seed = getenv("SEED");
    tet_lab_job job = {.count = argc > 1 ? strtoull(argv[1], NULL, 10) : 10000,
                       .seed = seed ? strtoull(seed, NULL, 10) : 1,
                       .rerun = argv[0],
                       .log = stdout};
    tet_lab_row all = {0};
    int only = argc > 2 ? case_of(argv[2]) : -1;
    tet_lab_heading(stdout);
    for (job.which = 0; job.which < lab_mesh_count(); job.which++) {
        tet_lab_row row;
        if (only >= 0 && only != job.which)
            continue;
        tet_lab_run(&job, &row);
        tet_lab_print(stdout, lab_mesh_name(job.which), &row);
        fflush(stdout);
        tet_lab_add(&all, &row);
    }
    tet_lab_print(stdout, "all", &all);
    return tet_lab_faults(&all) > 0;
}
