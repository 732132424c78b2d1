/* curvilinear_input_kind.h - curvilinear grids as inputs: the row of input_open.c for all that
 * curvilinear_input.h reads. */
#ifndef FORMATS_CURVILINEAR_CURVILINEAR_INPUT_KIND_H
#define FORMATS_CURVILINEAR_CURVILINEAR_INPUT_KIND_H

#include "formats/input_kind.h"

extern const input_kind curvilinear_input_kind; /* its own: a curvilinear_input */

#endif
