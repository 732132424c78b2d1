/* generate_steps.h - the files of a generated time series, one per step.
 */
#ifndef PREP_GENERATE_GENERATE_STEPS_H
#define PREP_GENERATE_GENERATE_STEPS_H

#include <stdbool.h>
#include <stdint.h>

#include "formats/base/status.h"

/* generate_steps_name() - the file of a step into out, of PATH_MAX bytes: the output itself if
 * steps is 0, else named after it as sequence_name() says. */
CHECKED status generate_steps_name(const char *output, uint32_t steps, uint32_t step, char *out);

/* generate_steps_check() - check the names of all files before the first is written: an existing
 * one would stop a series in its middle. ST_EXISTS unless force. Checks nothing if steps is 0. */
CHECKED status generate_steps_check(const char *output, uint32_t steps, bool force);

/* generate_steps_time() - of a step: from 0 to 1, evenly; 0 of a single one. */
double generate_steps_time(uint32_t steps, uint32_t step);

#endif
