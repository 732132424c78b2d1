/* sample_times.h - when the steps of a treelet file are, for formats that have a time axis.
 */
#ifndef PREP_EXPORT_SAMPLE_TIMES_H
#define PREP_EXPORT_SAMPLE_TIMES_H

#include "formats/leaf/leaf_file.h"

typedef struct sample_times {
    uint32_t steps;
    double first, apart; /* 0 and 1 where times are untold, or uneven */
    const char *unit;    /* "s", as the file has it; "": untold */
    bool uneven;         /* no two numbers say them */
} sample_times;

/* sample_times_of() - all steps of a file, or of one step nothing. Times are even where each is
 * within a millionth of a step of where it would be. The unit lives as long as the file. */
sample_times sample_times_of(const leaf_file *f, bool all);

#endif
