/* convert_work.h - what the verb convert keeps of unfinished work, for --resume. */
#ifndef PREP_CONVERT_WORK_H
#define PREP_CONVERT_WORK_H

#include "formats/base/work_folder.h"
#include "prep/convert_job.h"

struct convert_request;

typedef struct convert_work {
    work_folder *folder; /* NULL: there is none */
    convert_job job;
    bool resumes; /* it is an earlier run's */
} convert_work;

/* convert_work_open() - open the output's folder, before any input. ST_EXISTS: another process is
 * making the output, it is there already, or there is unfinished work and neither --resume nor
 * --force. *done: set if all was done by an earlier run: also, with --resume, where no work is left
 * and the output is a whole treelet file that was written after the inputs. */
CHECKED status convert_work_open(struct convert_request *a, mem *m, bool *done);

/* convert_work_close() - leave the folder if a later run can go on, and make the error say so; else
 * remove it. st: how the job ended. Returns that. */
status convert_work_close(struct convert_request *a, status st);

#endif
