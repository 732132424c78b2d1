/* leaf_repair.h - make a damaged treelet file whole from another copy of it.
 *
 * Each part of the file (header, section table, sections, payloads, and likewise of segments and
 * coarse grids) has a checksum. So each is taken from the copy whose bytes have it: the damaged
 * file itself, or else the other copy, which may be damaged elsewhere. All bytes between parts are
 * zeros. Together that is the sound file, byte for byte. Neither copy needs to open, and both may
 * be cut short.
 */
#ifndef FORMATS_LEAF_LEAF_REPAIR_H
#define FORMATS_LEAF_LEAF_REPAIR_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/mem.h"
#include "formats/base/progress.h"
#include "formats/base/status.h"
#include "formats/leaf/leaf.h"

typedef struct leaf_repair_job {
    const char *bad;          /* the damaged file */
    const char *from;         /* the other copy */
    const char *output;       /* NULL: in the place of bad */
    bool force;               /* overwrite an output that exists */
    int threads;              /* of the check at the end */
    const progress *progress; /* may be NULL */
} leaf_repair_job;

/* From which copy parts were taken. */
typedef enum leaf_repair_copy {
    LEAF_REPAIR_BAD,
    LEAF_REPAIR_FROM,
    LEAF_REPAIR_COPIES
} leaf_repair_copy;

typedef struct leaf_repair_result {
    leaf_header header;
    /* How many parts were taken from each copy; implied payloads are not counted. directory:
     * headers, section tables and sections. */
    uint64_t payloads[LEAF_REPAIR_COPIES];
    uint64_t directory[LEAF_REPAIR_COPIES];
    uint64_t gaps; /* between parts, where bad has other bytes than zeros, or ends, or goes on
                      behind its end */
    bool mended;   /* bad was damaged. If not, nothing is written in its place */
} leaf_repair_result;

/* leaf_repair() - make bad whole.
 *
 * The output is an out_file, which leaf_verify() has accepted before it gets its name. So a failure
 * leaves bad, and an output that was there, as they were. In the place of bad it also has bad's
 * permissions.
 *
 * ST_USAGE: from has another id, or is bad itself. ST_CORRUPT: parts are damaged in both copies
 * (they are listed), no header is sound, or bad's header is damaged and the rest is not from the
 * same file, or may have more segments than from has. Errors of outputs and files likewise. Memory:
 * the directory, one payload or section, and what leaf_verify() needs. */
CHECKED status leaf_repair(mem *m, const leaf_repair_job *job, leaf_repair_result *result);

#endif
