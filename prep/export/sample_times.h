/* sample_times.h - times of a treelet file's steps, for formats that have a time axis.
 */
#ifndef PREP_EXPORT_SAMPLE_TIMES_H
#define PREP_EXPORT_SAMPLE_TIMES_H

#include "formats/leaf/leaf_file.h"

typedef struct sample_times {
    uint32_t steps;
    double first, apart; /* 0 and 1 if times are unknown or uneven */
    const char *unit;    /* "s", as spelled in the file; "": unknown */
    bool uneven;         /* first and apart cannot express them */
} sample_times;

/* sample_times_of() - times of all steps; one step alone has none. Times are even if each is within
 * a millionth of a step of its even position. The unit lives as long as the file. */
sample_times sample_times_of(const leaf_file *f, bool all);

#endif
