/* convert_job.h - what a conversion is asked to do, as text: with the same, a run can go on where
 * another one ended.
 *
 * A line for each option that the output depends on, and for each input what tells that it is still
 * the same: its size and time. A part of the saved state.
 */
#ifndef PREP_CONVERT_JOB_H
#define PREP_CONVERT_JOB_H

#include "formats/base/mem.h"
#include "formats/base/state_io.h"

typedef struct convert_job {
    mem *m;
    char *text;
    size_t length, room;
    const char *output; /* for messages */
} convert_job;

/* convert_job_init() - with no line but the program's. convert_job_release() - zeros are fine. */
CHECKED status convert_job_init(convert_job *j, mem *m, const char *output);
void convert_job_release(convert_job *j);

/* convert_job_option() - add an option; value: "" if it has none. convert_job_input() - add an
 * input with its size and time; "-" has neither. */
CHECKED status convert_job_option(convert_job *j, const char *name, const char *value);
CHECKED status convert_job_input(convert_job *j, const char *path);

/* convert_job_keep() - save it; or load the one of another run, and compare. ST_USAGE: an option is
 * another, ST_CORRUPT: an input is, and which. */
CHECKED status convert_job_keep(convert_job *j, state_io *io);

#endif
