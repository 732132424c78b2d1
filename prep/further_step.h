/* further_step.h - whether an input can be a further step of a treelet file (SERIES.md 4). What
 * concerns the cells, each kind checks itself. */
#ifndef PREP_FURTHER_STEP_H
#define PREP_FURTHER_STEP_H

#include "formats/leaf/leaf_file.h"
#include "formats/leaf/leaf_writer.h"

/* further_step_refuse() - ST_USAGE: the input is no further step of the file, because of that. */
status further_step_refuse(const leaf_file *f, const char *input, const char *fmt, ...)
    __attribute__((format(printf, 3, 4)));

/* further_step_check() - check fields, times and the number of sets. Leaves out the times of the
 * sets where the file has none. */
CHECKED status further_step_check(const leaf_file *f, const char *input, leaf_sets *sets);

/* further_step_check_field() - check the name of field i; either may have none: "". */
CHECKED status further_step_check_field(const leaf_file *f, const char *input, uint32_t i,
                                        const char *name);

#endif
