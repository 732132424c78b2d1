/* tetgen_job.h - runs TetGen in its own process, leafcast-tetgen: points and facets in, tets out.
 *
 * See tetgen_worker_main.cpp for the protocol of the pipes. Whatever happens to the process - it
 * refuses, crashes, takes too long, needs too much memory - becomes a status here.
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
    double ratio, angle;      /* limits on radius to edge, and on dihedral angles in degrees; 0:
                                 none */
    double max_volume;        /* of a tet; 0: no limit */
    uint64_t memory;          /* limit for the process, in bytes */
    double seconds;           /* limit on wall-clock time; 0: none */
    const progress *progress; /* may be NULL */
} tetgen_options;

typedef struct tetgen_job {
    mem *m;
    const plc *input;
    tetgen_options options;
    child c;
    bool running;
    double until;                     /* deadline on the clock; 0: none */
    uint64_t points, triangles, tets; /* of the mesh */
    double (*xyz)[3];                 /* the input's points, then TetGen's */
    uint32_t (*triangle)[3];          /* on facets */
} tetgen_job;

/* tetgen_job_available() - ST_UNSUPPORTED: the program is not installed. */
CHECKED status tetgen_job_available(void);

/* tetgen_job_memory() - least bytes, roughly, that the process needs for so many points. */
uint64_t tetgen_job_memory(uint64_t points);

/* tetgen_job_run() - mesh the inside of the input's facets, or the convex hull of points alone.
 * Blocks until points and triangles are there. ST_CORRUPT: TetGen finds the input faulty; names two
 * facets that intersect. ST_UNSUPPORTED: a crash or time-out. ST_NOMEM; ST_STOPPED. End the job in
 * any case. */
CHECKED status tetgen_job_run(tetgen_job *job, mem *m, const plc *input,
                              const tetgen_options *options);

/* tetgen_job_tets() - read the next `count` tets. */
CHECKED status tetgen_job_tets(tetgen_job *job, uint32_t (*tets)[4], size_t count);

/* tetgen_job_end() - kill the process if it still runs. A zeroed job is fine. */
void tetgen_job_end(tetgen_job *job);

#endif
