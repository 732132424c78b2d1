/* convert_defaults.h - defaults that `leafcast convert` and the library share, so that the same
 * input gives the same bytes.
 */
#ifndef PREP_CONVERT_DEFAULTS_H
#define PREP_CONVERT_DEFAULTS_H

#include "formats/leaf/leaf_writer.h"

#define CONVERT_MEMORY_DEFAULT ((uint64_t)2 << 30)

/* convert_parameters_default() - leaf_parameters_default() with histograms and deviations on. */
leaf_parameters convert_parameters_default(void);

#endif
