/* tetgen_job.h - TetGen in a process of its own, leafcast-tetgen: points and facets in, tets out.
 *
 * See tetgen_worker_main.cpp for what goes through the pipes. Whatever becomes of the process - it
 * refuses, crashes, takes too long, needs too much memory - ends here as a status.
 */
#ifndef PREP_TETRAHEDRALIZE_TETGEN_JOB_H
#define PREP_TETRAHEDRALIZE_TETGEN_JOB_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/child.h"
#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/surface/plc.h"

typedef struct tetgen_options {
    const char *file;         /* the input, for messages */
    double ratio, angle;      /* of radius to edge, of dihedral angles in degrees; 0: any */
    double max_volume;        /* of a tet; 0: any */
    uint64_t memory;          /* bytes the process may take */
    double seconds;           /* it may take, by the clock; 0: any */
    const progress *progress; /* may be NULL */
} tetgen_options;

typedef struct tetgen_job {
    mem *m;
    const plc *input;
    tetgen_options options;
    child c;
    bool running;
    double until;                     /* on the clock; 0: any time */
    uint64_t points, triangles, tets; /* of the mesh */
    double (*xyz)[3];                 /* the input's points come first */
    uint32_t (*triangle)[3];          /* on facets */
} tetgen_job;

/* tetgen_job_available() - ST_UNSUPPORTED when the program is not there. */
CHECKED status tetgen_job_available(void);

/* tetgen_job_memory() - bytes the process needs at least, about, for so many points. */
uint64_t tetgen_job_memory(uint64_t points);

/* tetgen_job_run() - mesh the input: the inside of its facets, or the convex hull of points alone.
 * Blocks until points and triangles are there. ST_CORRUPT for what TetGen finds wrong with the
 * input, with two facets that intersect named; ST_UNSUPPORTED for a crash or a time-out; ST_NOMEM;
 * ST_STOPPED. End it in any case. */
CHECKED status tetgen_job_run(tetgen_job *job, mem *m, const plc *input,
                              const tetgen_options *options);

/* tetgen_job_tets() - the next count tets. */
CHECKED status tetgen_job_tets(tetgen_job *job, uint32_t (*tets)[4], size_t count);

/* tetgen_job_end() - a process that still runs is killed. Zeroed is fine. */
void tetgen_job_end(tetgen_job *job);

#endif
